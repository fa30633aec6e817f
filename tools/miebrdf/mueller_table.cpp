#include "tools/miebrdf/reflection_tables.h"

#include <fmt/format.h>

#include <algorithm>
#include <numbers>

#include <miebrdf/error.h>
#include "pipeline/formats/table/tabulate.h"
#include "tools/miebrdf/result_facts.h"

namespace miebrdf::program {
namespace {

void refuse_other_questions(const BrdfQuestion& question) {
    if (question.diffuse_fraction || question.viewing) {
        throw UsageError(
            "--stokes 3 and 4 give Mueller matrices; leave out --quantity hdrf and --colour, or "
            "write --stokes auto");
    }
    if (question.columns != std::vector{BrdfPart::total})
        throw UsageError("--stokes 3 and 4 give the matrix of the whole; leave out --component");
}

std::vector<std::string> columns_of(int components) {
    std::vector<std::string> names = {"wavelength_nm", "mu_in", "mu_out", "azimuth_deg"};
    for (std::string& element : mueller_names(components)) names.push_back(std::move(element));
    names.insert(names.end(), {"dolp", "aolp_deg"});
    return names;
}

void add_physics(Table& table, const MuellerValues& values) {
    table.report_columns.insert(table.report_columns.end(), {"largest_albedo", "least_value"});
    for (std::size_t w = 0; w < values.mueller.size(); ++w) {
        const auto& albedo = values.plane_albedo[w];
        const auto elements = static_cast<std::size_t>(values.components * values.components);
        double least = values.mueller[w].front();
        for (std::size_t i = 0; i < values.mueller[w].size(); i += elements)
            least = std::min(least, values.mueller[w][i]);
        table.report[w].emplace_back(*std::max_element(albedo.begin(), albedo.end()));
        table.report[w].emplace_back(least);
    }
}

// The mirror reflection is no value of the matrices; the facts say it.
void add_mirror(Table& table, const MuellerValues& values) {
    const auto c = static_cast<std::size_t>(values.components);
    for (std::size_t w = 0; w < values.mirror_mueller.size(); ++w) {
        for (std::size_t i = 0; i < values.directions.mu_in.size(); ++i) {
            const double* m = values.mirror_mueller[w].data() + i * c * c;
            std::string text =
                fmt::format("{} nm, mu_in {}: m11 = {:.6g}, m12 = {:.6g}, m33 = {:.6g}",
                            values.wavelengths[w].wavelength_nm, values.directions.mu_in[i], m[0],
                            m[1], m[2 * c + 2]);
            if (c == 4) text += fmt::format(", m34 = {:.6g}", m[2 * c + 3]);
            table.facts.emplace_back("mirror_mueller",
                                     text + " into the mirror direction alone; not in the values");
        }
    }
}

/// @param values  must stay where it is until the rows are written
RowSource rows_of(const MuellerValues& values, double factor) {
    const std::size_t outs = values.directions.mu_out.size(),
                      azimuths = values.directions.azimuth_deg.size(),
                      ins = values.directions.mu_in.size();
    const auto fill = [&values, factor, outs, azimuths, ins](std::size_t index,
                                                             std::vector<Cell>& row) {
        const auto& [mu_in, mu_out, azimuth_deg] = values.directions;
        const std::size_t a = index % azimuths, o = index / azimuths % outs,
                          i = index / azimuths / outs % ins, w = index / azimuths / outs / ins;
        row = {values.wavelengths[w].wavelength_nm, mu_in[i], mu_out[o], azimuth_deg[a]};
        for (int r = 0; r < values.components; ++r) {
            for (int c = 0; c < values.components; ++c)
                row.emplace_back(factor * values.at(w, i, o, a, r, c));
        }
        row.emplace_back(values.degree_of_linear_polarisation(w, i, o, a));
        row.emplace_back(values.angle_of_polarisation_deg(w, i, o, a));
    };
    return {values.mueller.size() * ins * outs * azimuths, fill};
}

}  // namespace

int write_mueller(const Brdf& brdf, const BrdfQuestion& question, const Shell& shell) {
    refuse_other_questions(question);
    const MuellerValues values = brdf.mueller(question.directions);
    for (const std::string& note : values.notes) shell.note("note: " + note);
    Table table;
    add_facts(
        table, values, brdf.scene(),
        std::string("wavelength_nm: nm in vacuum; mu: cosine from the normal; azimuth_deg: "
                    "0 = mirror side, 180 = towards the source; ") +
            (question.as_reflection ? "m: Mueller matrix of pi times the BRDF"
                                    : "m: Mueller matrix of the BRDF, 1/sr, cosine not "
                                      "included") +
            ", row = outgoing, column = incident component of (I, Q, U, V), Q = parallel "
            "minus perpendicular to the meridian plane; dolp, aolp_deg: degree and angle "
            "(from the meridian plane) of linear polarisation of reflected unpolarised light");
    add_physics(table, values);
    add_mirror(table, values);
    table.columns = columns_of(values.components);
    table.more_rows = rows_of(values, question.as_reflection ? std::numbers::pi : 1.0);
    return shell.write(std::move(table), values.converged());
}

}  // namespace miebrdf::program
