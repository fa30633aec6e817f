// Options of `miebrdf render`, and the materials of a picture.
#pragma once

#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "pipeline/render/renderer.h"
#include "tools/miebrdf/command.h"
#include "tools/miebrdf/scene_options.h"

namespace miebrdf::program {

struct RenderArguments {
    SceneArguments scene;
    std::vector<std::string> materials;
    std::string component = "total";
    std::string object = "sphere";
    std::optional<double> split;
    std::string mask;
    std::string mask_projection = "front";
    std::vector<std::string> lights = {"area:40,-40,25,2.2", "uniform:0.1"};
    std::string light_spectrum = "white";
    std::string camera = "0,0";
    double field_of_view_deg = 25.0;
    double zoom = 0.95;
    std::string size = "512,512";
    std::string background = "1,1,1";
    double exposure = 0.0;
    std::string exr;
    std::string table = "49,0";
    bool measure_interpolation = false;
    render::RenderOptions options;
};

/// The options of materials, regions and picture; the scene's own are not among them.
void add_render_options(CLI::App& command, RenderArguments& a);

/// One material as a person wrote it, `base=TiO2 coat=AlGaAs7@0.1 roughness=0.3`: the scene options
/// of the brdf command without their dashes (a switch is its bare name). Numbers of hg:,
/// isotropic:, rayleigh:, index: and of surface-index may be lists a/b/c with one value for each
/// wavelength of the picture.
/// @return  one request, or one for each wavelength if there are lists
/// @throws UsageError
std::vector<Request> parse_material(const std::string& text,
                                    const std::vector<double>& wavelength_nm);

}  // namespace miebrdf::program
