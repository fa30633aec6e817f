// miebrdf materials: the database of optical constants; list, search, show: what there is and where
// it comes from.
#include <fmt/format.h>

#include <algorithm>
#include <string>
#include <vector>

#include <miebrdf/error.h>
#include <miebrdf/version.h>
#include "pipeline/scene/number_list.h"
#include "tools/miebrdf/materials_command.h"

namespace miebrdf::program {
namespace {

constexpr int kWidth = 48;
constexpr const char* kBlocks[] = {"▁", "▂", "▃", "▄", "▅", "▆", "▇", "█"};

double linear(const std::vector<double>& x, const std::vector<double>& y, double at) {
    const auto above = std::lower_bound(x.begin(), x.end(), at);
    if (above == x.begin()) return y.front();
    if (above == x.end()) return y.back();
    const auto i = static_cast<std::size_t>(above - x.begin());
    const double t = (at - x[i - 1]) / (x[i] - x[i - 1]);
    return y[i - 1] + t * (y[i] - y[i - 1]);
}

/// Lowest and highest value around up to 48 block characters, evenly spaced in x; x ascends.
std::string sparkline(const std::vector<double>& x, const std::vector<double>& y) {
    if (x.empty()) return "";
    const auto [lowest, highest] = std::minmax_element(y.begin(), y.end());
    std::string line;
    for (int i = 0; i < kWidth; ++i) {
        const double value = linear(x, y, x.front() + (x.back() - x.front()) * i / (kWidth - 1));
        const double height = *highest > *lowest ? (value - *lowest) / (*highest - *lowest) : 0.0;
        line += kBlocks[std::clamp(static_cast<int>(height * 8), 0, 7)];
    }
    return fmt::format("{:.5g} to {:.5g} {}", *lowest, *highest, line);
}

using materials::Database;
using materials::DatasetInfo;
using materials::MaterialInfo;

struct SearchArguments {
    DatabaseArgument database;
    std::string text;
    std::string covers;
    bool has_k = false;
    std::size_t limit = 0;  ///< 0: none
};

Cell range_end(const MaterialInfo& m, double value) {
    return m.datasets > 0 ? Cell(value) : Cell();
}

/// Leaves the first rows, and says how many there were.
void limit_rows(Table& table, std::size_t limit, const Shell& shell) {
    if (limit == 0 || table.rows.size() <= limit) return;
    const std::string left =
        fmt::format("first {} of {}; --limit 0 shows all", limit, table.rows.size());
    table.rows.resize(limit);
    table.facts.emplace_back("shown", left);
    shell.note(left);
}

Table table_of(const std::vector<MaterialInfo>& found) {
    Table table;
    table.facts.emplace_back("units", "shortest_nm, longest_nm: nm in vacuum");
    table.columns = {"name",       "title", "formula", "source",  "shortest_nm",
                     "longest_nm", "rows",  "k_known", "datasets"};
    for (const MaterialInfo& m : found) {
        table.rows.push_back({m.name, m.title, m.formula, m.source, range_end(m, m.shortest_nm),
                              range_end(m, m.longest_nm), static_cast<double>(m.rows),
                              std::string(m.datasets > 0 && m.k_known ? "yes" : "no"),
                              static_cast<double>(m.datasets)});
    }
    return table;
}

materials::SearchFilter filter_of(const SearchArguments& arguments) {
    materials::SearchFilter filter;
    filter.text = arguments.text;
    filter.needs_k = arguments.has_k;
    if (arguments.covers.empty()) return filter;
    const std::vector<std::string> ends = split_list(arguments.covers, ':');
    if (ends.size() > 2) {
        throw UsageError(
            fmt::format("--covers '{}': expected A:B, two wavelengths", arguments.covers));
    }
    filter.covers_from_nm = parse_wavelength_nm(ends.front());
    filter.covers_to_nm = parse_wavelength_nm(ends.back());
    return filter;
}

std::string nearest_of(const Database& database, const std::string& text) {
    try {
        return database.info(text).name;
    } catch (const materials::UnknownMaterial& error) {
        return fmt::format("{}", fmt::join(error.candidates, ", "));
    } catch (const InputError&) {
        return "";
    }
}

int run_search(const SearchArguments& arguments, const Shell& shell) {
    const Database database = arguments.database.open();
    std::vector<MaterialInfo> found = database.search(filter_of(arguments));
    const std::optional<materials::CommonWord> word = materials::common_word(arguments.text);
    if (word) {
        std::vector<MaterialInfo> first;
        for (const std::string& name : word->materials) first.push_back(database.info(name));
        std::erase_if(found, [&](const MaterialInfo& one) {
            return std::find(word->materials.begin(), word->materials.end(), one.name) !=
                   word->materials.end();
        });
        found.insert(found.begin(), first.begin(), first.end());
    }
    Table table = table_of(found);
    if (word) table.facts.emplace_back(word->word, word->meaning);
    limit_rows(table, arguments.limit, shell);
    shell.write(std::move(table));
    if (word) shell.note(word->word + ": " + word->meaning);
    if (word || !found.empty()) return kGood;
    const std::string nearest = nearest_of(database, arguments.text);
    shell.note(fmt::format("nothing fits '{}'{}", arguments.text,
                           nearest.empty() ? "" : "; did you mean " + nearest + "?"));
    return kCheckFailed;
}

int run_list(const SearchArguments& arguments, const Shell& shell) {
    Table table = table_of(arguments.database.open().list());
    limit_rows(table, arguments.limit, shell);
    return shell.write(std::move(table));
}

int run_datasets(const SearchArguments& arguments, const Shell& shell) {
    const Database database = arguments.database.open();
    const MaterialInfo material = database.info(arguments.text);
    const materials::SearchFilter filter = filter_of(arguments);
    Table table;
    table.facts.emplace_back("units", "shortest_nm, longest_nm: nm in vacuum; temperature_k: K");
    table.columns = {"dataset", "default",       "source", "shortest_nm", "longest_nm", "rows",
                     "k_known", "temperature_k", "ray",    "composition", "reference"};
    const std::vector<DatasetInfo> all = database.datasets(material.name);
    for (const DatasetInfo& d : all) {
        if (!materials::fits(d, filter)) continue;
        table.rows.push_back(
            {d.material + "/" + d.label, std::string(&d == &all.front() ? "yes" : "no"),
             d.source + (d.key.empty() ? "" : ":" + d.key), d.shortest_nm, d.longest_nm,
             d.n_formula > 0 ? Cell(fmt::format("formula {}", d.n_formula))
                             : Cell(static_cast<double>(d.rows)),
             std::string(d.k_known ? "yes" : "no"),
             d.temperature_k ? Cell(*d.temperature_k) : Cell(), d.ray, d.composition, d.reference});
    }
    const bool none = table.rows.empty();
    limit_rows(table, arguments.limit, shell);
    shell.write(std::move(table));
    if (none)
        shell.note(fmt::format("no dataset of {} covers {}", material.name, arguments.covers));
    return none ? kCheckFailed : kGood;
}

std::string range_text(double shortest_nm, double longest_nm) {
    return fmt::format("{} to {}", shortest_nm, longest_nm);
}

using Rows = std::vector<std::vector<Cell>>;

void add_row(Rows& rows, const std::string& property, const std::string& value) {
    if (!value.empty()) rows.push_back({property, value});
}

void add_ranges(Rows& rows, const DatasetInfo& d) {
    if (d.n_known) {
        add_row(rows, "n range (nm)", range_text(d.n_shortest_nm, d.n_longest_nm));
        add_row(rows, "n given as",
                d.n_formula > 0 ? fmt::format("dispersion formula {}", d.n_formula)
                                : fmt::format("{} rows in {}", d.rows, name_of(d.unit)));
    } else {
        add_row(rows, "n range (nm)", "unknown");
    }
    add_row(rows, "k range (nm)",
            d.k_known ? range_text(d.k_shortest_nm, d.k_longest_nm) : "unknown");
}

std::string density_text(const DatasetInfo& d) {
    if (!d.density_g_cm3) return "";
    const std::string source = d.density_source.empty() ? "" : " (" + d.density_source + ")";
    return fmt::format("{}{}", *d.density_g_cm3, source);
}

void add_dataset(Rows& rows, const DatasetInfo& d) {
    add_row(rows, "dataset", d.material + "/" + d.label);
    add_row(rows, "source", d.source + (d.key.empty() ? "" : ":" + d.key));
    add_row(rows, "reference", d.reference);
    add_row(rows, "DOI", d.doi);
    add_row(rows, "licence", d.licence);
    add_row(rows, "ray", d.ray);
    add_row(rows, "temperature (K)", d.temperature_k ? fmt::format("{}", *d.temperature_k) : "");
    add_row(rows, "density (g/cm3)", density_text(d));
    add_row(rows, "composition", d.composition);
    add_row(rows, "note", d.note);
    for (const std::string& correction : d.corrections) add_row(rows, "correction", correction);
    add_ranges(rows, d);
    add_row(rows, "read from", d.file.empty() ? "" : fmt::format("{} ({})", d.file, d.format));
    add_row(rows, "imported", d.imported);
    add_row(rows, "SHA-256 of file", d.file_sha256);
    add_row(rows, "SHA-256 of figures", d.content_sha256);
    add_row(rows, "stored in", d.layer);
}

void add_curves(Rows& rows, const Database& database, const DatasetInfo& d) {
    if (!d.n_known || !(d.shortest_nm <= d.longest_nm)) return;
    const auto table = database.refractive_index(d.material + "/" + d.label).table();
    add_row(rows, "n", sparkline(table.wavelength_nm, table.n));
    if (d.k_known) add_row(rows, "k", sparkline(table.wavelength_nm, table.k));
}

int run_show(const DatabaseArgument& argument, const std::string& name, const Shell& shell) {
    const Database database = argument.open();
    const MaterialInfo info = database.info(name);
    std::vector<DatasetInfo> datasets = database.datasets(info.name);
    const bool one = database.resolve(name).empty();
    if (one) datasets = {database.dataset_info(name)};

    Table table;
    table.columns = {"property", "value"};
    add_row(table.rows, "name", info.name);
    add_row(table.rows, "title", info.title);
    add_row(table.rows, "formula", info.formula);
    add_row(table.rows, "aliases", fmt::format("{}", fmt::join(info.aliases, ", ")));
    if (!one) add_row(table.rows, "default dataset", info.default_dataset);
    for (const DatasetInfo& dataset : datasets) {
        add_dataset(table.rows, dataset);
        add_curves(table.rows, database, dataset);
    }
    return shell.write(std::move(table));
}

}  // namespace

static void add_filter(CLI::App& command, SearchArguments& arguments) {
    option(command, "--covers", arguments.covers, "A:B",
           "only materials with a dataset that covers the wavelengths A to B (nm, or with a unit)");
    command.add_flag("--has-k", arguments.has_k, "only materials with a dataset whose k is known");
}

static void add_limit(CLI::App& command, SearchArguments& arguments) {
    option(command, "--limit", arguments.limit, "N", "number of lines to show at most; 0: all");
}

void add_materials_query_commands(CLI::App& materials, Shell& shell) {
    auto listed = std::make_shared<SearchArguments>();
    auto* list = materials.add_subcommand("list", "every material with its source and range");
    listed->database.add_to(*list);
    shell.add_common_options(*list);
    list->footer("Example:\n  miebrdf materials list");
    add_limit(*list, *listed);
    shell.on_run(*list, [listed, &shell] { return run_list(*listed, shell); });

    auto shown = std::make_shared<SearchArguments>();
    auto* datasets =
        materials.add_subcommand("datasets", "the datasets of a material, one line each");
    option(*datasets, "name", shown->text, "", "NAME")->required();
    add_filter(*datasets, *shown);
    add_limit(*datasets, *shown);
    shown->database.add_to(*datasets);
    finish(*datasets, shell, shown, run_datasets,
           "Example:\n  miebrdf materials datasets Au --covers 400:700");

    auto asked = std::make_shared<SearchArguments>();
    auto* search = materials.add_subcommand(
        "search", "find materials by words of their name, title or source");
    option(*search, "text", asked->text, "", "words or their beginnings, all of which must occur");
    add_filter(*search, *asked);
    asked->limit = 50;
    add_limit(*search, *asked);
    asked->database.add_to(*search);
    finish(*search, shell, asked, run_search,
           "Example:\n  miebrdf materials search \"titanium oxide\" --covers 400:700 --has-k");

    auto name = std::make_shared<std::pair<DatabaseArgument, std::string>>();
    auto* show = materials.add_subcommand("show", "a material's datasets, ranges and provenance");
    option(*show, "name", name->second, "", "NAME, NAME/DATASET or SOURCE:KEY")->required();
    name->first.add_to(*show);
    shell.add_common_options(*show);
    show->footer("Example:\n  miebrdf materials show GaP");
    shell.on_run(*show, [name, &shell] { return run_show(name->first, name->second, shell); });
}

void DatabaseArgument::add_to(CLI::App& command) {
    option(command, "--database", file_, "FILE",
           "file with your own materials; default: $MIEBRDF_DATABASE, else "
           "$XDG_DATA_HOME/miebrdf/materials.sqlite");
}

std::filesystem::path DatabaseArgument::file() const {
    return file_.empty() ? materials::default_user_database() : std::filesystem::path(file_);
}

materials::Database open_database(const std::string& file) {
    if (file.empty()) return materials::Database::layered(materials::default_user_database());
    if (!std::filesystem::exists(file))
        throw InputError(fmt::format("materials database '{}' does not exist", file));
    return materials::Database::layered(file);
}

void add_materials(CLI::App& command, Shell& shell) {
    command.require_subcommand(1);
    command.set_version_flag("--version", version_text);
    add_materials_query_commands(command, shell);
    add_materials_nk_commands(command, shell);
    add_materials_edit_commands(command, shell);
    add_materials_check_commands(command, shell);
    command.footer(
        "Example:\n  miebrdf materials search oxide --covers 400:700\n"
        "  miebrdf materials nk GaP --wavelengths 400:700:10");
}

}  // namespace miebrdf::program
