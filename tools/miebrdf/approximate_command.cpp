// miebrdf approximate: models of few parameters in place of a scene's BRDF, with what they miss.
#include <fmt/format.h>

#include "tools/miebrdf/export_options.h"
#include "tools/miebrdf/result_facts.h"

namespace miebrdf::program {
namespace {

struct ApproximateArguments {
    SceneArguments scene;
    std::string model, rgb = "auto";
    bool acescg = false;
};

void add_residuals(Table& table, const Deviation& deviation) {
    for (const RegionDeviation& region : deviation.regions)
        table.facts.emplace_back(fmt::format("residual ({})", region.name),
                                 fmt::format("{:.2g} rms, worst {}", region.rms, worst_of(region)));
}

Table ground_table(const GroundFit& fit, const BrdfSource& source, const std::string& model) {
    Table table;
    table.facts = {{"model", model}, {"weights", fit.weights}};
    add_residuals(table, fit.deviation);
    table.columns = {"wavelength_nm", "parameter", "value"};
    for (std::size_t w = 0; w < fit.grounds.size(); ++w) {
        for (std::size_t p = 0; p < fit.parameters.size(); ++p)
            table.rows.push_back(
                {source.wavelength_nm()[w], fit.parameters[p], fit.grounds[w].values[p]});
    }
    return table;
}

Table openpbr_table(const OpenPbrFit& fit) {
    Table table;
    table.facts = {{"model", std::string("OpenPBR 1.1; subsurface_radius in mm")},
                   {"colour_space", fit.colour_space},
                   {"colour", fit.colour},
                   {"weights", fit.weights}};
    add_residuals(table, fit.deviation);
    table.columns = {"wavelength_nm", "parameter", "value"};
    for (const OpenPbrParameter& one : openpbr_parameters()) {
        if (one.number != nullptr) {
            table.rows.push_back({std::string(), std::string(one.name), fit.surface.*one.number});
            continue;
        }
        for (std::size_t c = 0; c < 3; ++c)
            table.rows.push_back({std::string(), fmt::format("{}_{}", one.name, "rgb"[c]),
                                  (fit.surface.*one.colour)[c]});
    }
    return table;
}

}  // namespace

void add_approximate(CLI::App& command, Shell& shell) {
    auto arguments = std::make_shared<ApproximateArguments>();
    option(command, "--model", arguments->model, "NAME",
           "openpbr fits colours; rpv, ross-li, hapke and lambert fit the numbers of a ground at "
           "each wavelength, as --substrate takes them")
        ->required()
        ->check(CLI::IsMember({"openpbr", "rpv", "ross-li", "hapke", "lambert"}));
    arguments->scene.add_to(command, shell);
    default_to_reciprocal(command);
    option(command, "--rgb", arguments->rgb, "HOW",
           "how the colours of openpbr are made: cie (observer and D65), wavelengths (the nearest "
           "to 620, 535 and 480 nm), or auto (cie if the wavelengths cover the visible)");
    command.add_flag("--acescg", arguments->acescg,
                     "give the colours of openpbr in ACEScg, in place of linear sRGB");
    shell.add_common_options(command);
    command.footer(
        "Example:\n  miebrdf approximate --model openpbr --base "
        "'TiO2,radius=0.13,volume=15% in index:1.5' --boundary rough:0.1 --wavelengths 400:700:10");
    shell.on_prepare(command, [arguments, &shell]() -> Job {
        Request request = exported_request(arguments->scene);
        const Brdf brdf = solved(request, shell.control());
        return [brdf, arguments, &shell] {
            const BrdfTable source = brdf.table({.command_line = shell.command_line()});
            const std::string& model = arguments->model;
            Table table;
            if (model == "openpbr") {
                ExportOptions options;
                options.rgb = arguments->rgb;
                options.extra["acescg"] = arguments->acescg ? 1 : 0;
                options.subsurface = subsurface_of(brdf);
                table = openpbr_table(fit_openpbr(source, options, shell.control()));
            } else {
                table = ground_table(fit_ground(source, model, shell.control()), source, model);
            }
            if (!source.report().converged()) shell.note(source.report().summary());
            return shell.write(std::move(table), source.report().converged());
        };
    });
}

}  // namespace miebrdf::program
