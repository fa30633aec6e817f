#include "mie/ensemble/size_families.h"

#include <algorithm>
#include <cmath>
#include <list>
#include <type_traits>
#include <utility>
#include <vector>

#include "mie/ensemble/far_rays.h"
#include "mie/sphere/lane_math.h"
#include "mie/sphere/radial_functions.h"

namespace miebrdf::mie {
namespace {

constexpr int kMostChunksOfFamily = 4;  // of each family
constexpr int kLeastFamilyChunk = 16;

// Sizes of level 0 by family, in units of the coarsest even count (3.4 ripple periods apart).
constexpr double kFamilyShare[2] = {1.21, 1.29};
constexpr int kLeastUnit = 32;  // without ripple: of each

constexpr int kMostRayColumns = 80;  // of a block: they stay near the cache

constexpr int kLastRayLevel = 6;
constexpr double kEndSpacing = 0.5;  // in x, of one family of sizes at sharp ends

constexpr double kFinestSpacing = 0.1;    // in x
constexpr double kResolvedSpacing = 0.8;  // in x, both families together
constexpr double kDefaultTolerance = 1e-2;

constexpr double kMostKept = 20e6;                   // bytes
constexpr double kBytesPerWave = 4 * sizeof(float);  // U and V

struct Chunk {
    int family;
    std::vector<SizeChunks::Block> blocks;
};

struct Intensity {
    Eigen::VectorXd at_angles;
    double scattered = 0;
};

template <typename Scalar>
double spheres_of(std::complex<double> relative_index, const WeightedSizes& sizes,
                  SizeChunks::Block of, SphereBlockOf<Scalar>& block) {
    const std::size_t count = of.count;
    return 2 * compute_spheres(relative_index, {sizes.parameters.data() + of.first, count},
                               {sizes.weights.data() + of.first, count}, &block)
                   .scattered;
}

int terms_of(const WeightedSizes& sizes, SizeChunks::Block of) {
    return number_of_terms(sizes.parameters[of.first + of.count - 1]);
}

// @param places  of the blocks; none: they are not kept
template <typename Scalar>
Intensity intensity_of(std::complex<double> relative_index, const WeightedSizes& sizes,
                       const std::vector<SizeChunks::Block>& blocks,
                       const AngularFunctionsOf<Scalar>& angular,
                       const std::vector<KeptWaves*>& places = {}) {
    SphereBlockOf<Scalar> block;
    block.make_room(terms_of(sizes, blocks.back()), kMostSizesPerBlock);
    Intensity sum{Eigen::VectorXd::Zero(angular.angle_count())};
    for (std::size_t i = 0; i < blocks.size(); ++i) {
        if constexpr (std::is_same_v<Scalar, float>) {
            if (!places.empty() && places[i] != nullptr) {
                KeptWaves& kept = *places[i];
                if (!kept.is_there)
                    kept.scattered = spheres_of(relative_index, sizes, blocks[i], kept.block);
                kept.is_there = true;
                angular.add_intensity(kept.block, sum.at_angles);
                sum.scattered += kept.scattered;
                continue;
            }
        }
        sum.scattered += spheres_of(relative_index, sizes, blocks[i], block);
        angular.add_intensity(block, sum.at_angles);
    }
    return sum;
}

}  // namespace

std::vector<FamilyIntensity> at_some_angles(const std::vector<FamilyIntensity>& parts,
                                            Eigen::Index first, Eigen::Index count) {
    std::vector<FamilyIntensity> some(parts.size());
    for (std::size_t i = 0; i < parts.size(); ++i) {
        if (parts[i].intensity.size() == 0) continue;
        some[i] = {parts[i].intensity.middleRows(first, count),
                   {parts[i].scattered[0], parts[i].scattered[1]}};
    }
    return some;
}

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
    last_level_ = kLastRayLevel;
    groups_ = ray_groups(relative_index.real(), distribution.kind.law().has_ends,
                         method == Method::exact_rays);
    if (method == Method::exact_rays && distribution.kind.law().has_ends) {
        window_.emplace(relative_index.real(), wave_number_per_um * range.smallest_um,
                        wave_number_per_um * range.largest_um);
    }
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
                places[i].push_back(
                    place_of(0, family, level, of.first,
                             kBytesPerWave * of.count * terms_of(sizes[family], of)));
            }
        }
    }
    std::vector<Intensity> parts(chunks.size());
    const int count = static_cast<int>(chunks.size());
    run(count, [&](int job) {
        const int i = chunk_of_job(job, count);
        const auto& [family, blocks] = chunks[i];
        parts[i] = intensity_of(relative_index_, sizes[family], blocks, angular, places[i]);
    });
    FamilyIntensity total{Eigen::MatrixXd::Zero(angular.angle_count(), 2), {0, 0}};
    const int families = family_count_ - first_family;
    for (std::size_t i = 0; i < chunks.size(); ++i) {
        total.intensity.col(chunks[i].family) += parts[i].at_angles / families;
        total.scattered[chunks[i].family] += parts[i].scattered / families;
    }
    return total;
}

