#include "materials/database/database.h"

#include <fmt/format.h>

#include <algorithm>
#include <set>

#include "materials/database/layer.h"
#include "materials/database/names.h"
#include "materials/database/schema.h"

namespace miebrdf::materials {

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
    std::optional<std::string> by_alias;
    for (const auto& layer : layers_) {
        for (const auto& [spelling, material] : layer->spellings(key)) {
            if (spelling != name) continue;
            if (material == name) return material;
            if (!by_alias) by_alias = material;
        }
    }
    return by_alias;
}

std::vector<std::string> Database::resolve(const std::string& name) const {
    if (const auto exact = resolve_exactly(name)) return {*exact};
    return resolve_normalised(name);
}

std::vector<std::string> Database::resolve_normalised(const std::string& name) const {
    std::set<std::string> found;
    for (const auto& layer : layers_) {
        for (const auto& [spelling, material] : layer->spellings(normalised(name)))
            found.insert(material);
    }
    return {found.begin(), found.end()};
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

MaterialInfo Database::info(const std::string& name) const {
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
    const DatasetInfo& dataset = shown.front();
    info.default_dataset = dataset.label;
    info.source = dataset.source;
    info.reference = dataset.reference;
    info.note = dataset.note;
    info.shortest_nm = dataset.shortest_nm;
    info.longest_nm = dataset.longest_nm;
    info.rows = dataset.rows;
    info.k_known = dataset.k_known;
    return info;
}

std::vector<DatasetInfo> Database::datasets(const std::string& material) const {
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

}  // namespace miebrdf::materials
