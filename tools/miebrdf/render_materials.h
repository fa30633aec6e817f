// The materials of a picture, from the command line.
#pragma once

#include <memory>
#include <string>
#include <vector>

#include "pipeline/render/solved_brdf.h"
#include "tools/miebrdf/command.h"
#include "tools/miebrdf/scene_options.h"

namespace miebrdf::program {

/// One material as a person wrote it: scene options in one string, as for the brdf command.
/// Numbers of hg:, isotropic:, rayleigh:, index: and of --surface-index may be lists a/b/c with
/// one value for each wavelength of the picture.
/// @return  one request, or one for each wavelength if there are lists
/// @throws UsageError
std::vector<Request> parse_material(const std::string& text, const std::vector<double>& wavelength_nm);

/// `total`, `subsurface` or `surface`.
/// @throws UsageError
render::Component parse_component(const std::string& text);

}  // namespace miebrdf::program
