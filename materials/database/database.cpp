// From names to materials, datasets and their figures.
#include <miebrdf/database.h>

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <cstdlib>
#include <set>

#include "materials/database/layer.h"
#include "materials/database/mixtures.h"
#include "materials/database/names.h"
#include "materials/database/schema.h"
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

void fill_from(MaterialInfo& info, const DatasetInfo& dataset) {
    info.default_dataset = dataset.label;
    info.source = dataset.source;
    info.reference = dataset.reference;
    info.note = dataset.note;
    info.shortest_nm = dataset.shortest_nm;
    info.longest_nm = dataset.longest_nm;
    info.rows = dataset.rows;
    info.k_known = dataset.k_known;
    info.density_g_cm3 = dataset.density_g_cm3;
    info.density_source = dataset.density_source;
}

std::filesystem::path from_environment(const char* name) {
    const char* value = std::getenv(name);
    return value == nullptr ? "" : value;
}

}  // namespace

Database::Database(std::vector<std::shared_ptr<const Layer>> layers) : layers_(std::move(layers)) {}

std::shared_ptr<const Database::Layer> Database::open_layer(const std::filesystem::path& file,
                                                            bool may_be_empty) {
    std::error_code error;
    if (!std::filesystem::exists(file, error)) {
        if (may_be_empty && (!error || error == std::errc::no_such_file_or_directory))
            return nullptr;
        throw DatabaseError(fmt::format("materials database {}: {}", file.string(),
                                        error ? error.message() : "no such file"));
    }
    sqlite::Connection connection = sqlite::Connection::open_read_only(file);
    const DatabaseState state = check_schema(connection);
    if (state == DatabaseState::empty) {
        if (may_be_empty) return nullptr;
        throw DatabaseError(fmt::format("materials database {}: is empty", file.string()));
    }
    // SQLite fills a last page that was cut with zeros; files grow by whole pages only.
    const auto page_size = static_cast<std::uintmax_t>(connection.integer("PRAGMA page_size"));
    if (std::filesystem::file_size(file) % page_size != 0) {
        throw DatabaseError(
            fmt::format("materials database {}: is damaged or cut short", file.string()));
    }
    return std::make_shared<const Layer>(Layer{file.string(), std::move(connection)});
}

Database Database::open(const std::filesystem::path& file) {
    return Database({open_layer(file, false)});
}

Database Database::layered(const std::filesystem::path& user_file) {
    Database database = embedded();
    if (auto user = open_layer(user_file, true))
        database.layers_.insert(database.layers_.begin(), user);
    return database;
}

std::optional<std::string> Database::resolve_exactly(const std::string& name) const {
    const std::string key = normalised(name);
    for (auto layer = layers_.rbegin(); layer != layers_.rend(); ++layer) {
        std::optional<std::string> by_alias;
        for (const auto& [spelling, material] : (*layer)->spellings(key)) {
            if (spelling != name) continue;
            if (material == name) return material;
            by_alias = material;
        }
        if (by_alias) return by_alias;
    }
    return std::nullopt;
}

std::vector<std::string> Database::resolve(const std::string& name) const {
    if (const auto exact = resolve_exactly(name)) return {*exact};
    return resolve_normalised(name);
}

std::vector<std::string> Database::resolve_normalised(const std::string& name) const {
    for (auto layer = layers_.rbegin(); layer != layers_.rend(); ++layer) {
        std::set<std::string> found;
        for (const auto& [spelling, material] : (*layer)->spellings(normalised(name)))
            found.insert(material);
        if (!found.empty()) return {found.begin(), found.end()};
    }
    return {};
}

std::optional<std::string> Database::collected_material(const std::string& source,
                                                        const std::string& key) const {
    for (auto layer = layers_.rbegin(); layer != layers_.rend(); ++layer) {
        if (auto material = (*layer)->collected(source, key)) return material;
    }
    return std::nullopt;
}

std::vector<std::string> Database::all_names() const {
    std::set<std::string> names;
    for (const auto& layer : layers_) {
        for (const auto& [spelling, material] : layer->all_spellings()) names.insert(spelling);
    }
    return {names.begin(), names.end()};
}

void Database::throw_unknown(const std::string& name) const {
    std::vector<std::string> nearest = nearest_names(name, all_names());
    std::string message = fmt::format("no material is named '{}'", name);
    message += nearest.empty()
                   ? ", and nothing is spelled like it; search looks through titles and sources too"
                   : fmt::format("; did you mean {}?", fmt::join(nearest, ", "));
    throw UnknownMaterial(message, name, std::move(nearest));
}