int SizeFamilies::part_count() const {
    if (groups_.empty()) return 1;
    return static_cast<int>(groups_.size()) + (window_ ? 1 : 0);
}

std::vector<FamilyIntensity> SizeFamilies::levels(const std::vector<int>& levels,
                                                  const AngularFunctionsOf<float>& angular,
                                                  const Executor& run) {
    if (!groups_.empty()) return levels_of_rays(levels, angular, run);
    return {level(levels.front(), angular, run)};
}

// Sizes of one family that groups with equal sizes share.
struct SizeFamilies::RayPiece {
    int family, first, count;
    std::vector<std::size_t> groups;
    const WeightedSizes* sizes;
    std::vector<KeptWaves*> places;  // of each group
    std::vector<RayIntensity> sums;  // of each group
};

// Of how many sizes the waves of one group, or of any other with the same sizes, stay near the
// cache.
int SizeFamilies::sizes_of_piece(const RayGroup& group) const {
    int columns = 1;
    for (const RayGroup& other : groups_) {
        if (other.has_sizes_of(group)) columns = std::max(columns, other.columns());
    }
    return std::max(1, kMostRayColumns / (kLaneCount * columns)) * kLaneCount;
}

void SizeFamilies::sum(RayPiece& piece, const AngularFunctionsOf<float>& angular) const {
    const RayGroup& group = groups_[piece.groups.front()];
    if (group.is_closed()) {
        piece.sums = {intensity_of_far_rays(relative_index_, group.first_way, *piece.sizes,
                                            piece.first, piece.count, angular)};
        return;
    }
    thread_local std::vector<SphereBlockOf<float>> blocks;
    blocks.resize(std::max(blocks.size(), piece.groups.size()));
    std::vector<RayColumns> missing;
    for (std::size_t i = 0; i < piece.groups.size(); ++i) {
        KeptWaves* place = piece.places[i];
        if (place == nullptr || !place->is_there)
            missing.push_back(
                {&groups_[piece.groups[i]], place == nullptr ? &blocks[i] : &place->block});
    }
    if (!missing.empty())
        put_rays(relative_index_, *piece.sizes, piece.first, piece.count, missing);
    std::size_t put = 0;
    for (std::size_t i = 0; i < piece.groups.size(); ++i) {
        KeptWaves* place = piece.places[i];
        const bool was_there = place != nullptr && place->is_there;
        const RayColumns columns =
            was_there ? RayColumns{nullptr, &place->block, place->scattered} : missing[put++];
        if (place != nullptr) {
            place->scattered = columns.scattered;
            place->is_there = true;
        }
        piece.sums.push_back({Eigen::VectorXd::Zero(angular.angle_count()), columns.scattered});
        angular.add_intensity(*columns.block, piece.sums.back().at_angles);
    }
}

