// miebrdf export: a scene's BRDF in the formats that renderers and tools read.
#include <fmt/format.h>

#include <miebrdf/brdf.h>
#include <miebrdf/error.h>
#include "pipeline/formats/brdf_export.h"
#include "tools/miebrdf/command.h"
#include "tools/miebrdf/export_options.h"
#include "tools/miebrdf/spectrum_export.h"

namespace miebrdf::program {
namespace {

std::string describe(const exports::ExportedFile& file) {
    std::string line = file.path.string();
    line += file.bytes > 0 ? fmt::format(": {} bytes", file.bytes) : ": written";
    if (!file.deviation) return line + ", exact at its directions";
    line += "; read back, relative error (rms)";
    for (std::size_t band = 0; band < 3; ++band) {
        line += fmt::format("{} {:.2g} at {}", band == 0 ? "" : ",", file.deviation->rms[band],
                            exports::kDeviationBands[band]);
    }
    return line + fmt::format(", {:.2g} near the mirror direction", file.deviation->lobe);
}

/// What `--json` tells of the files.
Table table_of(const std::vector<exports::ExportedFile>& files, const ResultReport& report) {
    Table table;
    table.facts = {{"error_estimate", rounded(report.error_estimate(), 3)},
                   {"tolerance", report.tolerance},
                   {"converged", std::string(report.converged() ? "yes" : "no")}};
    table.columns = {"file", "bytes"};
    for (const char* band : exports::kDeviationBands) {
        table.columns.push_back(fmt::format("rms_deviation ({})", band));
    }
    table.columns.emplace_back("lobe_deviation");
    for (const exports::ExportedFile& file : files) {
        std::vector<Cell> row = {file.path.string(), double(file.bytes)};
        row.resize(table.columns.size());  // empty: exact at its directions
        for (std::size_t band = 0; file.deviation && band < 3; ++band) {
            row[2 + band] = rounded(file.deviation->rms[band], 3);
        }
        if (file.deviation) row.back() = rounded(file.deviation->lobe, 3);
        table.rows.push_back(std::move(row));
    }
    return table;
}

int write_export(const Brdf& brdf, const ExportArguments& arguments, const Shell& shell) {
    const std::string& output = shell.common().output;
    const exports::ExportOptions options = arguments.file(brdf.wavelength_nm());
    const BrdfTable table =
        brdf.table({parse_brdf_part(arguments.component()), shell.command_line()});
    std::vector<exports::ExportedFile> files;
    try {
        files = exports::export_brdf(table, options, output, shell.control());
    } catch (const exports::TooCoarse& error) {
        shell.note(std::string("error: ") + error.what());
        return kCheckFailed;
    }
    for (const auto& file : files) shell.note(describe(file));
    const ResultReport& report = table.report();
    shell.tell_written(table_of(files, report));
    shell.note(report.summary() + (report.converged() ? "" : "; all values are written"));
    return report.converged() ? kGood : kNotConverged;
}

Job prepare_export(const std::shared_ptr<ExportArguments>& arguments, const Shell& shell) {
    const std::string& output = shell.common().output;
    if (output.empty() || output == "-")
        throw UsageError("export needs -o FILE (in a scene file, an 'output')");
    arguments->check_format();
    const Request request = arguments->scene();
    const Brdf brdf = solve(request.scene, request.wavelength_nm, request.solver, shell.control());
    if (is_spectrum_format(arguments->format())) {
        return
            [brdf, arguments, &shell] { return export_spectrum(arguments->format(), brdf, shell); };
    }
    arguments->file(request.wavelength_nm);  // refuses lists that are wrong
    return [brdf, arguments, &shell] { return write_export(brdf, *arguments, shell); };
}

}  // namespace

void add_export(CLI::App& command, Shell& shell) {
    auto arguments = std::make_shared<ExportArguments>();
    arguments->add_to(command, shell);
    shell.add_common_options(command, Writes::file);
    command.footer(
        "Example:\n  miebrdf export --format rgl --base TiO2 --coat AlGaAs7@0.1 --wavelengths "
        "400:700:10 "
        "-o algaas7_on_tio2.bsdf");
    shell.on_prepare(command, [arguments, &shell] { return prepare_export(arguments, shell); });
}

}  // namespace miebrdf::program
