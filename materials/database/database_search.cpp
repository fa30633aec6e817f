// Listing and searching: full text, formula, coverage; and what SQLite finds wrong.
#include <fmt/format.h>

#include <algorithm>
#include <cctype>
#include <map>
#include <set>

#include "materials/database/layer.h"
#include "materials/database/names.h"
#include "materials/index/words.h"

namespace miebrdf::materials {
namespace {

std::vector<std::string> words_of(const std::string& text) {
    std::vector<std::string> words;
    bool is_inside = false;
    for (const char c : text) {
        const auto byte = static_cast<unsigned char>(c);
        const bool letter = byte >= 0x80 || std::isalnum(byte) != 0;
        if (letter && !is_inside) words.emplace_back();
        if (letter) words.back() += c;
        is_inside = letter;
    }
    return words;
}

// Every word as a quoted prefix: "tio" finds TiO2, and no character has a special meaning.
std::string full_text_query(const std::vector<std::string>& words) {
    return words.empty() ? "" : fmt::format("\"{}\"*", fmt::join(words, "\"* AND \""));
}

/// What compounds of two elements are called by the second one, in both spellings.
std::string name_by_formula(const std::string& formula) {
    static const std::map<std::string, std::string> names = {
        {"O", "oxide"},       {"N", "nitride"},    {"C", "carbide"},   {"S", "sulfide sulphide"},
        {"F", "fluoride"},    {"Cl", "chloride"},  {"Br", "bromide"},  {"I", "iodide"},
        {"Se", "selenide"},   {"Te", "telluride"}, {"P", "phosphide"}, {"As", "arsenide"},
        {"Sb", "antimonide"}, {"Si", "silicide"},  {"B", "boride"}};
    std::vector<std::string> elements;
    for (const char c : formula) {
        if (std::isupper(static_cast<unsigned char>(c)) != 0) {
            elements.emplace_back(1, c);
        } else if (std::islower(static_cast<unsigned char>(c)) != 0 && !elements.empty()) {
            elements.back() += c;
        } else if (std::isdigit(static_cast<unsigned char>(c)) == 0 && c != '.') {
            return "";
        }
    }
    if (elements.size() != 2) return "";
    const auto found = names.find(elements.back());
    return found == names.end() ? "" : found->second;
}

/// Whether a word of three letters or more is a part of a name: shorter ones are part of most.
bool contains(const MaterialInfo& material, const std::string& word) {
    constexpr std::size_t kShortest = 3;
    if (word.size() < kShortest) return false;
    const std::string text = lower_case(
        fmt::format("{}\n{}\n{}\n{}\n{}", material.name, material.title, material.formula,
                    fmt::join(material.aliases, "\n"), name_by_formula(material.formula)));
    return text.find(lower_case(word)) != std::string::npos;
}

}  // namespace

bool fits(const DatasetInfo& dataset, const SearchFilter& filter) {
    if (filter.needs_k && !dataset.k_known) return false;
    if (!filter.covers_from_nm && !filter.covers_to_nm) return true;
    if (!dataset.n_known) return false;
    const double from = filter.covers_from_nm.value_or(filter.covers_to_nm.value_or(0));
    const double to = filter.covers_to_nm.value_or(from);
    constexpr double kRounding = 1e-9;  // as RefractiveIndex::covers
    return dataset.shortest_nm * (1 - kRounding) <= std::min(from, to) &&
           std::max(from, to) <= dataset.longest_nm * (1 + kRounding);
}

std::vector<MaterialInfo> Database::list() const {
    std::set<std::string> names;
    for (const auto& layer : layers_) {
        for (const LayerMaterial& material : layer->materials()) names.insert(material.name);
    }
    std::vector<MaterialInfo> all;
    all.reserve(names.size());
    for (const std::string& name : names) {
        MaterialInfo material = info(name);
        // Those without a dataset are names of what is missing: searches find them.
        if (material.datasets > 0) all.push_back(std::move(material));
    }
    return all;
}

std::vector<MaterialInfo> Database::search(const std::string& text) const {
    return search(SearchFilter{.text = text, .covers_from_nm = {}, .covers_to_nm = {}});
}

std::vector<MaterialInfo> Database::search(const SearchFilter& filter) const {
    std::vector<std::string> names;
    const auto add = [&](const std::string& name) {
        if (std::find(names.begin(), names.end(), name) == names.end()) names.push_back(name);
    };
    const std::vector<std::string> words = words_of(filter.text);
    const auto indexed = [&](const std::vector<std::string>& of) {
        std::vector<std::string> all;
        for (const auto& layer : layers_) {
            for (std::string& name : layer->full_text(full_text_query(of)))
                all.push_back(std::move(name));
        }
        return all;
    };
    if (filter.text.find_first_not_of(" \t") == std::string::npos) {
        for (const MaterialInfo& material : list()) add(material.name);
    } else if (!words.empty()) {
        for (const std::string& exact : resolve(filter.text)) add(exact);
        for (const std::string& name : indexed(words)) add(name);
        std::vector<MaterialInfo> rest = list();
        for (const std::string& word : words) {
            const std::vector<std::string> begin = indexed({word});
            std::erase_if(rest, [&](const MaterialInfo& material) {
                return std::find(begin.begin(), begin.end(), material.name) == begin.end() &&
                       !contains(material, word);
            });
        }
        for (const MaterialInfo& material : rest) add(material.name);
    }
    const bool filtered = filter.needs_k || filter.covers_from_nm || filter.covers_to_nm;
    std::vector<MaterialInfo> found;
    for (const std::string& name : names) {
        const auto suits = [&](const DatasetInfo& dataset) { return fits(dataset, filter); };
        if (filtered && std::ranges::none_of(datasets(name), suits)) continue;
        found.push_back(info(name));
    }
    return found;
}

std::vector<std::string> Database::not_indexed(const Layer& layer) {
    std::vector<std::string> missed;
    for (const LayerMaterial& material : layer.materials()) {
        const std::string query = full_text_query(words_of(material.name));
        if (!query.empty() && !layer.indexed(material.id, query)) missed.push_back(material.name);
    }
    return missed;
}

std::vector<std::string> Database::integrity_problems() const {
    std::vector<std::string> problems;
    for (const auto& layer : layers_) {
        sqlite::Statement check = layer->connection.prepare("PRAGMA integrity_check");
        while (check.step()) {
            if (check.text(0) != "ok") problems.push_back(layer->name + ": " + check.text(0));
        }
        sqlite::Statement keys = layer->connection.prepare("PRAGMA foreign_key_check");
        while (keys.step()) {
            problems.push_back(
                fmt::format("{}: a row of {} refers to nothing", layer->name, keys.text(0)));
        }
        const std::vector<std::string> missed = not_indexed(*layer);
        if (missed.empty()) continue;
        problems.push_back(
            fmt::format("{}: the search index does not find {} of {} materials ({}{})", layer->name,
                        missed.size(), layer->materials().size(), missed.front(),
                        missed.size() > 1 ? ", ..." : ""));
    }
    return problems;
}

}  // namespace miebrdf::materials
