#include "tools/miebrdf/albedo_colour.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include <miebrdf/error.h>
#include <miebrdf/colour.h>
#include "pipeline/formats/rgb_weights.h"

namespace miebrdf::program {
namespace {

/// Six decimals: what is beyond is rounding (-6e-14 for the a of a grey), and no eye sees it.
Cell decimals(double value) { return std::round(value * 1e6) / 1e6 + 0.0; }

std::vector<Cell> colour_row(const std::string& quantity, const Cell& mu_in, const Xyz& xyz,
                             Illuminant illuminant) {
    const Lab lab = to_lab(xyz, illuminant);
    const LinearSrgb rgb = to_linear_srgb(xyz, illuminant);
    std::vector<Cell> row = {quantity, mu_in};
    for (const double value : {xyz.x, xyz.y, xyz.z, lab.l, lab.a, lab.b, encode_srgb(rgb.red),
                               encode_srgb(rgb.green), encode_srgb(rgb.blue)}) {
        row.push_back(decimals(value));
    }
    return row;
}

}  // namespace

Illuminant parse_illuminant(const std::string& name) {
    if (name == "d65") return Illuminant::d65;
    if (name == "a") return Illuminant::a;
    if (name == "e") return Illuminant::e;
    throw UsageError(fmt::format("unknown illuminant '{}'; allowed: d65, a, e", name));
}

void prepare_for_colour(Request& request) {
    std::vector<double>& nm = request.wavelength_nm;
    std::sort(nm.begin(), nm.end());
    nm.erase(std::unique(nm.begin(), nm.end()), nm.end());
    // Fewer, or a part of the visible, give another colour without a sign of it (docs/colour.md).
    if (exports::covers_the_visible(nm)) return;
    throw UsageError(
        "--colour needs at least eight wavelengths, from 430 nm or less to 650 nm or more; write "
        "e.g. --wavelengths 400:700:10");
}

void add_colours(Table& table, const AlbedoResult& result, const std::vector<double>& mu_in,
                 Illuminant illuminant) {
    std::vector<double> wavelength_nm, albedo;
    for (const AlbedoSlice& slice : result.slices) wavelength_nm.push_back(slice.wavelength_nm);
    const ObserverWeights weights = observer_weights(wavelength_nm, illuminant);
    table.columns = {"quantity", "mu_in", "x",        "y",          "z",        "lab_l",
                     "lab_a",    "lab_b", "srgb_red", "srgb_green", "srgb_blue"};
    const auto add = [&](const std::string& quantity, const Cell& mu, const auto& value_of) {
        albedo.clear();
        for (const AlbedoSlice& slice : result.slices) albedo.push_back(value_of(slice));
        table.rows.push_back(colour_row(quantity, mu, to_xyz(weights, albedo), illuminant));
    };
    for (std::size_t i = 0; i < mu_in.size(); ++i) {
        add("plane_albedo", mu_in[i], [i](const AlbedoSlice& s) { return s.plane_albedo[i]; });
    }
    add("spherical_albedo", Cell(), [](const AlbedoSlice& s) { return s.spherical_albedo; });
}

}  // namespace miebrdf::program
