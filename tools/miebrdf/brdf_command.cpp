// miebrdf brdf and miebrdf albedo: a scene's reflection.
#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>

#include <miebrdf/colour.h>
#include "tools/miebrdf/command.h"
#include "tools/miebrdf/reflection_options.h"

namespace miebrdf::program {
namespace {

/// What a result says about itself at each wavelength, without its physics.
void add_report(Table& table, const ResultReport& result) {
    table.report_columns = {"wavelength_nm", "converged", "error_estimate", "mie_error_estimate",
                            "phase_noise",   "streams",   "moments",        "azimuthal_orders"};
    for (const WavelengthReport& report : result.wavelengths) {
        const rte::SolverReport& solver = report.solver;
        table.report.push_back({report.wavelength_nm, std::string(report.converged ? "yes" : "no"),
                                report.error_estimate, report.mie_error_estimate,
                                report.phase_noise.largest, double(solver.streams),
                                double(solver.moments), double(solver.fourier_orders)});
    }
}

void add_physics(Table& table, const BrdfValues& values) {
    table.report_columns.insert(table.report_columns.end(),
                                {"layers_reciprocity_defect", "layers_largest_albedo",
                                 "reciprocity_defect", "largest_albedo", "least_value"});
    for (std::size_t w = 0; w < values.slices.size(); ++w) {
        const BrdfValues::Slice& slice = values.slices[w];
        std::vector<Cell>& row = table.report[w];
        row.push_back(cell_of(slice.layers_physics.reciprocity_defect));
        row.push_back(cell_of(slice.layers_physics.largest_albedo));
        row.push_back(cell_of(slice.physics.reciprocity_defect));
        row.push_back(cell_of(slice.physics.largest_albedo));
        row.emplace_back(slice.physics.least_value);
    }
}

/// The optical depth of every layer at every wavelength; one number where they agree.
void add_depths(Table& table, const ResultReport& result, const Scene& scene) {
    std::size_t layer = 0;
    for (std::size_t c = 0; c < scene.layers.size(); ++c) {
        if (scene.layers[c].depth.value == 0.0) continue;
        std::vector<std::string> texts;
        bool same = true;
        double first = std::numeric_limits<double>::quiet_NaN();
        for (const WavelengthReport& at : result.wavelengths) {
            if (layer >= at.optical_depths.size()) continue;
            const double depth = at.optical_depths[layer];
            if (texts.empty()) first = depth;
            same = same && depth == first;
            texts.push_back(fmt::format("{:.6g} at {} nm", depth, at.wavelength_nm));
        }
        ++layer;
        if (texts.empty()) continue;
        table.facts.emplace_back(
            "optical_depth",
            fmt::format(
                "coat {} ({}@{}): {}", c + 1, describe(scene.layers[c].medium),
                describe(scene.layers[c].depth),
                same ? fmt::format("{:.6g}", first) : fmt::format("{}", fmt::join(texts, ", "))));
    }
}

/// What the output says about how it was computed.
void add_facts(Table& table, const ResultReport& result, const Scene& scene,
               const std::string& units) {
    table.facts.emplace_back("units", units);
    for (const std::string& source : result.sources) table.facts.emplace_back("source", source);
    if (const std::string particles = describe_particles(scene); !particles.empty())
        table.facts.emplace_back("particles", particles);
    add_depths(table, result, scene);
    for (const std::string& note : result.notes) table.facts.emplace_back("note", note);
    table.facts.emplace_back("tolerance", result.tolerance);
    table.facts.emplace_back("error_estimate", rounded(result.error_estimate(), 3));
    const WavelengthReport& noisiest = result.noisiest();
    const PhaseNoise& noise = noisiest.phase_noise;
    if (noise.largest > 0.1 * result.tolerance) {
        table.facts.emplace_back("phase_noise",
                                 fmt::format("{:.2e} at most, of single directions (rms, relative "
                                             "like error_estimate, which has "
                                             "twice this in it), at {} nm, mu_in {}, mu_out {}, "
                                             "azimuth {}; from the number of sphere "
                                             "sizes; a smaller --tolerance lowers it",
                                             noise.largest, noisiest.wavelength_nm, noise.mu_in,
                                             noise.mu_out, noise.azimuth_deg));
    }
    table.facts.emplace_back("method", result.wavelengths.front().solver.method);
    for (const std::string& line : result.shortfalls())
        table.facts.emplace_back("not converged", line);
    add_report(table, result);
}

/// What a smooth boundary sends into the mirror direction is no value of the BRDF: it is said.
void add_mirror(Table& table, const BrdfValues& values) {
    const std::vector<double>& mu_in = values.directions.mu_in;
    for (std::size_t i = 0; i < mu_in.size(); ++i) {
        std::vector<double> shares;
        for (const BrdfValues::Slice& slice : values.slices) {
            if (!slice.mirror_reflectance.empty()) shares.push_back(slice.mirror_reflectance[i]);
        }
        if (shares.empty()) return;
        const auto [least, largest] = std::minmax_element(shares.begin(), shares.end());
        const std::string range = *least == *largest
                                      ? fmt::format("{:.6g}", *least)
                                      : fmt::format("{:.6g} to {:.6g}", *least, *largest);
        table.facts.emplace_back(
            "mirror_reflectance",
            fmt::format("mu_in {}: {} of the light goes into the mirror direction alone; not in "
                        "the values",
                        mu_in[i], range));
    }
}

void add_rows(Table& table, const BrdfValues& values, const BrdfQuestion& question) {
    const double factor = question.as_reflection ? std::numbers::pi : 1.0;
    const auto& [mu_in, mu_out, azimuth_deg] = question.directions;
    for (std::size_t w = 0; w < values.slices.size(); ++w) {
        std::size_t index = 0;
        for (const double in : mu_in) {
            for (const double out : mu_out) {
                for (const double azimuth : azimuth_deg) {
                    auto& row = table.rows.emplace_back(
                        std::vector<Cell>{values.wavelengths[w].wavelength_nm, in, out, azimuth});
                    for (const BrdfPart part : question.columns)
                        row.emplace_back(factor * values.slices[w].of(part)[index]);
                    ++index;
                }
            }
        }
    }
}

int write_brdf(const Brdf& brdf, const BrdfQuestion& question, const Shell& shell) {
    const BrdfValues values = brdf.evaluate(question.directions, question.parts);
    for (const std::string& note : values.notes) shell.note("note: " + note);
    Table table;
    add_facts(table, values, brdf.scene(),
              std::string("wavelength_nm: nm in vacuum; mu: cosine from the normal; azimuth_deg: "
                          "0 = mirror side, 180 = towards the source; ") +
                  (question.as_reflection ? "reflection: pi times the BRDF, 1 for white Lambertian"
                                          : "brdf: 1/sr, cosine not included"));
    add_physics(table, values);
    add_mirror(table, values);
    const std::string quantity = question.as_reflection ? "reflection" : "brdf";
    table.columns = {"wavelength_nm", "mu_in", "mu_out", "azimuth_deg"};
    for (const BrdfPart part : question.columns) {
        table.columns.push_back(question.columns.size() == 1
                                    ? quantity
                                    : fmt::format("{}_{}", quantity, name_of(part)));
    }
    add_rows(table, values, question);
    shell.write(std::move(table));
    return values.converged() ? kGood : kNotConverged;
}

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

/// XYZ, Lab, encoded sRGB: a row for the plane albedo at each mu_in and one for the spherical
/// albedo, to six decimals.
/// @param wavelength_nm  ascending
void add_colours(Table& table, const AlbedoValues& values, const std::vector<double>& wavelength_nm,
                 Illuminant illuminant) {
    const ObserverWeights weights = observer_weights(wavelength_nm, illuminant);
    table.columns = {"quantity", "mu_in", "x",        "y",          "z",        "lab_l",
                     "lab_a",    "lab_b", "srgb_red", "srgb_green", "srgb_blue"};
    for (std::size_t i = 0; i < values.mu_in.size(); ++i) {
        std::vector<double> albedo;
        for (const std::vector<double>& plane : values.plane_albedo) albedo.push_back(plane[i]);
        table.rows.push_back(
            colour_row("plane_albedo", values.mu_in[i], to_xyz(weights, albedo), illuminant));
    }
    table.rows.push_back(colour_row("spherical_albedo", Cell(),
                                    to_xyz(weights, values.spherical_albedo), illuminant));
}

void add_spectra(Table& table, const AlbedoValues& values) {
    table.columns = {"wavelength_nm", "mu_in", "plane_albedo", "spherical_albedo"};
    const bool transmits = !values.plane_transmittance.empty();
    if (transmits) {
        table.columns.insert(table.columns.end(),
                             {"plane_transmittance", "spherical_transmittance"});
    }
    const bool mirrors = !values.mirror_reflectance.empty();
    if (mirrors) table.columns.emplace_back("mirror_reflectance");
    for (std::size_t w = 0; w < values.wavelengths.size(); ++w) {
        for (std::size_t i = 0; i < values.mu_in.size(); ++i) {
            auto& row = table.rows.emplace_back(
                std::vector<Cell>{values.wavelengths[w].wavelength_nm, values.mu_in[i],
                                  values.at(w, i), values.spherical_albedo[w]});
            if (transmits) {
                row.emplace_back(values.plane_transmittance[w][i]);
                row.emplace_back(values.spherical_transmittance[w]);
            }
            if (mirrors) row.emplace_back(values.mirror_reflectance[w][i]);
        }
    }
}

int write_albedo(const Brdf& brdf, const AlbedoQuestion& question, const Shell& shell) {
    const AlbedoValues values = brdf.albedo(question.mu_in);
    for (const std::string& note : values.notes) shell.note("note: " + note);
    Table table;
    if (question.illuminant) {
        add_facts(table, values, brdf.scene(),
                  "mu_in: cosine from the normal; x, y, z: white of the illuminant has y = 1; lab: "
                  "CIE 1976, white 100, 0, 0; srgb: encoded, not clipped");
        add_colours(table, values, brdf.wavelength_nm(), *question.illuminant);
    } else {
        add_facts(
            table, values, brdf.scene(),
            "wavelength_nm: nm in vacuum; mu_in: cosine from the normal; albedos dimensionless; "
            "transmittances: net flux into what lies below the layers; mirror_reflectance: the "
            "part of plane_albedo that goes into the mirror direction alone");
        add_spectra(table, values);
    }
    shell.write(std::move(table));
    return values.converged() ? kGood : kNotConverged;
}

/// A command whose options are `Arguments`: they are read and the scene's names are looked up
/// before anything is computed.
template <typename Arguments, typename Question>
void add(CLI::App& command, Shell& shell,
         int (*write)(const Brdf&, const Question&, const Shell&)) {
    auto arguments = std::make_shared<Arguments>();
    arguments->add_to(command, shell);
    shell.add_common_options(command);
    shell.on_prepare(command, [arguments, write, &shell]() -> Job {
        const Question question = arguments->parse();
        const Request& request = question.request;
        const Brdf brdf = solved(request, shell.control());
        return [brdf, question, write, &shell] { return write(brdf, question, shell); };
    });
}

}  // namespace

void add_brdf(CLI::App& command, Shell& shell) {
    add<BrdfArguments>(command, shell, write_brdf);
    command.footer(
        "Example:\n  miebrdf brdf --base TiO2 --coat AlGaAs7@0.1 --roughness 0.3 --wavelengths "
        "400:700:10 --mu-in 0.5,1 --mu-out 0.1:1:0.1 --azimuth 0,90,180");
}

void add_albedo(CLI::App& command, Shell& shell) {
    add<AlbedoArguments>(command, shell, write_albedo);
    command.footer(
        "Example:\n  miebrdf albedo --base TiO2 --coat AlGaAs7@0.1 --wavelengths 400:700:50");
}

}  // namespace miebrdf::program
