#include "tools/miebrdf/reflection_tables.h"

#include <fmt/format.h>

#include <miebrdf/colour.h>
#include "tools/miebrdf/colour_table.h"
#include "tools/miebrdf/result_facts.h"

namespace miebrdf::program {
namespace {

/// Adds the facts of both grounds.
void add_ground_facts(Table& table, const AlbedoQuestion& question, const AlbedoValues& over_dark,
                      const AlbedoValues& over_light) {
    table.facts.emplace_back(
        "over", fmt::format("{} and {}", describe(question.over[0]), describe(question.over[1])));
    for (const std::string& line : over_light.shortfalls())
        table.facts.emplace_back("not converged",
                                 "over " + describe(question.over[1]) + ": " + line);
    if (over_light.error_estimate() > over_dark.error_estimate()) {
        table.facts.emplace_back("error_estimate",
                                 fmt::format("over {}: {:.3g}", describe(question.over[1]),
                                             over_light.error_estimate()));
    }
}

int write_spectra(const AlbedoQuestion& question, Request request, const Shell& shell) {
    Control control = shell.control();
    if (control.memo == nullptr) control.memo = make_optics_memo();
    std::vector<AlbedoValues> over;
    for (const Substrate& ground : question.over) {
        request.scene.substrate = ground;
        over.push_back(solved(request, control).albedo(question.mu_in));
    }
    for (const std::string& note : over[0].notes) shell.note("note: " + note);
    Table table;
    add_facts(table, over[0], request.scene,
              "wavelength_nm: nm in vacuum; mu_in: cosine from the normal, empty of uniform light; "
              "albedos and their ratio dimensionless");
    add_ground_facts(table, question, over[0], over[1]);
    table.columns = {"wavelength_nm", "mu_in", "albedo_over_dark", "albedo_over_light", "ratio"};
    for (std::size_t w = 0; w < request.wavelength_nm.size(); ++w) {
        const auto add_row = [&](const Cell& mu_in, double dark, double light) {
            table.rows.push_back({request.wavelength_nm[w], mu_in, dark, light,
                                  light > 0.0 ? Cell(dark / light) : Cell()});
        };
        for (std::size_t i = 0; i < question.mu_in.size(); ++i)
            add_row(question.mu_in[i], over[0].at(w, i), over[1].at(w, i));
        add_row(Cell(), over[0].spherical_albedo[w], over[1].spherical_albedo[w]);
    }
    return shell.write(std::move(table), over[0].converged() && over[1].converged());
}

int write_colours(const AlbedoQuestion& question, const Request& request, const Shell& shell) {
    DrawdownOptions options;
    options.dark = question.over[0];
    options.light = question.over[1];
    options.viewing = *question.viewing;
    const Drawdown result = draw_down(request.scene, request.wavelength_nm, question.mu_in, options,
                                      request.solver, shell.control());
    for (const std::string& note : result.over_dark.notes) shell.note("note: " + note);
    ReferenceColours reference;
    if (!question.reference.empty())
        reference = reference_albedos(question.reference, question, shell.control());
    ColourColumns colours(request.wavelength_nm, options.viewing, std::move(reference));
    Table table;
    table.columns = {"over", "quantity", "mu_in"};
    colours.add_names(table);
    table.columns.insert(table.columns.end(),
                         {"contrast_ratio", "hiding_relative_depth", "hiding_thickness_um",
                          "hiding_spreading_rate_m2_per_l"});
    const auto add_rows = [&](const Substrate& ground, const AlbedoValues& values) {
        const auto spectra = spectra_of(values, {});
        for (std::size_t r = 0; r < spectra.size(); ++r) {
            const bool plane = r < question.mu_in.size();
            table.rows.push_back({describe(ground),
                                  std::string(plane ? "plane_albedo" : "spherical_albedo"),
                                  plane ? Cell(question.mu_in[r]) : Cell()});
            colours.add_cells(table, spectra[r]);
            const Hiding& hiding = result.hiding[r];
            table.rows.back().insert(
                table.rows.back().end(),
                {hiding.contrast_ratio, cell_of(hiding.relative_depth),
                 cell_of(hiding.thickness_um), cell_of(hiding.spreading_rate_m2_per_l)});
        }
    };
    add_rows(options.dark, result.over_dark);
    add_rows(options.light, result.over_light);
    add_facts(table, result.over_dark, request.scene,
              "mu_in: cosine from the normal; " + colours.units() +
                  "; contrast_ratio: Y over the dark ground by Y over the light one; hiding_...: "
                  "where it is 0.98, in multiples of the layers' depth, um, m2 per litre of dry "
                  "film; empty: needs thicknesses, or no depth hides");
    add_ground_facts(table, question, result.over_dark, result.over_light);
    colours.add_facts(table);
    return shell.write(std::move(table),
                       result.over_dark.converged() && result.over_light.converged());
}

}  // namespace

int write_drawdown(const AlbedoQuestion& question, const Shell& shell) {
    return question.viewing ? write_colours(question, question.request, shell)
                            : write_spectra(question, question.request, shell);
}

}  // namespace miebrdf::program
