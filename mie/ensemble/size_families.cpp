#include "mie/ensemble/size_families.h"

#include <algorithm>
#include <cmath>
#include <type_traits>
#include <utility>
#include <vector>

#include "mie/sphere/radial_functions.h"

namespace miebrdf::mie {
namespace {

constexpr int kMostChunksOfFamily = 4;  // of each family
constexpr int kLeastFamilyChunk = 16;

constexpr int kLeastUnit = 32;  // without ripple: of each

constexpr double kFinestSpacing = 0.1;    // in x
constexpr double kResolvedSpacing = 0.8;  // in x, both families together
constexpr double kDefaultTolerance = 1e-2;

struct Chunk {
    int family;
    std::vector<SizeChunks::Block> blocks;
};

}  // namespace

SizeFamilies::SizeFamilies(std::complex<double> relative_index,
                           const SizeDistribution& distribution, const RadiusRange& range,
                           double wave_number_per_um, double size_tolerance, Method method)
    : relative_index_(relative_index),
      distribution_(distribution),
      range_(range),
      wave_number_per_um_(wave_number_per_um),
      rippled_(
          !(relative_index.imag() * wave_number_per_um * effective_radius_of(distribution) > 1)) {
    if (distribution.kind.law().single_size) {
        family_count_ = 1;
        return;
    }
    const double width = wave_number_per_um * (range.largest_um - range.smallest_um);
    if (rippled_) {
        const int unit = std::max(kLeastUnit, coarsest_even_count(relative_index.real(), width));
        for (int family : {0, 1}) {
            first_counts_[family] = static_cast<int>(std::lround(kFamilyShare[family] * unit));
        }
    }
    const int together = first_counts_[0] + first_counts_[1];
    if (!rippled_) {
        const double levels = std::log2(width / (kResolvedSpacing * together));
        resolved_level_ = std::max(0, static_cast<int>(std::ceil(levels)));
    }
    const double finer = std::min(1.0, std::pow(size_tolerance / kDefaultTolerance, 1 / 1.5));
    const double most = std::clamp(width / (kFinestSpacing * finer), 4096.0, double(kNodeLimit));
    while (together << (last_level_ + 1) <= most) ++last_level_;
    if (method == Method::sizes) return;
    last_level_ = RayFamilies::kLastLevel;
    rays_.emplace(relative_index, distribution, range, wave_number_per_um,
                  method == Method::exact_rays);
}

WeightedSizes SizeFamilies::sizes_of(int family, int level) const {
    if (family_count_ == 1) return WeightedSizes({{range_.largest_um}, {1.0}}, wave_number_per_um_);
    const int count = first_counts_[family];
    return WeightedSizes(
        rippled_ ? nested_size_nodes(distribution_, range_, count, level, SizeSpacing::equal)
                 : nested_size_nodes(distribution_, range_, count, level == 0 ? family : level + 1,
                                     SizeSpacing::geometric),
        wave_number_per_um_);
}

int SizeFamilies::sizes_at(int level) const {
    if (family_count_ == 1) return 1;
    return (first_counts_[0] + first_counts_[1]) << std::max(0, level - 1);
}

template <typename Scalar>
FamilyIntensity SizeFamilies::level(int level, const AngularFunctionsOf<Scalar>& angular,
                                    const Executor& run) {
    const int first_family = rippled_ || level == 0 ? 0 : 1;
    std::vector<WeightedSizes> sizes(family_count_);
    std::vector<Chunk> chunks;
    for (int family = first_family; family < family_count_; ++family) {
        sizes[family] = sizes_of(family, level);
        const SizeChunks parts(static_cast<int>(sizes[family].parameters.size()),
                               kMostChunksOfFamily, kLeastFamilyChunk);
        for (int i = 0; i < parts.count(); ++i) chunks.push_back({family, parts.blocks(i)});
    }
    // From small to large spheres.
    std::stable_sort(chunks.begin(), chunks.end(), [](const Chunk& a, const Chunk& b) {
        return a.blocks.front().first < b.blocks.front().first;
    });
    std::vector<std::vector<KeptWaves*>> places(chunks.size());
    if constexpr (std::is_same_v<Scalar, float>) {
        for (std::size_t i = 0; i < chunks.size(); ++i) {
            const int family = chunks[i].family;
            for (const SizeChunks::Block& of : chunks[i].blocks) {
                places[i].push_back(waves_.place_of(
                    {0, family, level, of.first}, double(of.count) * terms_of(sizes[family], of)));
            }
        }
    }
    std::vector<SphereIntensity> parts(chunks.size());
    const int count = static_cast<int>(chunks.size());
    run(count, [&](int job) {
        const int i = chunk_of_job(job, count);
        const auto& [family, blocks] = chunks[i];
        parts[i] = intensity_of_spheres(relative_index_, sizes[family], blocks, angular, places[i]);
    });
    FamilyIntensity total{Eigen::MatrixXd::Zero(angular.angle_count(), 2), {0, 0}};
    const int families = family_count_ - first_family;
    for (std::size_t i = 0; i < chunks.size(); ++i) {
        total.intensity.col(chunks[i].family) += parts[i].at_angles / families;
        total.scattered[chunks[i].family] += parts[i].scattered / families;
    }
    return total;
}

std::vector<FamilyIntensity> SizeFamilies::levels(const std::vector<int>& levels,
                                                  const AngularFunctionsOf<float>& angular,
                                                  const Executor& run) {
    if (rays_) return rays_->levels(levels, angular, run, waves_);
    return {level(levels.front(), angular, run)};
}

template FamilyIntensity SizeFamilies::level(int, const AngularFunctionsOf<float>&,
                                             const Executor&);
template FamilyIntensity SizeFamilies::level(int, const AngularFunctionsOf<double>&,
                                             const Executor&);

FamilyIntensity SizeFamilies::with_level(const FamilyIntensity& before,
                                         const FamilyIntensity& level) const {
    FamilyIntensity all = level;
    if (rippled_) {
        const double rest = 1 - level.share;
        all.intensity = level.share * level.intensity + rest * before.intensity;
        for (int family : {0, 1})
            all.scattered[family] =
                level.share * level.scattered[family] + rest * before.scattered[family];
        return all;
    }
    all.intensity.col(0) = before.intensity.rowwise().sum();
    all.scattered[0] = before.scattered[0] + before.scattered[1];
    all.intensity *= 0.5;
    for (double& scattered : all.scattered) scattered *= 0.5;
    return all;
}

}  // namespace miebrdf::mie
