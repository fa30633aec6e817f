// Table 1 of Chen et al. 2013: the averaged diffuse reflectance factor of four materials.
#pragma once

#include <array>
#include <string>
#include <vector>

#include <miebrdf/surface.h>

namespace miebrdf::rte {

/// The paper states alpha = 0.3 and Beckmann, but neither G nor the Fresnel formula, the mean or
/// the wavelengths of R, G and B. Each convention is one complete set of these choices.
struct Table1Convention {
    std::string name;  ///< e.g. "beckmann-smith-schlick"
    std::string description;
    SurfaceOptions surface;
    std::array<double, 3> rgb_nm;     ///< R, G, B
    double largest_difference = 0.0;  ///< from the twelve printed numbers, as computed here
};

/// All known conventions; the first is the default, built from what the paper names.
const std::vector<Table1Convention>& table1_conventions();

/// @throws UsageError  for an unknown name, listing the known ones
const Table1Convention& table1_convention(const std::string& name);

struct Table1Row {
    std::string material;          ///< as the paper writes it
    std::array<double, 3> factor;  ///< R, G, B as printed
};

/// The twelve printed numbers.
const std::vector<Table1Row>& table1_printed();

}  // namespace miebrdf::rte
