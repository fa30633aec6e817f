// Data files of refractiveindex.info: REFERENCES, COMMENTS, CONDITIONS and a list of DATA blocks.
#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <cmath>
#include <iterator>
#include <optional>

#include "materials/index/series.h"
#include "materials/index/units.h"
#include "materials/readers/catalogue.h"
#include "materials/readers/file_format.h"
#include "materials/readers/text.h"
#include "materials/readers/text_table.h"
#include "materials/readers/yaml_node.h"

namespace miebrdf::materials {
namespace {

// Key names have changed over the years: the first that is there counts.
const YamlNode* find_any(const YamlNode& node, std::initializer_list<std::string_view> keys) {
    for (const std::string_view key : keys) {
        if (const YamlNode* found = node.find(key)) return found;
    }
    return nullptr;
}

void read_block_table(Dataset& dataset, const YamlNode& block, bool has_n, bool has_k,
                      const std::string& file, const ReadOptions& options) {
    const YamlNode* data = block.find("data");
    if (data == nullptr) throw ImportError(file, block.line, "tabulated block without data");
    RawTable table;
    table.unit = Unit::micrometre;
    table.has_n = has_n;
    table.has_k = has_k;
    const std::size_t columns = has_n && has_k ? 3 : 2;
    BadRows bad;
    int line = data->line;  // a literal block begins on the line after its '|'
    for (const std::string_view raw : split_lines(data->text)) {
        ++line;
        const auto words = split_numbers(raw);
        if (words.empty()) continue;
        bad.try_row(options, [&] {
            if (words.size() != columns) {
                throw ImportError(file, line,
                                  fmt::format("{} columns, expected {}", words.size(), columns));
            }
            RawRow row{require_number(words[0], file, line), 0.0, 0.0, line};
            if (has_n) row.n = require_number(words[1], file, line);
            if (has_k) row.k = require_number(words.back(), file, line);
            table.rows.push_back(row);
        });
    }
    bad.record(dataset, table.rows.size());
    add_table(dataset, std::move(table), file, options);
}

std::vector<double> numbers_of(const YamlNode& node, const std::string& file) {
    std::vector<double> numbers;
    if (node.kind == YamlNode::Kind::sequence) {
        for (const YamlNode& item : node.items) {
            numbers.push_back(require_number(item.text, file, item.line));
        }
        return numbers;
    }
    for (const std::string_view word : split_words(node.text, " \t\r\n,;")) {
        numbers.push_back(require_number(word, file, node.line));
    }
    return numbers;
}

// A formula need not have a real value everywhere in the range it is given for: four files of the
// 2026 collection do not. Such a dataset is kept, the wavelengths concerned are refused when asked
// for, and the remark says so.
void check_formula(Dataset& dataset, const Series& series) {
    const std::string gap = formula_gap(series);
    if (!gap.empty()) dataset.corrections.push_back(gap);
}

void read_formula(Dataset& dataset, const YamlNode& block, int formula, const std::string& file) {
    const YamlNode* range = find_any(block, {"wavelength_range", "range"});
    const YamlNode* coefficients = block.find("coefficients");
    if (range == nullptr || coefficients == nullptr) {
        throw ImportError(file, block.line, "formula without range or coefficients");
    }
    const std::vector<double> ends_um = numbers_of(*range, file);
    Series series;
    series.formula = formula;
    series.unit = Unit::micrometre;
    series.y = numbers_of(*coefficients, file);
    if (ends_um.size() != 2 || series.y.empty() || series.y.size() > 100) {
        throw ImportError(file, block.line, "a formula needs two wavelengths and its coefficients");
    }
    series.shortest_nm = to_nm(std::min(ends_um[0], ends_um[1]), Unit::micrometre);
    series.longest_nm = to_nm(std::max(ends_um[0], ends_um[1]), Unit::micrometre);
    try {
        check_series(series, 'n');
    } catch (const InputError& error) {
        throw ImportError(file, block.line, error.what());
    }
    check_formula(dataset, series);
    dataset.n = std::move(series);
}

/// Which of two values counts is nobody's guess.
void refuse_repeated(const YamlNode& node, const std::vector<std::string>& keys,
                     const std::string& file) {
    for (const std::string& key : keys) {
        if (std::count(node.keys.begin(), node.keys.end(), key) > 1)
            throw ImportError(file, node.line, fmt::format("the key '{}' stands twice", key));
    }
}

struct BlockType {
    bool n = false, k = false;
    int formula = 0;
};

BlockType block_type(const YamlNode& block, const std::string& file) {
    const std::string type = block.text_of("type");
    if (type == "tabulated nk") return {true, true, 0};
    if (type == "tabulated n") return {true, false, 0};
    if (type == "tabulated k") return {false, true, 0};
    if (type.size() == 9 && type.starts_with("formula ") && type[8] >= '1' && type[8] <= '9') {
        return {true, false, type[8] - '0'};
    }
    throw ImportError(file, block.line, fmt::format("unknown kind of data '{}'", type));
}

// Tables first: where a page gives n both ways, the measured table is preferred to its fit.
void read_blocks(Dataset& dataset, const YamlNode& data, const std::string& file,
                 const ReadOptions& options) {
    for (const bool formulas : {false, true}) {
        for (const YamlNode& block : data.items) {
            refuse_repeated(block, block.keys, file);
            const BlockType type = block_type(block, file);
            if ((type.formula > 0) != formulas) continue;
            if ((type.n && dataset.n) || (type.k && dataset.k)) {
                dataset.corrections.push_back(fmt::format(
                    "block '{}' ignored: already given by another", block.text_of("type")));
                continue;
            }
            if (formulas) {
                read_formula(dataset, block, type.formula, file);
            } else {
                read_block_table(dataset, block, type.n, type.k, file, options);
            }
        }
    }
}

void read_conditions(Dataset& dataset, const YamlNode& page) {
    const YamlNode* conditions = find_any(page, {"CONDITIONS", "SPECS"});
    if (conditions == nullptr) return;
    for (std::size_t i = 0; i < conditions->keys.size(); ++i) {
        const std::string& name = conditions->keys[i];
        const YamlNode& value = conditions->items[i];
        if (name == "direction" && (value.text == "o" || value.text == "e")) {
            dataset.ray = value.text;
        } else if (const auto kelvin = parse_number(value.text);
                   name == "temperature" && kelvin && *kelvin > 0 && *kelvin < 1e5) {
            dataset.temperature_k = kelvin;
        } else if (value.kind == YamlNode::Kind::scalar && value.text.size() < 200) {
            dataset.note += fmt::format("{}{}: {}", dataset.note.empty() ? "" : "; ", name,
                                        without_markup(value.text));
        }
    }
}

// The first of PROPERTIES: density: [{value: 2510, temperature: 293}, ...], in kg/m3.
void read_density(Dataset& dataset, const YamlNode& page) {
    const YamlNode* properties = page.find("PROPERTIES");
    const YamlNode* density = properties != nullptr ? properties->find("density") : nullptr;
    if (density == nullptr || density->items.empty()) return;
    const auto value = parse_number(density->items.front().text_of("value"));
    if (!value || !(*value > 0 && *value < 1e5)) return;
    dataset.density_g_cm3 = *value / 1000;
    dataset.density_source = dataset.source;
}

void read_provenance(Dataset& dataset, const YamlNode& page) {
    dataset.source = "refractiveindex.info";
    dataset.licence = "CC0-1.0";
    const std::string references = page.text_of("REFERENCES");
    dataset.reference = without_markup(references);
    dataset.doi = first_doi(references);
    dataset.note = without_markup(page.text_of("COMMENTS"));
    read_conditions(dataset, page);
    read_density(dataset, page);
}

bool looks_like_rii_page(std::string_view text) {
    return text.starts_with("DATA:") || text.find("\nDATA:") != std::string_view::npos;
}

Dataset read_rii_page(const SourceFile& source, const ReadOptions& options) {
    const std::string file = source.path.string();
    const YamlNode page = parse_yaml(source.text, file);
    refuse_repeated(page, {"DATA", "CONDITIONS", "PROPERTIES"}, file);
    const YamlNode* data = page.find("DATA");
    if (data == nullptr || data->kind != YamlNode::Kind::sequence || data->items.empty()) {
        throw ImportError(file, 0, "no list of DATA blocks");
    }
    Dataset dataset;
    dataset.format = "rii-yaml";
    // Our own exports say in comments what the format has no keys for.
    bool ours = false;
    for (const std::string_view line : split_lines(source.text)) {
        if (!line.starts_with(kProvenanceMark)) continue;
        ours = true;
        read_provenance_line(dataset, line.substr(kProvenanceMark.size()));
    }
    if (!ours) read_provenance(dataset, page);
    read_blocks(dataset, *data, file, options);
    return dataset;
}

void read_page_path(Dataset& dataset, const std::filesystem::path& path) {
    const auto page = page_of_path(path);
    if (!page) return;
    if (dataset.material.empty()) dataset.material = page->material;
    if (dataset.label.empty()) dataset.label = page->label;
    if (dataset.key.empty()) dataset.key = page->key;
}

std::string literal_block(const std::string& key, const std::string& text) {
    if (text.empty()) return "";
    std::string line = text;
    std::replace(line.begin(), line.end(), '\n', ' ');
    return fmt::format("{}: |\n    {}\n", key, line);
}

std::string yaml_block(const Series& series, const char* type, const Series* second) {
    if (!series.tabulated()) {
        return fmt::format(
            "  - type: formula {}\n    wavelength_range: {} {}\n    coefficients: {}\n",
            series.formula, from_nm_exactly(series.shortest_nm, Unit::micrometre),
            from_nm_exactly(series.longest_nm, Unit::micrometre), fmt::join(series.y, " "));
    }
    std::string text = fmt::format("  - type: {}\n    data: |\n", type);
    for (std::size_t i = 0; i < series.x.size(); ++i) {
        fmt::format_to(std::back_inserter(text), "        {} {}",
                       in_unit(series, i, Unit::micrometre), series.y[i]);
        if (second != nullptr) fmt::format_to(std::back_inserter(text), " {}", second->y[i]);
        text += '\n';
    }
    return text;
}

std::vector<ExportFile> write_rii_page(const Dataset& d, const ExportOptions&) {
    std::string text = remarks(d, kProvenanceMark);
    text += literal_block("REFERENCES", d.reference);
    text += literal_block("COMMENTS", d.note);
    if (d.temperature_k || !d.ray.empty()) text += "CONDITIONS:\n";
    if (!d.ray.empty()) text += fmt::format("    direction: {}\n", d.ray);
    if (d.temperature_k) text += fmt::format("    temperature: {}\n", *d.temperature_k);
    text += "DATA:\n";
    if (d.n && d.k && d.n->tabulated() && d.n->unit == d.k->unit && d.n->x == d.k->x) {
        return {{".yml", text + yaml_block(*d.n, "tabulated nk", &*d.k)}};
    }
    if (d.n) text += yaml_block(*d.n, "tabulated n", nullptr);
    if (d.k) text += yaml_block(*d.k, "tabulated k", nullptr);
    return {{".yml", std::move(text)}};
}

}  // namespace

extern const FileFormat kRefractiveIndexInfo;
constinit const FileFormat kRefractiveIndexInfo{
    .name = "rii",
    .other_name = "yaml",
    .title = "refractiveindex.info YAML",
    .endings = {".yml"},
    .looks_like = looks_like_rii_page,
    .read = read_rii_page,
    .write = write_rii_page,
    .read_path = read_page_path,
};

}  // namespace miebrdf::materials
