// miebrdf brdf and miebrdf albedo: a scene's reflection.
#include <fmt/format.h>

#include <algorithm>
#include <numbers>

#include <miebrdf/value_derivatives.h>
#include "tools/miebrdf/colour_table.h"
#include "tools/miebrdf/command.h"
#include "tools/miebrdf/direction_options.h"
#include "tools/miebrdf/reflection_options.h"
#include "tools/miebrdf/reflection_tables.h"
#include "tools/miebrdf/result_facts.h"

namespace miebrdf::program {
namespace {

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

/// The mirror reflection of a smooth boundary is no value of the BRDF; the facts say how much it
/// is.
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

std::size_t count_of(const Directions& directions) {
    return directions.mu_in.size() * directions.mu_out.size() * directions.azimuth_deg.size();
}

/// The cells of a row before its values; directions in the order of values.
void start_row(std::vector<Cell>& row, double wavelength_nm, const Directions& directions,
               std::size_t index) {
    const auto& [mu_in, mu_out, azimuth_deg] = directions;
    const std::size_t pair = index / azimuth_deg.size();
    row = {wavelength_nm, mu_in[pair / mu_out.size()], mu_out[pair % mu_out.size()],
           azimuth_deg[index % azimuth_deg.size()]};
}

/// @param all  must stay where it is until the rows are written
RowSource rows_of(const WithDerivatives<BrdfValues>& all, const BrdfQuestion& question) {
    const double factor = question.as_reflection ? std::numbers::pi : 1.0;
    const std::size_t directions = count_of(all.values.directions);
    return {all.values.slices.size() * directions,
            [&all, &question, factor, directions](std::size_t i, std::vector<Cell>& row) {
                const std::size_t w = i / directions, index = i % directions;
                start_row(row, all.values.wavelengths[w].wavelength_nm, all.values.directions,
                          index);
                const auto add = [&](const BrdfValues& values) {
                    for (const BrdfPart part : question.columns)
                        row.emplace_back(factor * values.slices[w].of(part)[index]);
                };
                add(all.values);
                for (const BrdfValues& derivative : all.derivatives) add(derivative);
            }};
}

void add_derivative_fact(Table& table, const std::vector<std::string>& parameters) {
    if (parameters.empty()) return;
    table.facts.emplace_back(
        "derivatives",
        "VALUE_d_NAME: per unit in which the number is written; n(NAME), k(NAME): per 1");
}

/// Adds a column for the derivative of each value by each parameter.
void add_derivative_columns(Table& table, std::size_t first_value,
                            const std::vector<std::string>& parameters) {
    const std::size_t end = table.columns.size();
    for (const std::string& parameter : parameters) {
        for (std::size_t c = first_value; c < end; ++c)
            table.columns.push_back(fmt::format("{}_d_{}", table.columns[c], parameter));
    }
    add_derivative_fact(table, parameters);
}

/// Adds the cells of derivatives to the last row.
void add_colour_derivatives(const ColourColumns& colours, Table& table,
                            const std::vector<double>& spectrum,
                            const std::vector<std::vector<std::vector<double>>>& slopes,
                            std::size_t row) {
    for (const auto& of_parameter : slopes)
        colours.add_derivative_cells(table, spectrum, of_parameter[row]);
}

int write_brdf_colours(const Brdf& brdf, const BrdfQuestion& question,
                       const WithDerivatives<BrdfValues>& all, const Shell& shell) {
    const BrdfValues& values = all.values;
    ReferenceColours reference;
    if (!question.reference.empty())
        reference = reference_reflectances(question.reference, question, shell.control());
    ColourColumns colours(brdf.wavelength_nm(), *question.viewing, std::move(reference));
    Table table;
    table.columns = {"mu_in", "mu_out", "azimuth_deg"};
    colours.add_names(table);
    colours.add_derivative_names(table, all.parameters);
    const auto spectra = spectra_of(values, question.columns.front());
    std::vector<std::vector<std::vector<double>>> slopes;
    for (const BrdfValues& derivative : all.derivatives)
        slopes.push_back(spectra_of(derivative, question.columns.front()));
    std::size_t index = 0;
    for_each_direction(question.directions, [&](double in, double out, double azimuth) {
        table.rows.push_back({in, out, azimuth});
        colours.add_cells(table, spectra[index]);
        add_colour_derivatives(colours, table, spectra[index], slopes, index);
        ++index;
    });
    add_facts(table, values, brdf.scene(),
              std::string("mu: cosine from the normal; azimuth_deg: 0 = mirror side; colours of ") +
                  (question.diffuse_fraction ? "the hdrf; "
                                             : "pi times the BRDF (reflectance factor); ") +
                  colours.units());
    colours.add_facts(table);
    add_derivative_fact(table, all.parameters);
    return shell.write(std::move(table), values.converged());
}

/// Reflectance factors as pi times a BRDF.
WithDerivatives<BrdfValues> factors_of(const HdrfValues& values) {
    WithDerivatives<BrdfValues> all;
    static_cast<ResultReport&>(all.values) = values;
    all.values.directions = values.directions;
    for (std::vector<double> factors : values.hdrf) {
        for (double& factor : factors) factor /= std::numbers::pi;
        all.values.slices.emplace_back().total = std::move(factors);
    }
    return all;
}

int write_hdrf(const Brdf& brdf, const BrdfQuestion& question, const Shell& shell) {
    const double share = *question.diffuse_fraction;
    const auto all =
        hdrf_derivatives(brdf, question.derivatives, question.directions, share, question.sky);
    const HdrfValues& values = all.values;
    for (const std::string& note : values.notes) shell.note("note: " + note);
    if (question.viewing) return write_brdf_colours(brdf, question, factors_of(values), shell);
    Table table;
    add_facts(table, values, brdf.scene(),
              "wavelength_nm: nm in vacuum; mu: cosine from the normal; azimuth_deg: 0 = mirror "
              "side, 180 = towards the sun; hdrf: radiance over that of a white Lambertian surface "
              "in the same light");
    table.facts.emplace_back("diffuse_fraction", values.diffuse_fraction);
    table.columns = {"wavelength_nm", "mu_in", "mu_out", "azimuth_deg", "hdrf"};
    add_derivative_columns(table, 4, all.parameters);
    const std::size_t directions = count_of(values.directions);
    table.more_rows = {values.wavelengths.size() * directions,
                       [&values, &all, directions](std::size_t i, std::vector<Cell>& row) {
                           const std::size_t w = i / directions, index = i % directions;
                           start_row(row, values.wavelengths[w].wavelength_nm, values.directions,
                                     index);
                           row.emplace_back(values.hdrf[w][index]);
                           for (const HdrfValues& derivative : all.derivatives)
                               row.emplace_back(derivative.hdrf[w][index]);
                       }};
    return shell.write(std::move(table), values.converged());
}

int write_brdf(const Brdf& brdf, const BrdfQuestion& question, const Shell& shell) {
    if (question.request.solver.stokes > 1) return write_mueller(brdf, question, shell);
    if (question.diffuse_fraction) return write_hdrf(brdf, question, shell);
    const auto all =
        question.derivatives.empty()
            ? WithDerivatives<BrdfValues>{brdf.evaluate(question.directions, question.parts),
                                          {},
                                          {}}
            : brdf.derivatives(question.derivatives).evaluate(question.directions, question.parts);
    const BrdfValues& values = all.values;
    for (const std::string& note : values.notes) shell.note("note: " + note);
    if (question.viewing) return write_brdf_colours(brdf, question, all, shell);
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
    add_derivative_columns(table, 4, all.parameters);
    table.more_rows = rows_of(all, question);
    return shell.write(std::move(table), values.converged());
}

/// Calls add(name, value) for each quantity at one wavelength and incidence.
template <typename Add>
void for_each_albedo(const AlbedoValues& values, std::size_t w, std::size_t i,
                     const std::optional<double>& diffuse_fraction, const Add& add) {
    add("plane_albedo", values.at(w, i));
    add("spherical_albedo", values.spherical_albedo[w]);
    if (!values.plane_transmittance.empty()) {
        add("plane_transmittance", values.plane_transmittance[w][i]);
        add("spherical_transmittance", values.spherical_transmittance[w]);
        add("unscattered_transmittance", values.unscattered_transmittance[w][i]);
    }
    if (!values.mirror_reflectance.empty())
        add("mirror_reflectance", values.mirror_reflectance[w][i]);
    if (!values.polarised_plane_albedo.empty())
        add("polarised_plane_albedo", values.polarised_plane_albedo[w][i]);
    if (diffuse_fraction) add("blue_sky_albedo", values.under_sky(w, i, *diffuse_fraction));
}

void add_spectra(Table& table, const WithDerivatives<AlbedoValues>& all,
                 const std::optional<double>& diffuse_fraction) {
    const AlbedoValues& values = all.values;
    table.columns = {"wavelength_nm", "mu_in"};
    for_each_albedo(values, 0, 0, diffuse_fraction,
                    [&](const char* name, double) { table.columns.emplace_back(name); });
    if (diffuse_fraction) table.facts.emplace_back("diffuse_fraction", *diffuse_fraction);
    add_derivative_columns(table, 2, all.parameters);
    for (std::size_t w = 0; w < values.wavelengths.size(); ++w) {
        for (std::size_t i = 0; i < values.mu_in.size(); ++i) {
            auto& row = table.rows.emplace_back(
                std::vector<Cell>{values.wavelengths[w].wavelength_nm, values.mu_in[i]});
            const auto add = [&](const char*, double value) { row.emplace_back(value); };
            for_each_albedo(values, w, i, diffuse_fraction, add);
            for (const AlbedoValues& derivative : all.derivatives)
                for_each_albedo(derivative, w, i, diffuse_fraction, add);
        }
    }
}

int write_albedo_colours(const Brdf& brdf, const AlbedoQuestion& question,
                         const WithDerivatives<AlbedoValues>& all, const Shell& shell) {
    const AlbedoValues& values = all.values;
    ReferenceColours reference;
    if (!question.reference.empty())
        reference = reference_albedos(question.reference, question, shell.control());
    ColourColumns colours(brdf.wavelength_nm(), *question.viewing, std::move(reference));
    Table table;
    table.columns = {"quantity", "mu_in"};
    colours.add_names(table);
    const std::size_t count = values.mu_in.size();
    colours.add_derivative_names(table, all.parameters);
    const auto spectra = spectra_of(values, question.diffuse_fraction);
    std::vector<std::vector<std::vector<double>>> slopes;
    for (const AlbedoValues& derivative : all.derivatives)
        slopes.push_back(spectra_of(derivative, question.diffuse_fraction));
    for (std::size_t r = 0; r < spectra.size(); ++r) {
        if (r == count) {
            table.rows.push_back({std::string("spherical_albedo"), Cell()});
        } else {
            table.rows.push_back({std::string(r < count ? "plane_albedo" : "blue_sky_albedo"),
                                  values.mu_in[r < count ? r : r - count - 1]});
        }
        colours.add_cells(table, spectra[r]);
        add_colour_derivatives(colours, table, spectra[r], slopes, r);
    }
    add_facts(table, values, brdf.scene(), "mu_in: cosine from the normal; " + colours.units());
    colours.add_facts(table);
    add_derivative_fact(table, all.parameters);
    return shell.write(std::move(table), values.converged());
}

int write_gloss(const Brdf& brdf, const AlbedoQuestion& question, const Shell& shell) {
    const GlossValues values = gloss(brdf, question.viewing.value_or(Viewing()));
    for (const std::string& note : values.notes) shell.note("note: " + note);
    Table table;
    add_facts(table, values, brdf.scene(),
              "angle_deg: of incidence and of the receptor; reflectance: luminous flux in the "
              "receptor of ISO 2813 over that incident; gloss_units: 100 for polished black glass "
              "of index 1.567");
    table.facts.emplace_back("viewing", describe(question.viewing.value_or(Viewing())));
    if (!brdf.scene().boundary && !brdf.scene().surface) {
        const std::string note =
            "there is no surface: the gloss is that of light from the layers "
            "alone; give --boundary smooth or rough:ALPHA, or --roughness";
        table.facts.emplace_back("note", note);
        shell.note("note: " + note);
    }
    table.columns = {"angle_deg", "reflectance", "gloss_units"};
    for (const Gloss& at : values.angles)
        table.rows.push_back({at.angle_deg, at.reflectance, at.units});
    shell.write(std::move(table));
    return values.converged() ? kGood : kNotConverged;
}

int write_albedo(const Brdf& brdf, const AlbedoQuestion& question, const Shell& shell) {
    if (question.gloss) return write_gloss(brdf, question, shell);
    if (!question.over.empty()) return write_drawdown(question, shell);
    const auto all = question.derivatives.empty()
                         ? WithDerivatives<AlbedoValues>{brdf.albedo(question.mu_in), {}, {}}
                         : brdf.derivatives(question.derivatives).albedo(question.mu_in);
    const AlbedoValues& values = all.values;
    for (const std::string& note : values.notes) shell.note("note: " + note);
    if (question.viewing) return write_albedo_colours(brdf, question, all, shell);
    Table table;
    add_facts(table, values, brdf.scene(),
              "wavelength_nm: nm in vacuum; mu_in: cosine from the normal; albedos dimensionless: "
              "plane of light from mu_in, spherical of uniform light; transmittances: net flux "
              "into what lies below the layers; mirror_reflectance: the part of plane_albedo that "
              "goes into the mirror direction alone; polarised_plane_albedo: what plane_albedo "
              "changes by for light polarised in the plane of incidence");
    add_spectra(table, all, question.diffuse_fraction);
    return shell.write(std::move(table), values.converged());
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
