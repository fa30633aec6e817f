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

void make_ascending(std::vector<double>& wavelength_nm) {
    std::sort(wavelength_nm.begin(), wavelength_nm.end());
    wavelength_nm.erase(std::unique(wavelength_nm.begin(), wavelength_nm.end()),
                        wavelength_nm.end());
}

std::optional<double> parse_diffuse_fraction(const std::string& text) {
    if (text.empty()) return std::nullopt;
    const double share = parse_number(text, "diffuse-fraction");
    if (!(share >= 0.0 && share <= 1.0)) {
        throw UsageError(fmt::format(
            "--diffuse-fraction {} is out of range; allowed: [0, 1], the share of uniform light "
            "from the sky in all light; the rest is the sun at mu_in",
            text));
    }
    return share;
}

CLI::Option* add_diffuse_fraction(CLI::App& command, std::string& text, const std::string& use) {
    return command
        .add_option("--diffuse-fraction", text,
                    "share of the light that comes uniformly from the whole sky, in [0, 1]; the "
                    "rest is the sun at mu_in: " +
                        use)
        ->type_name("F");
}

void add_derivatives(CLI::App& command, std::string& text) {
    option(command, "--derivatives", text, "NAMES",
           "print derivatives in columns VALUE_d_NAME, by numbers of the scene: those that its "
           "words give a name, as in hg:{w=0.9},{g=0.6}@{tau=2}, and n(MATERIAL), k(MATERIAL)");
}

/// @param excluded  why there are no derivatives here; empty: there are
std::vector<std::string> parse_derivatives(const std::string& text, const std::string& excluded) {
    std::vector<std::string> names = split_list(text);
    std::erase(names, "");
    if (names.empty() || excluded.empty()) return names;
    throw UsageError("--derivatives goes without " + excluded);
}

}  // namespace

std::vector<BrdfPart> parse_components(const std::string& text, const Scene& scene) {
    std::vector<BrdfPart> parts;
    for (const std::string& name : split_list(text)) {
        const BrdfPart part = parse_brdf_part(name);
        if (std::find(parts.begin(), parts.end(), part) != parts.end())
            throw UsageError(fmt::format("component '{}' is named twice", name));
        if (part == BrdfPart::surface && !scene.surface)
            throw UsageError("component 'surface' needs a surface; give --roughness, e.g. 0.3");
        parts.push_back(part);
    }
    return parts;
}

void prepare_for_colour(std::vector<double>& wavelength_nm) {
    make_ascending(wavelength_nm);
    // Fewer, or a part of the visible, give another colour without a sign of it (docs/colour.md).
    if (covers_the_visible(wavelength_nm)) return;
    throw UsageError(
        "--colour needs at least eight wavelengths, from 430 nm or less to 650 nm or more; write "
        "e.g. --wavelengths 400:700:10");
}

std::vector<Substrate> parse_grounds(const std::string& text) {
    std::vector<Substrate> grounds;
    for (const std::string& ground : split_list(text))
        grounds.push_back(ground == "white" ? DrawdownOptions().light : substrate(ground));
    if (grounds.size() != 2) {
        throw UsageError(fmt::format(
            "--over {}: {} grounds; allowed: two, the dark one first: black,white (a Lambertian "
            "ground of albedo {}) or e.g. black,lambert:0.78",
            text, grounds.size(), kWhiteChartAlbedo));
    }
    return grounds;
}

void ColourArguments::add_to(CLI::App& command) {
    option(command, "--colour,--color", viewing_, "ILLUMINANT",
           "print colours in place of spectra: XYZ, Lab, LCh and sRGB under the illuminant d65, "
           "d50, a or e, for the 2-degree observer or (d65,10) the 10-degree one");
    option(command, "--reference", reference_, "FILE",
           "print the colour differences de76 and de2000 from this file: a scene file, a table of "
           "this command, or a measured spectrum (any file that `miebrdf measured` reads)");
}

std::optional<Viewing> ColourArguments::parse(std::vector<double>& wavelength_nm) const {
    if (viewing_.empty()) {
        if (reference_.empty()) return std::nullopt;
        throw UsageError("--reference compares colours; give --colour too, e.g. d65,10");
    }
    const Viewing found = viewing(viewing_);
    prepare_for_colour(wavelength_nm);
    return found;
}

void BrdfArguments::add_to(CLI::App& command, Shell& shell) {
    scene_.add_to(command, shell);
    mu_in_.add_to(command, "cosines of the angles of incidence, in (0, 1]");
    mu_out_.add_to(command, "cosines of the angles of reflection, in (0, 1]");
    add_list(command, "--azimuth", azimuth_,
             "degrees between the planes of incidence and reflection; 0: mirror side, 180: back "
             "towards the source")
        ->capture_default_str();
    add_list(command, "--component", components_,
             "total, subsurface, surface; several give a column each")
        ->capture_default_str();
    option(command, "--quantity", quantity_, "NAME",
           "brdf (1/sr), reflection (pi times it) or hdrf (hemispherical-directional reflectance "
           "factor, of sun and sky together)");
    add_diffuse_fraction(command, diffuse_fraction_, "belongs to --quantity hdrf");
    option(command, "--sky", sky_, "SKY",
           "the sky of --quantity hdrf: uniform, cie-clear, cie-overcast, or a CSV file "
           "zenith_deg,azimuth_deg,radiance (azimuth from the sun), perhaps with wavelength_nm");
    add_derivatives(command, derivatives_);
    colour_.add_to(command);
}

