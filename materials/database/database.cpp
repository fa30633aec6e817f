// Opening databases; from names to materials. Their datasets: database_datasets.cpp.
#include <miebrdf/database.h>

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <set>

#include "materials/database/layer.h"
#include "materials/database/names.h"
#include "materials/database/schema.h"
#include "materials/database/user_file.h"
#include "materials/index/mixing_rules.h"
#include "materials/index/oscillators.h"

namespace miebrdf::materials {
namespace {

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
    // A whole database is a number of whole pages. SQLite would read a last page that was cut off
    // as if the rest were zeros, so the size is checked here.
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

// Some words name what is made of materials.
static std::string advice_for(const std::string& name) {
    static constexpr std::pair<const char*, const char*> kAdvice[] = {
        {"snow",
         "snow is grains of H2O_ice in air: H2O_ice,radius=100um, with soot or dust if dirty"},
        {"frost", "frost is grains of H2O_ice in air: H2O_ice,radius=50um"},
        {"ice", "ice is H2O_ice"},
        {"cloud", "a cloud is drops of water in air: water,radius=10um"},
        {"fog", "fog is drops of water in air: water,radius=5um"},
        {"paint", "paint is a pigment in a binder: TiO2,radius=0.13,volume=15% in PMMA"},
        {"milk", "milk is drops of fat in water: index:1.46,radius=1,volume=3.5% in water"},
        {"soot", "soot is called soot_diesel, or carbon"}};
    for (const auto& [word, advice] : kAdvice) {
        if (normalised(name) == word) return advice;
    }
    return "";
}

void Database::throw_unknown(const std::string& name) const {
    std::vector<std::string> nearest = nearest_names(name, all_names());
    std::string message = fmt::format("no material is named '{}'", name);
    if (name.ends_with(')')) {  // a mixture or a model of its own
        std::vector<std::string> all;
        for (const MixingRule& rule : mixing_rules()) all.emplace_back(rule.name);
        for (const OscillatorKind& kind : oscillator_kinds()) all.emplace_back(kind.name);
        throw UnknownMaterial(
            fmt::format("{}; computed ones are {}, oscillators, formula and temperature", message,
                        fmt::join(all, ", ")),
            name, {});
    }
    const std::string advice = advice_for(name);
    if (!advice.empty()) throw UnknownMaterial(message + "; " + advice, name, {});
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
    if (const auto mixed = unstored(name)) {
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
    // When one dataset was asked for, `shown` has only that one; the density may come from others.
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

std::filesystem::path default_user_database() {
    if (auto chosen = from_environment("MIEBRDF_DATABASE"); !chosen.empty()) return chosen;
    return user_file("XDG_DATA_HOME", ".local/share", "materials.sqlite");
}

}  // namespace miebrdf::materials
