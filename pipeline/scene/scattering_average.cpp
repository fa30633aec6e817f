// What a layer has of a file of single scattering: averages over sizes, between its wavelengths.
#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <numbers>

#include <miebrdf/error.h>
#include "pipeline/scene/matrix_on_angles.h"
#include "pipeline/scene/moments_file.h"
#include "pipeline/scene/scattering_file.h"
#include "pipeline/scene/species_keys.h"

namespace miebrdf {
namespace {

/// Sizes that averages are taken over.
constexpr int kSizes = 400;
/// Particles of tails beyond the file are few: they take part with its ends.
constexpr double kTail = 1e-3, kBeyond = 2.0;
/// One wavelength, or one size, is not asked to hold for others.
constexpr double kSame = 1e-3;

/// Radii of the file in um at a wavelength.
std::vector<double> radii_at(const FileScattering& table, double nm) {
    std::vector<double> radii = table.radius_um;
    if (table.radius_is_parameter) {
        for (double& radius : radii) radius *= nm / (2e3 * std::numbers::pi);
    }
    return radii;
}

/// The sizes that words say: of files that have averages, one radius.
/// @throws InputError  where words say none, or what the file cannot give
mie::SizeDistribution sizes_of_file(const Species& species) {
    const FileScattering& table = species.scattering;
    mie::SizeDistribution one{mie::SizeDistributionKind::mono, table.radius_um.front()};
    const bool is_alone = table.radius_um.size() == 1 && !table.radius_is_parameter;
    const bool has_law = species.sizes.effective_variance || species.sizes.distribution;
    if (has_law && (is_alone || table.has_averages)) {
        throw InputError(fmt::format(
            "scattering file '{}' has averages over sizes: leave variance, distribution and the "
            "like out; radius= picks an effective radius from {:.4g} to {:.4g} um",
            species.name, table.radius_um.front(), table.radius_um.back()));
    }
    if (is_alone && !states_radius(species)) return one;
    if (!states_radius(species)) {
        throw InputError(fmt::format(
            "scattering file '{}' has {} {} from {:.4g} to {:.4g}; say {}, e.g. scattering:{},{}",
            species.name, table.radius_um.size(),
            table.has_averages          ? "effective radii"
            : table.radius_is_parameter ? "size parameters"
                                        : "sizes",
            table.radius_um.front(), table.radius_um.back(),
            table.has_averages ? "which" : "over which sizes the average is taken", species.name,
            table.has_averages ? "radius=10" : "radius=1,variance=0.2"));
    }
    if (!is_alone && !table.has_averages) return sizes_of(species, {});
    one.effective_radius_um = sizes_of(species, {}).effective_radius_um;
    return one;
}

struct Share {
    std::size_t size = 0;
    double weight = 0.0;
};

/// Shares of the projected area that each size of the file stands for, and what they add up to over
/// the mean of pi r^2.
struct Shares {
    std::vector<Share> list;
    double area_ratio = 0.0;
};

[[noreturn]] void refuse_sizes(const Species& species, const std::vector<double>& radii,
                               const mie::RadiusRange& asked) {
    throw InputError(fmt::format(
        "scattering file '{}' has sizes from {:.4g} to {:.4g} um; those asked for reach from "
        "{:.4g} to {:.4g} um",
        species.name, radii.front(), radii.back(), asked.smallest_um, asked.largest_um));
}

Shares shares_at(const Species& species, double nm) {
    const FileScattering& table = species.scattering;
    if (!has_sizes(table)) return {{{0, 1.0}}, 1.0};
    const std::vector<double> radii = radii_at(table, nm);
    const mie::SizeDistribution sizes = sizes_of_file(species);
    const mie::RadiusRange range = mie::radius_range(sizes, kTail);
    std::vector<double> weights(radii.size(), 0.0);
    const auto add_radius = [&](double radius, double weight) {
        if (radii.size() == 1) {
            weights[0] += weight;
            return;
        }
        const auto above = std::upper_bound(radii.begin() + 1, radii.end() - 1, radius);
        const auto i = static_cast<std::size_t>(above - radii.begin());
        const double t = std::clamp((radius - radii[i - 1]) / (radii[i] - radii[i - 1]), 0.0, 1.0);
        weights[i - 1] += (1.0 - t) * weight;
        weights[i] += t * weight;
    };
    const bool is_one = range.smallest_um == range.largest_um;
    const double beyond = is_one ? 1.0 + kSame : kBeyond;
    if (range.smallest_um < radii.front() / beyond || range.largest_um > radii.back() * beyond)
        refuse_sizes(species, radii, range);
    if (is_one) add_radius(range.largest_um, 1.0);
    double before = range.smallest_um;
    for (int i = 1; i <= kSizes && !is_one; ++i) {
        const double here =
            range.smallest_um * std::pow(range.largest_um / range.smallest_um, double(i) / kSizes);
        add_radius(std::sqrt(before * here), mie::area_share_within(sizes, {before, here}));
        before = here;
    }
    Shares shares;
    for (std::size_t i = 0; i < weights.size(); ++i) {
        if (weights[i] == 0.0) continue;
        if (!table.area_ratio.empty()) weights[i] *= table.area_ratio[i];
        shares.list.push_back({i, weights[i]});
        shares.area_ratio += weights[i];
    }
    for (Share& share : shares.list) share.weight /= shares.area_ratio;
    return shares;
}

struct Between {
    std::size_t below = 0, above = 0;
    double t = 0.0;
};

Between wavelengths_at(const Species& species, double nm) {
    const std::vector<double>& at = species.scattering.wavelength_nm;
    if (at.empty()) return {};
    if (!(nm >= at.front() * (1 - kSame) && nm <= at.back() * (1 + kSame))) {
        throw InputError(
            fmt::format("scattering file '{}' has nothing at {} nm; it covers {} to "
                        "{} nm",
                        species.name, nm, at.front(), at.back()));
    }
    if (at.size() == 1) return {};
    const auto above = std::upper_bound(at.begin() + 1, at.end() - 1, nm);
    const auto i = static_cast<std::size_t>(above - at.begin());
    return {i - 1, i, std::clamp((nm - at[i - 1]) / (at[i] - at[i - 1]), 0.0, 1.0)};
}

/// Entries of the file at a wavelength and the weights of their extinction.
std::vector<Share> entries_at(const Species& species, double nm) {
    const Between at = wavelengths_at(species, nm);
    const Shares shares = shares_at(species, nm);
    const std::size_t sizes = std::max<std::size_t>(species.scattering.radius_um.size(), 1);
    std::vector<Share> entries;
    for (const auto& [w, weight] : {Share{at.below, 1.0 - at.t}, Share{at.above, at.t}}) {
        if (weight == 0.0) continue;
        for (const Share& share : shares.list)
            entries.push_back({w * sizes + share.size, weight * share.weight});
    }
    return entries;
}

void add_to(std::vector<double>& sum, const std::vector<double>& list, double weight) {
    sum.resize(list.size(), 0.0);
    for (std::size_t i = 0; i < list.size(); ++i) sum[i] += weight * list[i];
}

/// A file with the words that say which of its sizes count.
class FileMedium : public GivenMedium {
  public:
    explicit FileMedium(const Species& species) : species_(species) {}