BrdfQuestion BrdfArguments::parse() const {
    BrdfQuestion question;
    question.request = scene_.parse();
    question.directions = {mu_in_.parse(), mu_out_.parse(),
                           parse_number_list(azimuth_, "azimuth (degrees)", -360.0, 360.0)};
    question.columns = parse_components(components_, question.request.scene);
    const auto wanted = [&](BrdfPart part) {
        return std::find(question.columns.begin(), question.columns.end(), part) !=
               question.columns.end();
    };
    question.parts = {wanted(BrdfPart::subsurface), wanted(BrdfPart::surface),
                      wanted(BrdfPart::total)};
    if (quantity_ != "brdf" && quantity_ != "reflection" && quantity_ != "hdrf") {
        throw UsageError(
            fmt::format("unknown quantity '{}'; allowed: brdf, reflection, hdrf", quantity_));
    }
    question.as_reflection = quantity_ == "reflection";
    question.viewing = colour_.parse(question.request.wavelength_nm);
    question.reference = colour_.reference();
    question.diffuse_fraction = parse_diffuse_fraction(diffuse_fraction_);
    if (question.diffuse_fraction.has_value() != (quantity_ == "hdrf")) {
        throw UsageError(
            "--quantity hdrf and --diffuse-fraction belong together, e.g. --quantity hdrf "
            "--diffuse-fraction 0.2");
    }
    if (question.viewing && question.columns.size() != 1)
        throw UsageError("--colour is that of one component's reflection; give one --component");
    question.sky = sky(sky_);
    if (question.sky.kind != Sky::Kind::uniform && !question.diffuse_fraction)
        throw UsageError("--sky belongs to --quantity hdrf --diffuse-fraction F");
    if (question.diffuse_fraction && question.columns != std::vector{BrdfPart::total})
        throw UsageError("--quantity hdrf is that of the whole; leave out --component");
    const bool has_matrix = question.request.solver.stokes > 1;
    question.derivatives = parse_derivatives(
        derivatives_, has_matrix                                      ? "--stokes"
                      : question.viewing && question.diffuse_fraction ? "--colour of the hdrf"
                                                                      : "");
    return question;
}

void AlbedoArguments::add_to(CLI::App& command, Shell& shell) {
    scene_.add_to(command, shell, SceneArguments::Base::optional);
    mu_in_.add_to(command, "cosines of the angles of incidence, in (0, 1]",
                  "0.1:1:0.1; 1 with --over");
    add_diffuse_fraction(command, diffuse_fraction_, "adds the blue-sky albedo");
    add_derivatives(command, derivatives_);
    option(command, "--over", over_, "GROUNDS",
           "albedo of the layers over a dark and over a light ground, each written as for "
           "--substrate, in place of --base or --substrate. black,white is a drawdown over a chart "
           "(white: albedo 0.8): contrast ratio and, with --colour, hiding power");
    command.add_flag(
        "--gloss", gloss_,
        "print gloss at 20, 60 and 85 degrees in gloss units (ISO 2813), in place of albedos");
    colour_.add_to(command);
}

AlbedoQuestion AlbedoArguments::parse() const {
    const bool has_ground = scene_.given("base") || scene_.given("substrate");
    if (over_.empty() && !has_ground) throw UsageError("--base or --substrate is required");
    if (!over_.empty() && has_ground)
        throw UsageError("--over takes the place of --base and --substrate; give one of them");
    AlbedoQuestion question;
    question.request = scene_.parse();
    question.gloss = gloss_;
    if (gloss_) {
        const bool has_others = mu_in_.given() || !over_.empty() || !derivatives_.empty() ||
                                !diffuse_fraction_.empty() || !colour_.reference().empty();
        if (has_others) {
            throw UsageError(
                "--gloss has the angles of the standard and a table of its own; leave out --mu-in, "
                "--theta-in, --over, --diffuse-fraction, --derivatives and --reference");
        }
        make_ascending(question.request.wavelength_nm);
        question.viewing = colour_.parse(question.request.wavelength_nm);
        return question;
    }
    question.mu_in = mu_in_.parse(over_.empty() ? "0.1:1:0.1" : "1");
    question.diffuse_fraction = parse_diffuse_fraction(diffuse_fraction_);
    question.viewing = colour_.parse(question.request.wavelength_nm);
    question.reference = colour_.reference();
    question.derivatives = parse_derivatives(derivatives_, over_.empty() ? "" : "--over");
    if (over_.empty()) return question;
    question.over = parse_grounds(over_);
    question.request.scene.substrate = question.over.front();
    if (question.diffuse_fraction) throw UsageError("--over goes without --diffuse-fraction");
    return question;
}

}  // namespace miebrdf::program
