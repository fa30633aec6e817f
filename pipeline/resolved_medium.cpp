#include "pipeline/resolved_medium.h"

#include <fmt/format.h>

#include <algorithm>
#include <filesystem>

#include "pipeline/error.h"

namespace miebrdf {
namespace {

/// The user's own materials over the embedded ones.
materials::Database open_database(const std::string& file) {
    try {
        return materials::Database::layered(file.empty() ? materials::default_user_database()
                                                         : std::filesystem::path(file));
    } catch (const std::runtime_error& error) {
        throw InputError(error.what());
    }
}

std::string source_line(const materials::MaterialInfo& info) {
    std::string line = fmt::format("{}: {}; {}", info.name, info.title, info.reference);
    if (!info.k_known) line += "; k was not measured and is taken as 0";
    return line;
}

}  // namespace

std::optional<std::complex<double>> ResolvedMedium::index_at(double wavelength_nm,
                                                             double k_floor) const {
    std::complex<double> index;
    if (const auto* constant = std::get_if<IndexMedium>(&medium)) {
        index = constant->refractive_index;
    } else if (table) {
        try {
            index = table->at(wavelength_nm);
        } catch (const std::out_of_range& error) {
            throw InputError(error.what());
        }
    } else {
        return std::nullopt;
    }
    return std::complex<double>(index.real(), std::max(index.imag(), k_floor));
}

void ResolvedMedium::add_to(JobKey& key, double wavelength_nm,
                            const ParticleOptions& particles) const {
    if (const auto index = index_at(wavelength_nm, particles.k_floor)) {
        // Only n, k and the sizes count: two names for the same figures are the same job.
        key.add(std::string_view("mie")).add(index->real()).add(index->imag()).add(wavelength_nm);
        key.add(static_cast<int>(particles.sizes.kind)).add(particles.sizes.effective_radius_um);
        key.add(particles.sizes.effective_variance).add(particles.host_index);
    } else if (const auto* moments = std::get_if<MomentsMedium>(&medium)) {
        key.add(std::string_view("moments")).add(moments->single_scattering_albedo);
        key.add(std::span<const double>(moments->chi));
    } else {
        key.add(std::string_view(describe(medium)));
    }
}

MediumResolver::MediumResolver(const std::string& file) : file_(file) {
    if (!file.empty() && !std::filesystem::exists(file)) {
        throw InputError(fmt::format("materials database '{}' does not exist", file));
    }
}

ResolvedMedium MediumResolver::resolve(const Medium& medium) {
    const auto* named = std::get_if<DatabaseMedium>(&medium);
    if (named == nullptr) return {medium, std::nullopt, describe(medium)};
    if (!database_) database_.emplace(open_database(file_));
    try {
        return {medium, database_->refractive_index(named->name),
                source_line(database_->info(named->name))};
    } catch (const std::runtime_error& error) {
        throw InputError(error.what());
    }
}

}  // namespace miebrdf