    rte::Optics optics(double wavelength_nm) const override;
    double extinction(double wavelength_nm) const override;
    double radius_um(double wavelength_nm) const override;
    std::optional<mie::SizeDistribution> sizes() const override;
    double share_of_number(double per_um3, double wavelength_nm) const override;

  private:
    Species species_;
};

rte::Optics FileMedium::optics(double wavelength_nm) const {
    const FileScattering& table = species_.scattering;
    MatrixOnAngles mean{table.angles_deg, {}, {}};
    MatrixCoefficients coefficients;
    double extinction = 0.0, scattering = 0.0;
    for (const auto& [entry, weight] : entries_at(species_, wavelength_nm)) {
        const double part = weight * table.extinction[entry] * table.albedo[entry];
        extinction += weight * table.extinction[entry];
        scattering += part;
        if (!species_.matrices.empty()) {
            add(coefficients, species_.matrices[entry], part);
            continue;
        }
        const std::vector<double>& phase = table.phase[entry];
        add_to(mean.phase, phase, part);
        if (table.ratios.empty()) continue;
        mean.ratios.resize(MatrixOnAngles::kRatios * phase.size(), 0.0);
        for (std::size_t i = 0; i < mean.ratios.size(); ++i)
            mean.ratios[i] += part * phase[i % phase.size()] * table.ratios[entry][i];
    }
    const double albedo = std::min(1.0, scattering / extinction);
    if (!species_.matrices.empty()) {
        MatrixCoefficients normalised;
        add(normalised, coefficients, 1.0 / coefficients.a1.front());
        normalised.single_scattering_albedo = albedo;
        if (has_sizes(table)) check_matrix(normalised);
        return optics_of(normalised);
    }
    for (std::size_t i = 0; i < mean.ratios.size(); ++i) {
        const double p = mean.phase[i % mean.phase.size()];
        mean.ratios[i] = p > 0.0 ? mean.ratios[i] / p : 0.0;
    }
    return optics_of_table(std::move(mean), albedo);
}

double FileMedium::extinction(double wavelength_nm) const {
    double sum = 0.0;
    for (const auto& [entry, weight] : entries_at(species_, wavelength_nm))
        sum += weight * species_.scattering.extinction[entry];
    return sum;
}

double FileMedium::radius_um(double wavelength_nm) const {
    if (!has_sizes(species_.scattering)) return kNoRadiusUm;
    const std::vector<double> radii = radii_at(species_.scattering, wavelength_nm);
    const double of_law = mie::effective_radius_of(sizes_of_file(species_));
    // Of one shape it is that of the distribution.
    const std::vector<double>& ratio = species_.scattering.area_ratio;
    if (ratio.empty()) return of_law;
    double sum = 0.0, area = 0.0, of_spheres = 0.0;
    for (const auto& [size, weight] : shares_at(species_, wavelength_nm).list) {
        sum += weight * radii[size];
        area += weight / ratio[size];
        of_spheres += weight / ratio[size] * radii[size];
    }
    return of_law * sum * area / of_spheres;
}

std::optional<mie::SizeDistribution> FileMedium::sizes() const {
    if (!has_sizes(species_.scattering)) return std::nullopt;
    return sizes_of_file(species_);
}

double FileMedium::share_of_number(double per_um3, double wavelength_nm) const {
    if (!has_sizes(species_.scattering)) return per_um3;
    if (species_.scattering.has_averages) {
        throw UsageError(
            fmt::format("scattering file '{}' has averages over sizes and does not say which: a "
                        "number of particles has no meaning then; give volume= or mass=",
                        species_.name));
    }
    const double area_um2 = shares_at(species_, wavelength_nm).area_ratio *
                            mie::mean_cross_section_um2(sizes_of_file(species_));
    return per_um3 * 4.0 / 3.0 * radius_um(wavelength_nm) * area_um2;
}

}  // namespace

bool has_sizes(const FileScattering& table) { return !table.radius_um.empty(); }

std::shared_ptr<const GivenMedium> medium_of_file(const Species& species) {
    return std::make_shared<FileMedium>(species);
}

}  // namespace miebrdf