std::vector<FamilyIntensity> SizeFamilies::levels_of_rays(const std::vector<int>& levels,
                                                          const AngularFunctionsOf<float>& angular,
                                                          const Executor& run) {
    std::vector<RayPiece> pieces;
    std::vector<char> is_done(groups_.size(), 0);
    std::list<WeightedSizes> sizes;  // at places that stay
    for (std::size_t g = 0; g < groups_.size(); ++g) {
        if (levels[g] < 0 || is_done[g]) continue;
        const RayGroup& group = groups_[g];
        std::vector<std::size_t> together;
        for (std::size_t other = g; other < groups_.size(); ++other) {
            if (other == g || (levels[other] == levels[g] && groups_[other].has_sizes_of(group)))
                together.push_back(other);
        }
        for (const std::size_t other : together) is_done[other] = 1;
        const int most = sizes_of_piece(group);
        for (const int family : {0, 1}) {
            const WeightedSizes& own =
                sizes.emplace_back(ray_sizes(group, distribution_, range_, wave_number_per_um_,
                                             family, levels[g], window_ ? &*window_ : nullptr));
            const int count = static_cast<int>(own.parameters.size());
            for (int first = 0; first < count; first += most) {
                const int here = std::min(most, count - first);
                RayPiece piece{family, first, here, together, &own, {}, {}};
                for (const std::size_t other : together) {
                    const double waves =
                        here * groups_[other].columns() * double(terms_of(own, {first, here}));
                    piece.places.push_back(group.is_closed()
                                               ? nullptr
                                               : place_of(static_cast<int>(other), family,
                                                          levels[g], first, kBytesPerWave * waves));
                }
                pieces.push_back(std::move(piece));
            }
        }
    }
    run(static_cast<int>(pieces.size()), [&](int job) { sum(pieces[job], angular); });
    std::vector<FamilyIntensity> parts(levels.size());
    for (std::size_t g = 0; g < parts.size(); ++g) {
        if (levels[g] >= 0) parts[g].intensity = Eigen::MatrixXd::Zero(angular.angle_count(), 2);
    }
    for (const RayPiece& piece : pieces) {
        for (std::size_t i = 0; i < piece.groups.size(); ++i) {
            FamilyIntensity& part = parts[piece.groups[i]];
            part.intensity.col(piece.family) += piece.sums[i].at_angles / 2;
            part.scattered[piece.family] += piece.sums[i].scattered / 2;
        }
    }
    if (window_ && levels.back() >= 0) add_ends(levels.back(), angular, run, parts.back());
    return parts;
}

void SizeFamilies::add_ends(int level, const AngularFunctionsOf<float>& angular,
                            const Executor& run, FamilyIntensity& to) const {
    struct Piece {
        int family;
        WeightedSizes sizes;
        std::vector<SizeChunks::Block> blocks;
    };
    std::vector<Piece> pieces;
    const double width_um = window_->width() / wave_number_per_um_;
    for (const int family : {0, 1}) {
        const int count = std::max(
            kLeastFamilyChunk,
            static_cast<int>(std::lround(kFamilyShare[family] * window_->width() / kEndSpacing)));
        for (const RadiusRange& end :
             {RadiusRange{range_.smallest_um, range_.smallest_um + width_um},
              RadiusRange{range_.largest_um - width_um, range_.largest_um}}) {
            WeightedSizes sizes(nested_size_nodes(distribution_, end, count, level),
                                wave_number_per_um_);
            for (std::size_t i = 0; i < sizes.parameters.size(); ++i)
                sizes.weights[i] *= 1 - window_->at(sizes.parameters[i]);
            const SizeChunks chunks(static_cast<int>(sizes.parameters.size()), kMostChunksOfFamily,
                                    kLeastFamilyChunk);
            for (int i = 0; i < chunks.count(); ++i)
                pieces.push_back({family, sizes, chunks.blocks(i)});
        }
    }
    std::vector<Intensity> sums(pieces.size());
    run(static_cast<int>(pieces.size()), [&](int job) {
        sums[job] = intensity_of(relative_index_, pieces[job].sizes, pieces[job].blocks, angular);
    });
    for (std::size_t i = 0; i < pieces.size(); ++i) {
        to.intensity.col(pieces[i].family) += sums[i].at_angles / 2;
        to.scattered[pieces[i].family] += sums[i].scattered / 2;
    }
}

template FamilyIntensity SizeFamilies::level(int, const AngularFunctionsOf<float>&,
                                             const Executor&);
template FamilyIntensity SizeFamilies::level(int, const AngularFunctionsOf<double>&,
                                             const Executor&);

KeptWaves* SizeFamilies::place_of(int group, int family, int level, int first_size, double bytes) {
    if (!keeps_waves_) return nullptr;
    const std::array key = {group, family, level, first_size};
    const auto known = kept_.find(key);
    if (known != kept_.end()) return &known->second;
    if (!(kept_bytes_ + bytes <= kMostKept)) return nullptr;
    kept_bytes_ += bytes;
    return &kept_[key];
}

FamilyIntensity SizeFamilies::with_level(const FamilyIntensity& before,
                                         const FamilyIntensity& level) const {
    FamilyIntensity all = level;
    if (rippled_) {
        all.intensity += before.intensity;
        for (int family : {0, 1}) all.scattered[family] += before.scattered[family];
    } else {
        all.intensity.col(0) = before.intensity.rowwise().sum();
        all.scattered[0] = before.scattered[0] + before.scattered[1];
    }
    all.intensity *= 0.5;
    for (double& scattered : all.scattered) scattered *= 0.5;
    return all;
}

}  // namespace miebrdf::mie
