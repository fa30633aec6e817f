// Listing and searching: full text, formula, coverage; and what SQLite finds wrong.
#include <fmt/format.h>

#include <algorithm>
#include <set>

#include "materials/database/layer.h"
#include "materials/database/names.h"

namespace miebrdf::materials {
namespace {

// Every word as a quoted prefix: "tio" finds TiO2, and no character has a special meaning.
std::string full_text_query(const std::string& text) {
    std::string query;
    std::string word;
    const auto flush = [&] {
        if (!word.empty()) query += (query.empty() ? "\"" : " AND \"") + word + "\"*";
        word.clear();
    };
    for (const char c : text) {
        const auto byte = static_cast<unsigned char>(c);
        const bool letter = byte >= 0x80 || std::isalnum(byte) != 0;
        if (letter) {
            word += c;
        } else {
            flush();
        }
    }
    flush();
    return query;
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
    for (const std::string& name : names) all.push_back(info(name));
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
    const std::string query = full_text_query(filter.text);
    if (filter.text.find_first_not_of(" \t") == std::string::npos) {
        for (const MaterialInfo& material : list()) add(material.name);
    } else if (!query.empty()) {
        for (const std::string& exact : resolve(filter.text)) add(exact);
        for (const auto& layer : layers_) {
            for (const std::string& name : layer->full_text(query)) add(name);
        }
    }
    const bool filtered = filter.needs_k || filter.covers_from_nm || filter.covers_to_nm;
    std::vector<MaterialInfo> found;
    for (const std::string& name : names) {
        const std::vector<DatasetInfo> all = datasets(name);
        const auto suits = [&](const DatasetInfo& dataset) { return fits(dataset, filter); };
        if (!filtered || std::any_of(all.begin(), all.end(), suits)) found.push_back(info(name));
    }
    return found;
}

std::vector<std::string> Database::not_indexed(const Layer& layer) {
    std::vector<std::string> missed;
    for (const LayerMaterial& material : layer.materials()) {
        const std::string query = full_text_query(material.name);
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
