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

/// Relative tinting strength in per cent (ISO 787-24): Kubelka and Munk's K/S of the reflectance
/// over that of the reference, where the reference absorbs most. Empty: no such wavelength.
Cell tint_strength(const std::vector<double>& wavelength_nm, const std::vector<double>& reflectance,
                   const std::vector<double>& reference_nm, const std::vector<double>& reference) {
    const auto k_by_s = [](double r) { return (1.0 - r) * (1.0 - r) / (2.0 * r); };
    constexpr double kBlue_nm = 400.0, kRed_nm = 700.0;  // the range of these tests
    std::size_t darkest = reference.size();
    for (std::size_t w = 0; w < reference.size(); ++w) {
        if (reference_nm[w] < std::max(kBlue_nm, wavelength_nm.front()) ||
            reference_nm[w] > std::min(kRed_nm, wavelength_nm.back()))
            continue;
        if (darkest == reference.size() || reference[w] < reference[darkest]) darkest = w;
    }
    if (darkest == reference.size()) return {};
    const auto right =
        std::upper_bound(wavelength_nm.begin() + 1, wavelength_nm.end() - 1, reference_nm[darkest]);
    const std::size_t i = std::size_t(right - wavelength_nm.begin());
    const double t =
        (reference_nm[darkest] - wavelength_nm[i - 1]) / (wavelength_nm[i] - wavelength_nm[i - 1]);
    const double of_reference = k_by_s(reference[darkest]);
    const double own = k_by_s(reflectance[i - 1] + t * (reflectance[i] - reflectance[i - 1]));
    if (!(of_reference > 0.0 && std::isfinite(own / of_reference))) return {};
    return decimals(100.0 * own / of_reference);
}

constexpr const char* kColours[] = {"x",         "y",     "z",        "lab_l",
                                    "lab_a",     "lab_b", "srgb_red", "srgb_green",
                                    "srgb_blue", "lch_c", "lch_h"};

// Rounding alone gives a grey a hue.
constexpr double kLeastChroma = 1e-6;

}  // namespace

ColourColumns::ColourColumns(const std::vector<double>& wavelength_nm, const Viewing& viewing,
                             ReferenceColours reference)
    : colorimeter_(wavelength_nm, viewing),
      wavelength_nm_(wavelength_nm),
      reference_(std::move(reference)) {
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
    if (!reference_.reflectance.empty()) table.columns.emplace_back("tint_strength");
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
        const Lab& standard = reference_labs_.at(row_);
        row.push_back(decimals(delta_e_76(standard, lab)));
        row.push_back(decimals(delta_e_2000(standard, lab)));
        if (!reference_.reflectance.empty())
            row.push_back(tint_strength(wavelength_nm_, reflectance, reference_.wavelength_nm,
                                        reference_.reflectance.at(row_)));
        ++row_;
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
           "distances in Lab; tint_strength: per cent, (1 - R)^2 / (2 R) over the reference's, "
           "where the reference is darkest";
}

}  // namespace miebrdf::program
