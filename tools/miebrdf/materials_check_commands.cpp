// miebrdf materials export, diff, verify: figures out, compared, checked.
#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include <miebrdf/database.h>
#include <miebrdf/error.h>
#include "pipeline/io/atomic_file.h"
#include "pipeline/scene/number_list.h"
#include "tools/miebrdf/materials_command.h"

namespace miebrdf::program {
namespace {

using materials::Database;
using materials::RefractiveIndex;

struct DatasetExport {
    DatabaseArgument database;
    std::string name;
    std::string format = "csv";
    std::string wavelengths;  ///< empty: the dataset as it is
    materials::ExportOptions options;
};

// n and k of a dataset, a formula perhaps, as a table at wavelengths.
materials::Dataset sampled(materials::Dataset dataset, const Database& database,
                           std::vector<double> wavelength_nm) {
    std::sort(wavelength_nm.begin(), wavelength_nm.end());
    wavelength_nm.erase(std::unique(wavelength_nm.begin(), wavelength_nm.end()),
                        wavelength_nm.end());
    const RefractiveIndex index = database.refractive_index(dataset.material + "/" + dataset.label);
    std::vector<double> n, k;
    for (const double w : wavelength_nm) {
        n.push_back(index.at(w).real());
        k.push_back(index.at(w).imag());
    }
    using materials::make_table;
    dataset.n = make_table(materials::Unit::nanometre, wavelength_nm, n);
    if (dataset.k) dataset.k = make_table(materials::Unit::nanometre, wavelength_nm, k);
    dataset.corrections.push_back(
        fmt::format("not the source's rows: sampled at {} wavelengths", wavelength_nm.size()));
    return dataset;
}

// The name that both halves begin with: NAME, whether NAME, NAME.spd or one of the halves was
// given.
std::string common_beginning(std::string_view output) {
    for (const std::string_view end : {".spd", ".eta", ".k"}) {
        if (output.ends_with(end)) output.remove_suffix(end.size());
    }
    return std::string(output);
}

// The two halves of a pair must stand beside each other under the names that readers expect.
int write_pair(const std::vector<materials::ExportFile>& files, const Shell& shell) {
    const std::string& output = shell.common().output;
    if (output.empty() || output == "-") {
        throw UsageError("this format has two files: give their common beginning with -o NAME");
    }
    for (const auto& file : files) {
        AtomicFile half(common_beginning(output) + file.suffix);
        half.stream() << file.text;
        half.commit();
    }
    return kGood;
}

int run_export(const DatasetExport& arguments, const Shell& shell) {
    const Database database = arguments.database.open();
    materials::Dataset dataset = database.dataset(arguments.name);
    if (!arguments.wavelengths.empty()) {
        dataset =
            sampled(std::move(dataset), database, parse_wavelengths_nm(arguments.wavelengths));
    }
    const auto files = materials::export_dataset(dataset, arguments.format, arguments.options);
    if (files.front().suffix.ends_with(".spd")) return write_pair(files, shell);
    return shell.write_text(files.front().text);
}

struct DiffArguments {
    DatabaseArgument database;
    std::string first, second;
    IndexArguments index;
    double tolerance = 0.0;
};

std::vector<double> common_grid(const RefractiveIndex& a, const RefractiveIndex& b) {
    std::vector<double> grid;
    for (const RefractiveIndex* index : {&a, &b}) {
        for (const double w : index->table().wavelength_nm) {
            if (a.covers(w) && b.covers(w)) grid.push_back(w);
        }
    }
    std::sort(grid.begin(), grid.end());
    grid.erase(std::unique(grid.begin(), grid.end()), grid.end());
    return grid;
}

int run_diff(const DiffArguments& arguments, const Shell& shell) {
    const Database database = arguments.database.open();
    const RefractiveIndex a = database.refractive_index(arguments.first, arguments.index.options());
    const RefractiveIndex b =
        database.refractive_index(arguments.second, arguments.index.options());
    Table table;
    table.columns = {"wavelength_nm", "n_a", "n_b", "n_difference", "k_a", "k_b", "k_difference"};
    double largest_n = 0, largest_k = 0;
    for (const double w : common_grid(a, b)) {
        const auto first = a.at(w), second = b.at(w);
        const auto difference = second - first;
        largest_n = std::max(largest_n, std::abs(difference.real()));
        const bool both_k = a.k_known() && b.k_known();
        if (both_k) largest_k = std::max(largest_k, std::abs(difference.imag()));
        table.rows.push_back({w, first.real(), second.real(), difference.real(),
                              a.k_known() ? Cell(first.imag()) : Cell(),
                              b.k_known() ? Cell(second.imag()) : Cell(),
                              both_k ? Cell(difference.imag()) : Cell()});
    }
    if (table.rows.empty()) {
        throw InputError(fmt::format(
            "{} ({} to {} nm) and {} ({} to {} nm) have no range in common", arguments.first,
            a.shortest_nm(), a.longest_nm(), arguments.second, b.shortest_nm(), b.longest_nm()));
    }
    table.facts.emplace_back("largest difference of n", largest_n);
    table.facts.emplace_back("largest difference of k", largest_k);
    shell.write(std::move(table));
    return std::max(largest_n, largest_k) <= arguments.tolerance ? kGood : kCheckFailed;
}

const char* severity_text(materials::Finding::Severity severity) {
    switch (severity) {
        case materials::Finding::Severity::error:
            return "error";
        case materials::Finding::Severity::warning:
            return "warning";
        case materials::Finding::Severity::note:
            break;
    }
    return "note";
}

int run_verify(const DatabaseArgument& argument, const std::string& name, const Shell& shell) {
    const auto findings = materials::verify(argument.open(), name);
    Table table;
    table.columns = {"severity", "dataset", "finding"};
    bool sound = true;
    for (const auto& finding : findings) {
        sound = sound && finding.severity != materials::Finding::Severity::error;
        table.rows.push_back(
            {std::string(severity_text(finding.severity)), finding.dataset, finding.text});
    }
    table.facts.emplace_back("verdict", sound ? "sound" : "damaged");
    shell.write(std::move(table));
    return sound ? kGood : kCheckFailed;
}

}  // namespace

void add_materials_check_commands(CLI::App& materials, Shell& shell) {
    auto exported = std::make_shared<DatasetExport>();
    auto* command =
        materials.add_subcommand("export", "write a dataset in a format other programs read");
    option(*command, "name", exported->name, "", "NAME, NAME/DATASET or SOURCE:KEY")->required();
    std::string formats;
    std::vector<std::string> names;
    for (const auto& format : materials::material_formats()) {
        if (!format.written) continue;
        const std::string& name = format.other_name.empty() ? format.name : format.other_name;
        formats += fmt::format("{}{} ({})", formats.empty() ? "" : ", ", name, format.title);
        names.insert(names.end(), {format.name, name});
    }
    option(*command, "--format", exported->format, "", formats)->check(CLI::IsMember(names));
    option(*command, "--wavelengths", exported->wavelengths, "LIST",
           "write n and k at these wavelengths (a list or range, as for nk) in place of the "
           "dataset's own rows; needed for formulas");
    command->add_flag("--unknown-k-zero", exported->options.unknown_k_as_zero,
                      "write 0 for an unknown k if the format needs a number");
    exported->database.add_to(*command);
    finish(*command, shell, exported, run_export,
           "Example:\n  miebrdf materials export GaP --format nk -o gap.nk");

    auto diff = std::make_shared<DiffArguments>();
    command = materials.add_subcommand(
        "diff", "the differences of two datasets, at the wavelengths of both");
    option(*command, "a", diff->first, "", "NAME, NAME/DATASET or SOURCE:KEY")->required();
    option(*command, "b", diff->second, "", "NAME, NAME/DATASET or SOURCE:KEY")->required();
    option(*command, "--tolerance", diff->tolerance, "",
           "largest difference of n and k that still gives exit code 0")
        ->check(CLI::NonNegativeNumber);
    diff->index.add_to(*command);
    diff->database.add_to(*command);
    finish(*command, shell, diff, run_diff,
           "Example:\n  miebrdf materials diff TiO2 TiO2_rutile_e");

    auto verified = std::make_shared<std::pair<DatabaseArgument, std::string>>();
    command = materials.add_subcommand("verify",
                                       "check the stored data: checksums, constraints and physics");
    option(*command, "name", verified->second, "", "one dataset; default: everything");
    verified->first.add_to(*command);
    shell.add_common_options(*command);
    command->footer("Example:\n  miebrdf materials verify");
    shell.on_run(*command, [verified, &shell] {
        return run_verify(verified->first, verified->second, shell);
    });
}

}  // namespace miebrdf::program
