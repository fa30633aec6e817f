#include "pipeline/solve/resolved_medium.h"

#include <fmt/format.h>

#include <algorithm>
#include <filesystem>
#include <limits>

#include <miebrdf/error.h>

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

std::optional<std::complex<double>> ResolvedMedium::index_at(double wavelength_nm,
                                                             double k_floor) const {
    std::complex<double> index;
    if (const auto* constant = std::get_if<IndexMedium>(&medium)) {
        index = constant->refractive_index;
    } else if (table) {
        try {
            index = table->at(wavelength_nm);
        } catch (const std::out_of_range& error) {
            throw InputError(fmt::format(
                "{}; `miebrdf materials import` takes a table that goes further", error.what()));
        }
    } else {
        return std::nullopt;
    }
    return std::complex<double>(index.real(), std::max(index.imag(), k_floor));
}

void require_contrast(const ResolvedMedium& medium, const std::vector<double>& wavelengths_nm,
                      const ParticleOptions& particles) {
    // Quotients of equal numbers are 1; what differs by rounding alone is no contrast either.
    constexpr double kRounding = 4 * std::numeric_limits<double>::epsilon();
    for (const double wavelength_nm : wavelengths_nm) {
        const auto index = medium.index_at(wavelength_nm, particles.k_floor);
        if (!index || std::abs(*index / particles.host_index - 1.0) > kRounding) continue;
        throw UsageError(fmt::format(
            "{}: its refractive index at {} nm is that of its host, {}: without contrast nothing "
            "scatters; give another medium or another --host-index",
            describe(medium.medium), wavelength_nm, particles.host_index));
    }
}

void ResolvedMedium::add_to(JobKey& key, double wavelength_nm,
                            const ParticleOptions& particles) const {
    if (const auto index = index_at(wavelength_nm, particles.k_floor)) {
        // Only n, k and the sizes count: two names for the same figures are the same job.
        key.add(std::string_view("mie")).add(index->real()).add(index->imag()).add(wavelength_nm);
        const mie::SizeDistribution sizes = particles_of(medium, particles).sizes;
        key.add(std::string_view(name_of(sizes.kind))).add(sizes.effective_radius_um);
        key.add(sizes.effective_variance).add(particles.host_index);
        if (sizes.kind == mie::SizeDistributionKind::tabulated) {
            key.add(std::span<const double>(sizes.radii_um));
            key.add(std::span<const double>(sizes.number_density));
        }
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
    if (named == nullptr) return {medium, std::nullopt, describe(with_sizes(medium, {}))};
    if (!database_) database_.emplace(open_database(file_));
    try {
        return {medium, database_->refractive_index(named->name),
                source_line(database_->info(named->name))};
    } catch (const std::runtime_error& error) {
        throw InputError(error.what());
    }
}

}  // namespace miebrdf
