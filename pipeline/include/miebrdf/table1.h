// Averaged diffuse reflectance factors: Table 1 of Chen et al. (2013), and the same for any
// material.
#pragma once

#include <miebrdf/control.h>
#include <miebrdf/surface.h>

#include <array>
#include <optional>
#include <string>
#include <vector>

#pragma GCC visibility push(default)
namespace miebrdf {

/// The paper states alpha = 0.3 and Beckmann, but neither G nor the Fresnel formula, the mean or
/// the wavelengths of R, G and B. Each convention is one complete set of these choices.
struct Table1Convention {
    std::string name;                 ///< e.g. "beckmann-smith-schlick"
    std::string description;          ///< one sentence
    rte::SurfaceOptions surface;      ///< G, F and slopes
    std::array<double, 3> rgb_nm;     ///< R, G, B
    double largest_difference = 0.0;  ///< from the twelve printed numbers, as computed here
};

/// All known conventions; the first is the default, built from what the paper names.
const std::vector<Table1Convention>& table1_conventions();

/// @throws UsageError  for an unknown name, listing the known ones
const Table1Convention& table1_convention(const std::string& name);

/// One row of the paper's table.
struct Table1Row {
    std::string material;          ///< as the paper writes it
    std::array<double, 3> factor;  ///< R, G, B as printed
};

/// The twelve printed numbers.
const std::vector<Table1Row>& table1_printed();

/// One computed factor.
struct Table1Entry {
    std::string convention;       ///< its name
    std::string material;         ///< as asked for
    std::string channel;          ///< R, G, B; empty when the wavelengths were chosen
    double wavelength_nm = 0.0;   ///< vacuum
    double factor = 0.0;          ///< mean of 1 - rho_dt, uniform in solid angle
    std::optional<double> paper;  ///< as printed, where the paper has it
};

/// The choice of what to compute.
struct Table1Request {
    std::vector<std::string> materials;         ///< empty: the paper's four
    std::vector<Table1Convention> conventions;  ///< at least one
    std::vector<double> wavelength_nm;          ///< empty: each convention's R, G, B
    std::optional<double> beckmann_alpha;       ///< instead of the convention's, > 0
    std::string database;                       ///< of the user's materials; empty: the default one
};

/// The computed table.
struct Table1Result {
    std::vector<Table1Entry> entries;  ///< material by material
    std::vector<std::string> sources;  ///< one line for each material
};

/// @throws InputError  for unknown materials and wavelengths outside their tables
Table1Result compute_table1(const Table1Request& request, const Control& control = {});

}  // namespace miebrdf
#pragma GCC visibility pop