std::string Database::canonical_name(const std::string& name) const {
    const std::vector<std::string> found = resolve(name);
    if (found.empty()) throw_unknown(name);
    if (found.size() > 1) {
        throw UnknownMaterial(
            fmt::format("'{}' could be {}: write the name exactly", name, fmt::join(found, ", ")),
            name, found);
    }
    return found.front();
}

std::optional<Dataset> Database::mixture(const std::string& name) const {
    const auto parsed = parse_mixture(name);
    if (!parsed) return std::nullopt;
    std::vector<RefractiveIndex> indices;
    std::vector<Dataset> parts;
    for (const auto& part : parsed->parts) {
        indices.push_back(refractive_index(part.name));
        parts.push_back(dataset(part.name));
        const MaterialInfo material = info(part.name);
        if (!parts.back().density_g_cm3) parts.back().density_g_cm3 = material.density_g_cm3;
    }
    return mix(*parsed, name, indices, parts);
}

MaterialInfo Database::info(const std::string& name) const {
    if (const auto mixed = mixture(name)) {
        MaterialInfo info;
        info.name = mixed->material;
        info.title = mixed->title;
        info.datasets = 1;
        fill_from(info, describe_unstored(*mixed));
        return info;
    }
    // "material/label" and "source:key" are looked up only when no material has that name.
    const bool one_dataset = resolve(name).empty() && name.find_first_of("/:") != std::string::npos;
    MaterialInfo info;
    std::vector<DatasetInfo> shown;
    if (one_dataset) {
        shown = {dataset_info(name)};
        info.name = shown.front().material;
    } else {
        info.name = canonical_name(name);
        shown = datasets(info.name);
    }
    std::set<std::string> aliases;
    for (const auto& layer : layers_) {
        const auto material = layer->material(info.name);
        if (!material) continue;
        if (info.title.empty()) info.title = material->title;
        if (info.formula.empty()) info.formula = material->formula;
        for (const std::string& alias : layer->aliases(material->id)) aliases.insert(alias);
    }
    info.aliases.assign(aliases.begin(), aliases.end());
    info.datasets = static_cast<int>(one_dataset ? datasets(info.name).size() : shown.size());
    if (shown.empty()) return info;
    fill_from(info, shown.front());
    // shown has the dataset described alone when one was asked for.
    if (one_dataset) {
        for (DatasetInfo& other : datasets(info.name)) shown.push_back(std::move(other));
    }
    for (const DatasetInfo& d : shown) {
        if (!d.density_g_cm3) continue;
        info.density_g_cm3 = d.density_g_cm3;
        info.density_source = d.density_source;
        break;
    }
    return info;
}

std::vector<DatasetInfo> Database::datasets(const std::string& material) const {
    if (const auto mixed = mixture(material)) return {describe_unstored(*mixed)};
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
    if (const auto mixed = mixture(name)) return describe_unstored(*mixed);
    if (!resolve(name).empty()) {
        const std::vector<DatasetInfo> all = datasets(name);
        if (all.empty()) throw UnknownMaterial(name + " has no dataset yet", name, {});
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
    if (auto mixed = mixture(name)) return *std::move(mixed);
    const DatasetInfo info = dataset_info(name);
    Dataset dataset;
    dataset.material = info.material;
    dataset.label = info.label;
    dataset.source = info.source;
    dataset.key = info.key;
    dataset.reference = info.reference;
    dataset.doi = info.doi;
    dataset.licence = info.licence;
    dataset.ray = info.ray;
    dataset.composition = info.composition;
    dataset.note = info.note;
    dataset.format = info.format;
    dataset.file = info.file;
    dataset.file_sha256 = info.file_sha256;
    dataset.temperature_k = info.temperature_k;
    dataset.density_g_cm3 = info.density_g_cm3;
    dataset.density_source = info.density_source;
    dataset.corrections = info.corrections;
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
    Dataset figures = dataset(name);
    std::vector<Coverage> others;
    for (const DatasetInfo& d : datasets(figures.material)) {
        if (d.label == figures.label || !d.n_known) continue;
        others.push_back({d.material + "/" + d.label, d.shortest_nm, d.longest_nm});
    }
    return RefractiveIndex(figures.material + "/" + figures.label, std::move(figures.n),
                           std::move(figures.k), options, std::move(others));
}

std::filesystem::path default_user_database() {
    if (auto chosen = from_environment("MIEBRDF_DATABASE"); !chosen.empty()) return chosen;
    const auto below = std::filesystem::path("miebrdf") / "materials.sqlite";
    // The XDG base directory specification asks to ignore relative paths.
    if (const auto data = from_environment("XDG_DATA_HOME"); data.is_absolute())
        return data / below;
    const auto home = from_environment("HOME");
    return (home.empty() ? std::filesystem::temp_directory_path() : home / ".local" / "share") /
           below;
}

}  // namespace miebrdf::materials
