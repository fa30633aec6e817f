#include "tools/miebrdf/reflection_options.h"

#include <fmt/format.h>

#include <algorithm>

#include <miebrdf/colour.h>
#include <miebrdf/error.h>
#include "pipeline/scene/number_list.h"

namespace miebrdf::program {
namespace {

CLI::Option* add_list(CLI::App& command, const char* name, std::string& text, const char* help) {
    return command.add_option(name, text, help)->type_name("LIST");
}

std::vector<double> cosines(const std::string& text, const char* name) {
    return parse_number_list(text, name, 0.0, 1.0, true);
}

/// Each once, in the order typed.
std::vector<BrdfPart> parse_components(const std::string& text, bool has_surface) {
    std::vector<BrdfPart> parts;
    for (const std::string& name : split_list(text)) {
        const BrdfPart part = parse_brdf_part(name);
        if (std::find(parts.begin(), parts.end(), part) != parts.end())
            throw UsageError(fmt::format("component '{}' is named twice", name));
        if (part == BrdfPart::surface && !has_surface)
            throw UsageError("component 'surface' needs a surface; give --roughness, e.g. 0.3");
        parts.push_back(part);
    }
    return parts;
}

Illuminant parse_illuminant(const std::string& name) {
    if (name == "d65") return Illuminant::d65;
    if (name == "a") return Illuminant::a;
    if (name == "e") return Illuminant::e;
    throw UsageError(fmt::format("unknown illuminant '{}'; allowed: d65, a, e", name));
}

/// Sorts the wavelengths and refuses those that no colour can be told from: fewer than eight, or
/// not from 430 nm or less to 650 nm or more. @throws UsageError
void prepare_for_colour(std::vector<double>& wavelength_nm) {
    std::sort(wavelength_nm.begin(), wavelength_nm.end());
    wavelength_nm.erase(std::unique(wavelength_nm.begin(), wavelength_nm.end()),
                        wavelength_nm.end());
    // Fewer, or a part of the visible, give another colour without a sign of it (docs/colour.md).
    if (covers_the_visible(wavelength_nm)) return;
    throw UsageError(
        "--colour needs at least eight wavelengths, from 430 nm or less to 650 nm or more; write "
        "e.g. --wavelengths 400:700:10");
}

}  // namespace

void BrdfArguments::add_to(CLI::App& command, Shell& shell) {
    scene_.add_to(command, shell);
    add_list(command, "--mu-in", mu_in_, "cosines of the angles of incidence, in (0, 1]")
        ->required();
    add_list(command, "--mu-out", mu_out_, "cosines of the angles of reflection, in (0, 1]")
        ->required();
    add_list(command, "--azimuth", azimuth_,
             "degrees between the planes of incidence and reflection; 0: mirror side, 180: back "
             "towards the source")
        ->capture_default_str();
    add_list(command, "--component", components_,
             "total, subsurface, surface; several give a column each")
        ->capture_default_str();
    command.add_option("--quantity", quantity_, "brdf (1/sr) or reflection (pi times it)")
        ->type_name("NAME")
        ->capture_default_str();
}

BrdfQuestion BrdfArguments::parse() const {
    BrdfQuestion question;
    question.request = scene_.parse();
    question.directions = {cosines(mu_in_, "mu_in"), cosines(mu_out_, "mu_out"),
                           parse_number_list(azimuth_, "azimuth (degrees)", -360.0, 360.0)};
    question.columns = parse_components(components_, question.request.scene.surface.has_value());
    const auto wanted = [&](BrdfPart part) {
        return std::find(question.columns.begin(), question.columns.end(), part) !=
               question.columns.end();
    };
    question.parts = {wanted(BrdfPart::subsurface), wanted(BrdfPart::surface),
                      wanted(BrdfPart::total)};
    if (quantity_ != "brdf" && quantity_ != "reflection") {
        throw UsageError(
            fmt::format("unknown quantity '{}'; allowed: brdf, reflection", quantity_));
    }
    question.as_reflection = quantity_ == "reflection";
    return question;
}

void AlbedoArguments::add_to(CLI::App& command, Shell& shell) {
    scene_.add_to(command, shell);
    add_list(command, "--mu-in", mu_in_, "cosines of the angles of incidence, in (0, 1]")
        ->capture_default_str();
    command
        .add_option("--colour", colour_,
                    "colours instead of spectra, under this illuminant: d65, a or e; XYZ, CIELAB, "
                    "sRGB of the 1931 observer")
        ->type_name("ILLUMINANT");
}

AlbedoQuestion AlbedoArguments::parse() const {
    AlbedoQuestion question;
    question.request = scene_.parse();
    question.mu_in = cosines(mu_in_, "mu_in");
    if (colour_.empty()) return question;
    question.illuminant = parse_illuminant(colour_);
    prepare_for_colour(question.request.wavelength_nm);
    return question;
}

}  // namespace miebrdf::program
