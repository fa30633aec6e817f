// miebrdf materials nk, plot: n and k at wavelengths, as a table and as a picture.
#include <fmt/format.h>

#include <algorithm>
#include <limits>

#include <miebrdf/error.h>
#include "pipeline/plot/spectra.h"
#include "pipeline/scene/number_list.h"
#include "tools/miebrdf/materials_command.h"

namespace miebrdf::program {
namespace {

using materials::Extrapolation;
using materials::Interpolation;

struct NkArguments {
    DatabaseArgument database;
    std::string name;
    std::string wavelengths;
    IndexArguments index;
    double k_floor = 0.0;
    bool permittivity = false, group_index = false;
};

void add_facts(Table& table, const materials::DatasetInfo& dataset, const NkArguments& arguments) {
    auto& facts = table.facts;
    facts.emplace_back("units",
                       "wavelength_nm: nm in vacuum; n, k: dimensionless, exp(-i omega t)");
    facts.emplace_back("dataset", dataset.material + "/" + dataset.label);
    facts.emplace_back("source", dataset.reference.empty()
                                     ? dataset.source
                                     : dataset.source + "; " + dataset.reference);
    facts.emplace_back("interpolation", arguments.index.interpolation());
    for (const std::string& correction : dataset.corrections)
        facts.emplace_back("correction", correction);
    if (!dataset.k_known) facts.emplace_back("k", "unknown (not measured); taken as 0");
    if (arguments.k_floor > 0) facts.emplace_back("k floor", arguments.k_floor);
}

// n - w dn/dw, from n a ten-thousandth of the wavelength to either side, inside the data. What is
// between the rows is an interpolation, so its slope is as good as the rows are dense.
double group_index(const materials::RefractiveIndex& index, double wavelength_nm) {
    constexpr double kStep = 1e-4;
    const double below = std::max(wavelength_nm * (1 - kStep), index.shortest_nm());
    const double above = std::min(wavelength_nm * (1 + kStep), index.longest_nm());
    const double n = index.at(wavelength_nm).real();
    if (!(below < above)) return n;
    const double slope = (index.at(above).real() - index.at(below).real()) / (above - below);
    return n - wavelength_nm * slope;
}

int run_nk(const NkArguments& arguments, const Shell& shell) {
    const std::vector<double> wavelengths_nm = parse_wavelengths_nm(arguments.wavelengths);
    const materials::Database database = arguments.database.open();
    const materials::DatasetInfo dataset = database.dataset_info(arguments.name);
    const std::string full_name = dataset.material + "/" + dataset.label;
    Table table;
    add_facts(table, dataset, arguments);
    table.columns = {"wavelength_nm", "n", "k"};
    if (arguments.permittivity)
        table.columns.insert(table.columns.end(), {"permittivity_real", "permittivity_imaginary"});
    if (arguments.group_index) table.columns.emplace_back("group_index");
    const auto index = database.refractive_index(full_name, arguments.index.options());
    std::size_t without_k = 0;
    for (const double wavelength_nm : wavelengths_nm) {
        const auto m = index.at(wavelength_nm);
        if (!index.covers(wavelength_nm)) {
            table.facts.emplace_back(
                "extrapolated",
                fmt::format("{} nm is outside {} to {} nm: value of "
                            "the nearer end",
                            wavelength_nm, index.shortest_nm(), index.longest_nm()));
        }
        const std::complex<double> used(m.real(), std::max(m.imag(), arguments.k_floor));
        std::vector<Cell> row{wavelength_nm, used.real(), used.imag()};
        if (arguments.permittivity) {
            const std::complex<double> permittivity = used * used;
            row.insert(row.end(), {permittivity.real(), permittivity.imag()});
        }
        if (arguments.group_index) row.emplace_back(group_index(index, wavelength_nm));
        table.rows.push_back(std::move(row));
        without_k += index.k_known_at(wavelength_nm) ? 0 : 1;
    }
    if (dataset.k_known && without_k > 0)
        table.facts.emplace_back("k", fmt::format("unknown at {} of {} wavelengths, taken as 0 "
                                                  "there",
                                                  without_k, wavelengths_nm.size()));
    return shell.write(std::move(table));
}

struct IndexPlotArguments {
    DatabaseArgument database;
    std::vector<std::string> names;
    std::string range;
    double scale = 2.0;
    IndexArguments index;
};

/// Wavelengths that make a smooth curve, the ends of the data among them.
std::vector<double> wavelengths_of(const materials::RefractiveIndex& index, double from,
                                   double to) {
    constexpr int kPoints = 400;
    std::vector<double> wavelengths;
    const double first = std::max(from, index.shortest_nm()),
                 last = std::min(to, index.longest_nm());
    if (!(first <= last)) return wavelengths;
    for (int i = 0; i <= kPoints; ++i) {
        wavelengths.push_back(i == kPoints ? last : first + (last - first) * i / kPoints);
    }
    return wavelengths;
}

plot::IndexCurve curve_of(const materials::Database& database, const std::string& name, double from,
                          double to, const materials::IndexOptions& options) {
    const auto dataset = database.dataset_info(name);
    plot::IndexCurve curve;
    curve.label = dataset.material + "/" + dataset.label;
    const auto index = database.refractive_index(curve.label, options);
    for (const double wavelength_nm : wavelengths_of(index, from, to)) {
        const auto m = index.at(wavelength_nm);
        curve.wavelength_nm.push_back(wavelength_nm);
        curve.n.push_back(m.real());
        curve.k.push_back(m.imag());
    }
    if (curve.n.empty()) {
        throw InputError(fmt::format("{} covers {} to {} nm: nothing to draw", curve.label,
                                     index.shortest_nm(), index.longest_nm()));
    }
    return curve;
}

int run_plot(const IndexPlotArguments& arguments, const Shell& shell) {
    const std::string& output = shell.common().output;
    if (output.empty() || output == "-")
        throw UsageError("a plot needs -o FILE.svg or -o FILE.png");
    double from = 0.0, to = std::numeric_limits<double>::infinity();
    if (!arguments.range.empty()) {
        const std::vector<std::string> ends = split_list(arguments.range, ':');
        if (ends.size() != 2)
            throw UsageError(fmt::format("--range '{}': expected A:B", arguments.range));
        from = parse_wavelength_nm(ends[0]);
        to = parse_wavelength_nm(ends[1]);
        if (from > to) std::swap(from, to);
    }
    const materials::Database database = arguments.database.open();
    std::vector<plot::IndexCurve> curves;
    for (const std::string& name : arguments.names) {
        curves.push_back(curve_of(database, name, from, to, arguments.index.options()));
    }
    const plot::Caption caption{"", shell.command_line()};
    plot::save_picture(plot::draw_nk(std::move(curves), caption), output, arguments.scale);
    shell.tell_written({.columns = {"file"}, .rows = {{output}}});
    return kGood;
}

void add_nk(CLI::App& materials, Shell& shell) {
    auto arguments = std::make_shared<NkArguments>();
    auto* command = materials.add_subcommand("nk", "n and k of a material at wavelengths");
    option(*command, "name", arguments->name, "", "NAME, NAME/DATASET or SOURCE:KEY")->required();
    option(*command, "--wavelengths", arguments->wavelengths, "LIST",
           "list or range; nm, or with a unit: nm, um, A, eV, cm-1, THz; rgb is 620,535,480")
        ->required();
    arguments->index.add_to(*command);
    command->add_flag("--permittivity", arguments->permittivity,
                      "also print (n + ik)^2 as permittivity_real, permittivity_imaginary");
    command->add_flag("--group-index", arguments->group_index,
                      "also print the group index n - w dn/dw, where w is the wavelength");
    option(*command, "--k-floor", arguments->k_floor, "",
           "smallest k; smaller values are raised to it")
        ->check(CLI::NonNegativeNumber);
    arguments->database.add_to(*command);
    finish(*command, shell, arguments, run_nk,
           "Example:\n  miebrdf materials nk GaP --wavelengths 400:700:10,2.25eV");
}

void add_nk_plot(CLI::App& materials, Shell& shell) {
    auto arguments = std::make_shared<IndexPlotArguments>();
    auto* command = materials.add_subcommand("plot", "n and k over wavelength, as SVG or PNG");
    option(*command, "names", arguments->names, "",
           "NAME, NAME/DATASET or SOURCE:KEY; several are drawn over each other")
        ->required();
    option(*command, "--range", arguments->range, "A:B", "only wavelengths A:B (nm or units)");
    option(*command, "--scale", arguments->scale, "", "PNG pixels for each SVG unit")
        ->check(CLI::Range(0.1, 20.0));
    arguments->index.add_to(*command);
    arguments->database.add_to(*command);
    finish(*command, shell, arguments, run_plot,
           "Example:\n  miebrdf materials plot GaP TiO2 -o nk.svg", Writes::file);
}

}  // namespace

void IndexArguments::add_to(CLI::App& command) {
    option(command, "--interpolation", interpolation_, "",
           "between rows: pchip (monotone, in photon energy), linear (in wavelength, as in other "
           "tools) or linear-energy")
        ->check(CLI::IsMember({"pchip", "linear", "linear-energy"}));
    option(command, "--extrapolate", extrapolate_, "",
           "beyond the ends of the data: refuse, or clamp (take the value of the nearer end; the "
           "output says so)")
        ->check(CLI::IsMember({"refuse", "clamp"}));
    command.add_flag("--missing-k-zero", missing_k_zero_,
                     "take k = 0 where only n is known, instead of an error");
}

materials::IndexOptions IndexArguments::options() const {
    materials::IndexOptions options;
    if (interpolation_ == "linear") options.interpolation = Interpolation::linear_in_wavelength;
    if (interpolation_ == "linear-energy") options.interpolation = Interpolation::linear_in_energy;
    if (extrapolate_ == "clamp") options.extrapolation = Extrapolation::clamp;
    options.missing_k_is_zero = missing_k_zero_;
    return options;
}

void add_materials_nk_commands(CLI::App& materials, Shell& shell) {
    add_nk(materials, shell);
    add_nk_plot(materials, shell);
}

}  // namespace miebrdf::program
