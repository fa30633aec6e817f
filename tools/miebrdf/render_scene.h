// Object, lights and regions of a picture, from the command line.
#pragma once

#include <string>
#include <vector>

#include "pipeline/render/lighting.h"
#include "pipeline/render/material_map.h"

namespace miebrdf::program {

/// `sphere`, `knot`, `plaque`, or the path of an OBJ file.
/// @throws InputError
render::RayScene parse_object(const std::string& text);

/// `directional:ELEVATION,AZIMUTH[,IRRADIANCE]`, `area:ELEVATION,AZIMUTH,SIZE[,IRRADIANCE]`,
/// `uniform:RADIANCE`, `sky:ELEVATION,AZIMUTH[,SCALE]` (clear sky with its sun there) or
/// `map:FILE[,SCALE]`; angles in degrees. At most one of uniform, sky and map.
/// @throws UsageError, InputError
render::Lighting parse_lights(const std::vector<std::string>& texts, const std::string& spectrum,
                              const render::Bounds& object,
                              const std::vector<double>& wavelength_nm);

/// Two numbers `A,B`.
/// @throws UsageError
std::pair<double, double> parse_pair(const std::string& text, const std::string& what);

/// Pixels of a picture, `WIDTH,HEIGHT` or `SIDE` of a square, each in [1, render::kLongestSide].
/// @throws UsageError
std::pair<int, int> parse_size(const std::string& text);

}  // namespace miebrdf::program
