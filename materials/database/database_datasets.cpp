// From names to datasets and their figures.
#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>

#include <miebrdf/database.h>
#include "materials/database/layer.h"
#include "materials/database/names.h"
#include "materials/index/checksum.h"

namespace miebrdf::materials {
namespace {

std::vector<std::string> full_names(const std::vector<DatasetInfo>& datasets) {
    std::vector<std::string> names;
    names.reserve(datasets.size());
    for (const DatasetInfo& d : datasets) names.push_back(d.material + "/" + d.label);
    return names;
}

bool is_source(const std::string& source, const std::string& asked) {
    const std::string short_name = source == "refractiveindex.info" ? "rii" : "";
    return normalised(source) == normalised(asked) || (!asked.empty() && asked == short_name);
}

// "https://refractiveindex.info/?shelf=main&book=GaP&page=Bond" -> "main/GaP/Bond"; nothing when it
// is no such address.
std::string page_of_address(const std::string& name) {
    if (name.find("refractiveindex.info/?") == std::string::npos) return "";
    std::string page;
    for (const char* part : {"shelf=", "book=", "page="}) {
        const std::size_t start = name.find(part);
        if (start == std::string::npos) return "";
        const std::size_t from = name.find('=', start) + 1;
        page +=
            (page.empty() ? "" : "/") + name.substr(from, name.find_first_of("&#", from) - from);
    }
    return page;
}

}  // namespace

std::vector<DatasetInfo> Database::datasets(const std::string& material) const {
    if (const auto mixed = unstored(material)) return {describe_unstored(*mixed)};
    const std::string name = canonical_name(material);
    std::string chosen;
    std::vector<DatasetInfo> lower_first;
    for (auto layer = layers_.rbegin(); layer != layers_.rend(); ++layer) {
        const auto found = (*layer)->material(name);
        if (!found) continue;
        if (!found->default_label.empty()) chosen = found->default_label;
        for (auto& [id, info] : (*layer)->datasets(found->id)) {
            info.material = name;
            lower_first.push_back(std::move(info));
        }
    }
    const auto is_default = [&](const DatasetInfo& d) { return d.label == chosen; };
    const auto first = std::find_if(lower_first.begin(), lower_first.end(), is_default);
    if (first != lower_first.end()) std::rotate(lower_first.begin(), first, first + 1);
    return lower_first;
}

std::vector<DatasetInfo> Database::labelled(const std::string& material,
                                            const std::string& label) const {
    std::vector<DatasetInfo> alike;
    const std::vector<DatasetInfo> all = datasets(material);
    for (const DatasetInfo& d : all) {
        if (d.label == label) return {d};
        if (normalised(d.label) == normalised(label)) alike.push_back(d);
    }
    if (alike.empty()) {
        const std::string name = material + "/" + label;
        throw UnknownMaterial(fmt::format("no dataset is named '{}'; known: {}", name,
                                          fmt::join(full_names(all), ", ")),
                              name, full_names(all));
    }
    return alike;
}

std::vector<DatasetInfo> Database::from_source(const std::string& source,
                                               const std::string& key) const {
    // The lowest layer that has the key: an import does not change what it means.
    for (auto layer = layers_.rbegin(); layer != layers_.rend(); ++layer) {
        std::vector<DatasetInfo> found;
        for (const std::string& owner : (*layer)->materials_with_key(key)) {
            for (const DatasetInfo& d : datasets(owner)) {
                if (d.layer == (*layer)->name && normalised(d.key) == normalised(key) &&
                    is_source(d.source, source)) {
                    found.push_back(d);
                }
            }
        }
        if (!found.empty()) return found;
    }
    return {};
}

DatasetInfo Database::dataset_info(const std::string& name) const {
    if (const auto mixed = unstored(name)) return describe_unstored(*mixed);
    if (!resolve(name).empty()) {
        const std::vector<DatasetInfo> all = datasets(name);
        if (all.empty()) {
            const std::string title = info(name).title;
            throw UnknownMaterial(name + (title.empty() ? " has no dataset yet" : ": " + title),
                                  name, {});
        }
        return all.front();
    }
    std::vector<DatasetInfo> found;
    const auto slash = name.find('/');
    const auto colon = name.find(':');
    const std::string page = page_of_address(name);
    if (!page.empty()) {
        found = from_source("rii", page);
    } else if (slash != std::string::npos && resolve(name.substr(0, slash)).size() == 1) {
        found = labelled(name.substr(0, slash), name.substr(slash + 1));
    } else if (colon != std::string::npos) {
        found = from_source(name.substr(0, colon), name.substr(colon + 1));
    }
    if (found.empty()) throw_unknown(name);
    if (found.size() > 1) {
        const std::vector<std::string> names = full_names(found);
        throw UnknownMaterial(fmt::format("'{}' could be {}", name, fmt::join(names, ", ")), name,
                              names);
    }
    return found.front();
}

Dataset Database::dataset(const std::string& name) const {
    if (auto mixed = unstored(name)) return *std::move(mixed);
    const DatasetInfo info = dataset_info(name);
    Dataset dataset;
    static_cast<DatasetOrigin&>(dataset) = info;
    for (const auto& layer : layers_) {
        const auto material = layer->material(info.material);
        if (!material) continue;
        if (dataset.title.empty()) dataset.title = material->title;
        if (dataset.formula.empty()) dataset.formula = material->formula;
        if (layer->name != info.layer) continue;
        for (const auto& [id, stored] : layer->datasets(material->id)) {
            if (stored.label != info.label) continue;
            dataset.n = layer->series(id, 'n');
            dataset.k = layer->series(id, 'k');
        }
    }
    if (content_sha256(dataset) != info.content_sha256) {
        throw DatabaseError(fmt::format(
            "materials database {}: the figures of {}/{} do not fit their checksum: the file "
            "is damaged",
            info.layer, info.material, info.label));
    }
    return dataset;
}

RefractiveIndex Database::refractive_index(const std::string& name,
                                           const IndexOptions& options) const {
    if (auto made = computed(name, options)) return made->index;
    Dataset figures = dataset(name);
    std::vector<Coverage> others;
    for (const DatasetInfo& d : datasets(figures.material)) {
        if (d.label == figures.label || !d.n_known) continue;
        others.push_back({d.material + "/" + d.label, d.shortest_nm, d.longest_nm});
    }
    return RefractiveIndex(figures.material + "/" + figures.label, std::move(figures.n),
                           std::move(figures.k), options, std::move(others));
}

}  // namespace miebrdf::materials
