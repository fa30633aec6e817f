// Derivatives of what is made of BRDFs and albedos: reflectance factors under a sky, colours.
#pragma once

#include <string>
#include <vector>

#include <miebrdf/brdf.h>
#include <miebrdf/colour.h>

#pragma GCC visibility push(default)
namespace miebrdf {

/// As Brdf::hdrf, and by numbers of the scene as Brdf::derivatives; no parameters: the values
/// alone.
/// @throws UsageError, InputError  as both
WithDerivatives<HdrfValues> hdrf_derivatives(const Brdf& brdf,
                                             const std::vector<std::string>& parameters,
                                             const Directions& directions, double diffuse_fraction,
                                             const Sky& sky = {});

/// How a colour changes with a number that its reflectance depends on; per unit of that number.
struct ColourDerivative {
    Xyz xyz;             ///< linear in the reflectance
    Lab lab;             ///< CIE 1976
    Lch lch;             ///< of lab, hue in degrees; not a number where there is no chroma
    LinearSrgb srgb;     ///< linear
    LinearSrgb encoded;  ///< of encode_srgb
};

/// @param reflectance  one value for each wavelength
/// @param slope        its derivative
/// @throws UsageError  when the lengths differ
ColourDerivative derivative_of_colour(const Colorimeter& colorimeter,
                                      const std::vector<double>& reflectance,
                                      const std::vector<double>& slope);

}  // namespace miebrdf
#pragma GCC visibility pop
