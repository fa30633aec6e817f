// miebrdf table1: the paper's averaged diffuse reflectance factors.
#include <fmt/format.h>

#include <cmath>

#include <miebrdf/error.h>
#include <miebrdf/table1.h>
#include "pipeline/scene/number_list.h"
#include "tools/miebrdf/command.h"

namespace miebrdf::program {
namespace {

struct Table1Arguments {
    std::vector<std::string> materials;
    std::string convention;
    std::string wavelengths;
    double roughness = 0.0;
    std::string database;
};

Table1Request parse(const Table1Arguments& arguments) {
    Table1Request request;
    request.materials = arguments.materials;
    request.database = arguments.database;
    if (!arguments.wavelengths.empty()) {
        request.wavelength_nm = parse_wavelengths_nm(arguments.wavelengths);
    }
    if (arguments.roughness != 0.0) {
        if (!(arguments.roughness > 0.0 && arguments.roughness <= 2.0)) {
            throw UsageError(
                fmt::format("roughness: {} is out of range; allowed: (0, 2]", arguments.roughness));
        }
        request.beckmann_alpha = arguments.roughness;
    }
    request.conventions = arguments.convention == "all"
                              ? table1_conventions()
                              : std::vector{table1_convention(arguments.convention)};
    return request;
}

Table table_of(const Table1Result& result, const Table1Request& request) {
    Table table;
    table.facts.emplace_back("units",
                             "wavelength_nm: nm in vacuum; factors: mean of 1 - rho_dt over "
                             "the hemisphere, uniform in solid angle");
    for (const auto& c : request.conventions) {
        table.facts.emplace_back("convention", fmt::format("{}: {}", c.name, c.description));
    }
    for (const std::string& source : result.sources) table.facts.emplace_back("source", source);
    const bool several = request.conventions.size() > 1;
    if (several) table.columns.emplace_back("convention");
    for (const char* name : {"material", "channel", "wavelength_nm", "diffuse_reflectance_factor",
                             "paper", "difference"}) {
        table.columns.emplace_back(name);
    }
    double largest = 0.0;
    for (const Table1Entry& e : result.entries) {
        std::vector<Cell> row;
        if (several) row.emplace_back(e.convention);
        row.insert(row.end(), {e.material, e.channel, e.wavelength_nm, e.factor});
        if (e.paper) {
            row.insert(row.end(), {*e.paper, e.factor - *e.paper});
            largest = std::max(largest, std::abs(e.factor - *e.paper));
        } else {
            row.insert(row.end(), {Cell(), Cell()});
        }
        table.rows.push_back(std::move(row));
    }
    if (largest > 0.0) table.facts.emplace_back("largest difference", rounded(largest, 3));
    return table;
}

}  // namespace

void add_table1(CLI::App& command, Shell& shell) {
    auto arguments = std::make_shared<Table1Arguments>();
    arguments->convention = table1_conventions().front().name;
    std::string names;
    for (const auto& c : table1_conventions()) names += c.name + ", ";
    option(command, "material", arguments->materials, "MATERIAL",
           "materials; default: the paper's four");
    option(command, "--convention", arguments->convention, "",
           "convention for what the paper does not state: " + names + "or all");
    option(command, "--wavelengths", arguments->wavelengths, "LIST",
           "wavelengths in place of the convention's R, G and B");
    option(command, "--roughness", arguments->roughness, "",
           "slope parameter of Beckmann's distribution; 0: that of the convention");
    option(command, "--database", arguments->database, "FILE", "materials database");
    shell.add_common_options(command);
    command.footer("Example:\n  miebrdf table1\n  miebrdf table1 Au Ag --wavelengths 400:700:100");
    shell.on_run(command, [arguments, &shell] {
        const Table1Request request = parse(*arguments);
        return shell.write(table_of(compute_table1(request, shell.control()), request));
    });
}

}  // namespace miebrdf::program
