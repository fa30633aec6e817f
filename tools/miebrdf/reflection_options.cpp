#include "tools/miebrdf/reflection_options.h"

#include <fmt/format.h>

#include <algorithm>

#include <miebrdf/error.h>
#include "pipeline/formats/rgb_weights.h"
#include "pipeline/scene/number_list.h"

namespace miebrdf::program {
namespace {

CLI::Option* add_list(CLI::App& command, const char* name, std::string& text, const char* help) {
    return command.add_option(name, text, help)->type_name("LIST");
}

std::vector<double> cosines(const std::string& text, const char* name) {
    return parse_number_list(text, name, 0.0, 1.0, true);
}

/// Reads d65, a or e. @throws UsageError
Illuminant parse_illuminant(const std::string& name) {
    if (name == "d65") return Illuminant::d65;
    if (name == "a") return Illuminant::a;
    if (name == "e") return Illuminant::e;
    throw UsageError(fmt::format("unknown illuminant '{}'; allowed: d65, a, e", name));
}

/// Sorts the wavelengths and refuses those that no colour can be told from: fewer than eight, or
/// not from 430 nm or less to 650 nm or more. @throws UsageError
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

}  // namespace

void BrdfArguments::add_to(CLI::App& command) {
    scene_.add_to(command);
    add_list(command, "--mu-in", mu_in_, "cosines of incidence, in (0, 1]")->required();
    add_list(command, "--mu-out", mu_out_, "cosines of reflection, in (0, 1]")->required();
    add_list(command, "--azimuth", azimuth_,
             "degrees; 0 = mirror side, 180 = back towards the source")
        ->capture_default_str();
    add_list(command, "--component", components_,
             "total, subsurface, surface; several give a column each")
        ->capture_default_str();
    command.add_option("--quantity", quantity_, "brdf (1/sr) or reflection (pi times it)")
        ->capture_default_str();
}

std::vector<std::string> BrdfArguments::components() const { return split_list(components_); }

Request BrdfArguments::parse() const {
    Request request = scene_.parse();
    request.directions = {cosines(mu_in_, "mu_in"), cosines(mu_out_, "mu_out"),
                          parse_number_list(azimuth_, "azimuth (degrees)", -360.0, 360.0)};
    const std::vector<std::string> names = components();
    for (const std::string& name : names) {
        if (std::count(names.begin(), names.end(), name) > 1) {
            throw UsageError(fmt::format("component '{}' is named twice", name));
        }
        if (name != "total" && name != "subsurface" && name != "surface") {
            throw UsageError(
                fmt::format("unknown component '{}'; allowed: total, subsurface, surface", name));
        }
        if (name == "surface" && !request.scene.surface) {
            throw UsageError("component 'surface' needs a surface; give --roughness, e.g. 0.3");
        }
    }
    const auto wanted = [&](const char* name) {
        return std::find(names.begin(), names.end(), name) != names.end();
    };
    request.parts = {wanted("subsurface"), wanted("surface"), wanted("total")};
    if (quantity_ != "brdf" && quantity_ != "reflection") {
        throw UsageError(
            fmt::format("unknown quantity '{}'; allowed: brdf, reflection", quantity_));
    }
    return request;
}

void AlbedoArguments::add_to(CLI::App& command) {
    scene_.add_to(command);
    add_list(command, "--mu-in", mu_in_, "cosines of incidence, in (0, 1]")->capture_default_str();
    command
        .add_option("--colour", colour_,
                    "colours instead of spectra, under this illuminant: d65, a or e; XYZ, CIELAB, "
                    "sRGB of the 1931 observer")
        ->type_name("ILLUMINANT");
}

std::optional<Illuminant> AlbedoArguments::illuminant() const {
    if (colour_.empty()) return std::nullopt;
    return parse_illuminant(colour_);
}

Request AlbedoArguments::parse() const {
    Request request = scene_.parse();
    request.directions.mu_in = cosines(mu_in_, "mu_in");
    if (illuminant()) prepare_for_colour(request);
    return request;
}

}  // namespace miebrdf::program
