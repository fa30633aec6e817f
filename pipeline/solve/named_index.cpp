#include "pipeline/solve/named_index.h"

#include <fmt/format.h>
#include <fmt/ranges.h>
#include <miebrdf/error.h>

#include <algorithm>
#include <filesystem>

#include "pipeline/cache/job_key.h"
#include "pipeline/scene/medium_kinds.h"

namespace miebrdf {
namespace {

std::string source_line(const materials::MaterialInfo& info) {
    // A table of one's own may come without title and reference.
    std::vector<std::string> parts;
    for (const std::string* part : {&info.title, &info.reference}) {
        if (!part->empty()) parts.push_back(*part);
    }
    if (parts.empty()) parts = {fmt::format("dataset {}, {}", info.default_dataset, info.source)};
    std::string line = fmt::format("{}: {}", info.name, fmt::join(parts, "; "));
    if (!info.k_known) line += "; k was not measured and is taken as 0";
    return line;
}

}  // namespace

Materials::Materials(const std::string& file, const materials::IndexOptions& options,
                     NamedIndexMemo* memo)
    : file_(file), options_(options), memo_(memo) {
    if (!file.empty() && !std::filesystem::exists(file)) {
        throw InputError(fmt::format("materials database '{}' does not exist", file));
    }
}

materials::Database& Materials::open() {
    if (!database_) {
        database_.emplace(materials::Database::layered(
            file_.empty() ? materials::default_user_database() : std::filesystem::path(file_)));
    }
    return *database_;
}

materials::RefractiveIndex Materials::index(const std::string& name) {
    return open().refractive_index(name, options_);
}

std::optional<ResolvedIndex> NamedIndexMemo::find(const std::string& key) const {
    const std::lock_guard lock(mutex_);
    const auto known = known_.find(key);
    return known == known_.end() ? std::nullopt : std::optional(known->second);
}

void NamedIndexMemo::keep(const std::string& key, const ResolvedIndex& index) {
    const std::lock_guard lock(mutex_);
    known_.emplace(key, index);
}

ResolvedIndex Materials::remembered(const std::string& name,
                                    const std::vector<double>& wavelength_nm, double k_floor,
                                    const std::function<ResolvedIndex()>& look_up) const {
    if (memo_ == nullptr) return look_up();
    JobKey key("n and k");
    key.add(file_).add(name).add(wavelength_nm).add(k_floor).add(options_);
    const std::string hash = key.hash();
    if (auto known = memo_->find(hash)) return *known;
    ResolvedIndex found = look_up();
    memo_->keep(hash, found);
    return found;
}

namespace {

std::string caveat_of(const materials::MaterialInfo& info,
                      const std::vector<double>& wavelength_nm) {
    const std::size_t at = info.note.find(kColourCaveat);
    const bool is_visible = std::any_of(wavelength_nm.begin(), wavelength_nm.end(),
                                        [](double nm) { return nm >= 380.0 && nm <= 780.0; });
    if (at == std::string::npos || !is_visible) return "";
    return fmt::format("{}: {}", info.name, info.note.substr(at));
}

ResolvedIndex values_of(const materials::RefractiveIndex& table, std::string source,
                        const std::vector<double>& wavelength_nm, double k_floor) {
    ResolvedIndex resolved{{}, std::move(source)};
    std::size_t outside = 0, without_k = 0;
    for (const double nm : wavelength_nm) {
        const std::complex<double> n_ik = table.at(nm);
        resolved.index.emplace_back(n_ik.real(), std::max(n_ik.imag(), k_floor));
        outside += !table.covers(nm);
        without_k += table.k_known() && table.covers(nm) && !table.k_known_at(nm);
    }
    if (outside > 0) {
        resolved.source += fmt::format(
            "; {} of {} wavelengths are outside {} to {} nm: values of "
            "the nearer end",
            outside, wavelength_nm.size(), table.shortest_nm(), table.longest_nm());
    }
    if (without_k > 0) {
        resolved.source +=
            fmt::format("; k is not known at {} of {} wavelengths and taken as {} there", without_k,
                        wavelength_nm.size(), k_floor);
    }
    return resolved;
}

}  // namespace

ResolvedIndex resolve_index(const Species& species, const std::vector<double>& wavelength_nm,
                            double k_floor, Materials& materials) {
    if (species.kind == Species::Kind::index) {
        const std::complex<double> n_ik(species.parameters[0],
                                        std::max(species.parameters[1], k_floor));
        return {std::vector(wavelength_nm.size(), n_ik),
                describe(Species{.kind = species.kind, .parameters = species.parameters})};
    }
    if (species.kind == Species::Kind::table) {
        return values_of(own_index(species),
                         fmt::format("{}: n + ik as given, at {} wavelengths", species.name,
                                     species.index.size()),
                         wavelength_nm, k_floor);
    }
    ResolvedIndex found = materials.remembered(species.name, wavelength_nm, k_floor, [&] {
        const auto table = materials.index(species.name);
        const auto info = materials.open().info(species.name);
        ResolvedIndex resolved = values_of(table, source_line(info), wavelength_nm, k_floor);
        resolved.density_g_cm3 = info.density_g_cm3;
        resolved.caveat = caveat_of(info, wavelength_nm);
        return resolved;
    });
    if (materials.shift && materials.shift->name == species.name) {
        for (std::complex<double>& index : found.index) index = materials.shift->of(index);
    }
    return found;
}

ResolvedIndex resolve_index(const Species& species, const std::vector<double>& wavelength_nm,
                            const std::string& database, double k_floor) {
    Materials materials(database);
    return resolve_index(species, wavelength_nm, k_floor, materials);
}

}  // namespace miebrdf
