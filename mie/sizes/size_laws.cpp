// The list of laws, and what all of them share.
#include <fmt/format.h>

#include <cmath>

#include <miebrdf/error.h>
#include "mie/sizes/size_law.h"

namespace miebrdf::mie {

extern const SizeLaw kPowerLaw, kGamma, kLogNormal, kRosinRammler, kMono, kJunge, kTabulated;

namespace {

// All that can be asked for by name, in the order in which help lists them.
constexpr const SizeLaw* kLaws[] = {
    &kPowerLaw, &kGamma, &kLogNormal, &kRosinRammler, &kMono,
};

}  // namespace

constinit const SizeDistributionKind SizeDistributionKind::power_law{kPowerLaw};
constinit const SizeDistributionKind SizeDistributionKind::gamma{kGamma};
constinit const SizeDistributionKind SizeDistributionKind::log_normal{kLogNormal};
constinit const SizeDistributionKind SizeDistributionKind::mono{kMono};
constinit const SizeDistributionKind SizeDistributionKind::junge{kJunge};
constinit const SizeDistributionKind SizeDistributionKind::tabulated{kTabulated};

SizeDistributionKind parse_size_distribution(std::string_view name) {
    std::string known;
    for (const SizeLaw* law : kLaws) {
        if (name == law->name) return law->kind();
        known += (known.empty() ? "" : ", ") + std::string(law->name);
    }
    throw UsageError(fmt::format("unknown size distribution '{}'; allowed: {}", name, known));
}

std::string name_of(SizeDistributionKind kind) { return SizeLaw::of(kind).name; }

bool has_variance(SizeDistributionKind kind) { return SizeLaw::of(kind).has_variance; }

std::vector<SizeDistributionForm> size_distribution_forms() {
    std::vector<SizeDistributionForm> forms;
    for (const SizeLaw* law : kLaws) forms.push_back({law->name, law->help});
    return forms;
}

RadiusRange radius_range(const SizeDistribution& distribution, double tail,
                         double saturation_radius_um) {
    const SizeLaw& law = SizeLaw::of(distribution.kind);
    law.validate(distribution);
    if (!(tail >= 1e-18 && tail <= 0.1)) throw UsageError("tail", tail, "1e-18 to 0.1");
    return law.range(distribution, tail, saturation_radius_um);
}

RadiusRange radius_range(const SizeDistribution& distribution) {
    return radius_range(distribution, 1e-16);
}

double area_share_within(const SizeDistribution& distribution, const RadiusRange& range) {
    return SizeLaw::of(distribution.kind).area_share_within(distribution, range);
}

double effective_radius_of(const SizeDistribution& distribution) {
    const SizeLaw& law = SizeLaw::of(distribution.kind);
    law.validate(distribution);
    return law.effective_radius_um(distribution);
}

std::unique_ptr<const AreaDensity> area_density(const SizeDistribution& distribution) {
    const SizeLaw& law = SizeLaw::of(distribution.kind);
    law.validate(distribution);
    if (law.area_density == nullptr) {
        throw UsageError(fmt::format("size distribution '{}' has no density", law.name));
    }
    return law.area_density(distribution);
}

void require_radius_and_variance(const SizeDistribution& d) {
    if (!(d.effective_radius_um > 0 && std::isfinite(d.effective_radius_um))) {
        throw UsageError("effective_radius_um", d.effective_radius_um, "positive and finite");
    }
    if (!SizeLaw::of(d.kind).has_variance) return;
    if (!(d.effective_variance > 0 && d.effective_variance <= 10)) {
        throw UsageError("effective_variance", d.effective_variance, "above 0, up to 10");
    }
}

MappedRadius evenly_spread(const SizeDistribution&, const RadiusRange& range, double t,
                           SizeSpacing spacing) {
    if (spacing == SizeSpacing::geometric) {
        const double log_ratio = std::log(range.largest_um / range.smallest_um);
        const double radius = range.smallest_um * std::exp(t * log_ratio);
        return {radius, radius * log_ratio};
    }
    const double width = range.largest_um - range.smallest_um;
    return {range.smallest_um + t * width, width};
}

}  // namespace miebrdf::mie
