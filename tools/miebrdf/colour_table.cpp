#include "tools/miebrdf/colour_table.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <iterator>

#include <miebrdf/value_derivatives.h>

namespace miebrdf::program {
namespace {

/// Six decimals: what is beyond is rounding (-6e-14 for the a of a grey), and no eye sees it.
Cell decimals(double value) { return std::round(value * 1e6) / 1e6 + 0.0; }

constexpr const char* kColours[] = {"x",         "y",     "z",        "lab_l",
                                    "lab_a",     "lab_b", "srgb_red", "srgb_green",
                                    "srgb_blue", "lch_c", "lch_h"};

// Rounding alone gives a grey a hue.
constexpr double kLeastChroma = 1e-6;

}  // namespace

ColourColumns::ColourColumns(const std::vector<double>& wavelength_nm, const Viewing& viewing,
                             ReferenceColours reference)
    : colorimeter_(wavelength_nm, viewing), reference_(std::move(reference)) {
    reference_labs_ = reference_.labs;
    if (reference_.reflectance.empty()) return;
    const Colorimeter its(reference_.wavelength_nm, viewing);
    for (const std::vector<double>& spectrum : reference_.reflectance) {
        const Colour colour = its(spectrum);
        reference_labs_.push_back(colour.lab);
        reference_error_ = std::max(reference_error_, colour.error_estimate);
    }
}

void ColourColumns::add_names(Table& table) const {
    table.columns.insert(table.columns.end(), std::begin(kColours), std::end(kColours));
    table.columns.emplace_back("colour_error");
    if (!reference_.empty()) table.columns.insert(table.columns.end(), {"de76", "de2000"});
}

double ColourColumns::add_cells(Table& table, const std::vector<double>& reflectance) {
    const Colour colour = colorimeter_(reflectance);
    const auto& [xyz, lab, lch, rgb, error] = colour;
    std::vector<Cell>& row = table.rows.back();
    for (const double value : {xyz.x, xyz.y, xyz.z, lab.l, lab.a, lab.b, encode_srgb(rgb.red),
                               encode_srgb(rgb.green), encode_srgb(rgb.blue), lch.c}) {
        row.push_back(decimals(value));
    }
    row.push_back(lch.c < kLeastChroma ? Cell() : decimals(lch.h_deg));
    row.push_back(decimals(error));
    largest_error_ = std::max(largest_error_, error);
    if (!reference_.empty()) {
        const Lab& standard = reference_labs_.at(row_++);
        row.push_back(decimals(delta_e_76(standard, lab)));
        row.push_back(decimals(delta_e_2000(standard, lab)));
    }
    return xyz.y;
}

void ColourColumns::add_derivative_names(Table& table,
                                         const std::vector<std::string>& parameters) const {
    for (const std::string& parameter : parameters) {
        for (const char* name : kColours)
            table.columns.push_back(fmt::format("{}_d_{}", name, parameter));
    }
}

void ColourColumns::add_derivative_cells(Table& table, const std::vector<double>& reflectance,
                                         const std::vector<double>& slope) const {
    const auto& [xyz, lab, lch, linear, rgb] =
        derivative_of_colour(colorimeter_, reflectance, slope);
    std::vector<Cell>& row = table.rows.back();
    row.insert(row.end(), {xyz.x, xyz.y, xyz.z, lab.l, lab.a, lab.b, rgb.red, rgb.green, rgb.blue});
    const bool is_grey = colorimeter_(reflectance).lch.c < kLeastChroma;
    row.push_back(is_grey ? Cell() : Cell(lch.c));
    row.push_back(is_grey ? Cell() : Cell(lch.h_deg));
}

void ColourColumns::add_facts(Table& table) const {
    table.facts.emplace_back("viewing", describe(colorimeter_.viewing()));
    table.facts.emplace_back(
        "colour_error", fmt::format("{:.2g} at most (de76 to the colours from every other "
                                    "wavelength: an upper estimate of what the wavelengths leave)",
                                    largest_error_));
    if (reference_.empty()) return;
    table.facts.emplace_back(
        "reference",
        reference_.labs.empty()
            ? fmt::format("{}; its colour_error {:.2g} at most", reference_.title, reference_error_)
            : fmt::format("{}; Lab as the file has it", reference_.title));
}

std::string ColourColumns::units() const {
    return "x, y, z: white of the illuminant has y = 1; lab: CIE 1976, white 100, 0, 0; srgb: "
           "encoded, not clipped; lch_h: degrees, empty of greys; colour_error, de76, de2000: "
           "distances in Lab";
}

}  // namespace miebrdf::program
