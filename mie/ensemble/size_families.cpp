#include "mie/ensemble/size_families.h"

#include <algorithm>
#include <cmath>
#include <list>
#include <numbers>
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

// Of the sizes of levels 0 and 1, what a part may err by where rays interfere: times what the
// families differ by, and of its value.
constexpr double kFewDifference[] = {3, 2}, kFewShare[] = {0.05, 0.003};
constexpr double kGlories = 165 * std::numbers::pi / 180;

constexpr int kMostRayColumns = 80;  // of a block: they stay near the cache

constexpr int kLastNestedLevel = 6;  // by rays
constexpr int kEnds = 2;             // parts of P by rays, the end of small spheres first
constexpr double kEndSpacing = 0.5;  // in x, of one family of sizes at sharp ends

constexpr double kFinestSpacing = 0.1;    // in x
constexpr double kResolvedSpacing = 0.8;  // in x, both families together
constexpr double kDefaultTolerance = 1e-2;

constexpr double kMostKept = 30e6;                   // bytes
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

// Of a mean over a level and those before it. Under weights of their own, twice as many sizes err
// by a third: the newest counts for most.
double share_of_level(const RayGroup& group, const RaySizeRule& rule) {
    if (rule.nested_level <= 0) return 1;
    return group.is_way_by_way() && rule.nested_level > 1 ? 0.75 : 0.5;
}

}  // namespace

std::vector<FamilyIntensity> at_some_angles(const std::vector<FamilyIntensity>& parts,
                                            Eigen::Index first, Eigen::Index count) {
    std::vector<FamilyIntensity> some(parts.size());
    for (std::size_t i = 0; i < parts.size(); ++i) {
        if (parts[i].intensity.size() == 0) continue;
        some[i] = {parts[i].intensity.middleRows(first, count),
                   {parts[i].scattered[0], parts[i].scattered[1]},
                   parts[i].share};
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
    groups_ = ray_groups(method == Method::exact_rays);
    last_level_ = kLastNestedLevel + 1;
    if (method == Method::exact_rays && distribution.kind.law().has_ends) {
        window_.emplace(relative_index.real(), wave_number_per_um * range.smallest_um,
                        wave_number_per_um * range.largest_um);
    }
    ray_sizes_ = std::make_unique<const RaySizes>(distribution, range, wave_number_per_um, window_);
    interference_ = std::make_unique<const RayInterference>(relative_index.real(), *ray_sizes_);
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
    return static_cast<int>(groups_.size()) + (window_ ? kEnds : 0);
}

double SizeFamilies::believed_of_few(std::size_t i, int level, double lower_theta,
                                     double upper_theta, double difference, double value) const {
    // Elsewhere the nodes of a panel, or of a single angle, are far enough apart.
    if (i >= groups_.size() || groups_[i].is_closed() || level > 1 || upper_theta < kGlories)
        return difference;
    const RayGroup& group = groups_[i];
    bool interferes = !group.is_way_by_way();
    for (int way = group.first_way; way <= group.last_way && !interferes; ++way) {
        for (const double theta : {lower_theta, upper_theta})
            interferes = interferes || interference_->is_seen(way, theta);
    }
    if (!interferes) return difference;
    return std::max(kFewDifference[level] * difference, kFewShare[level] * value);
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
    std::vector<const Factors*> factors;  // of each group, over all sizes; null: none
    std::vector<KeptWaves*> places;       // of each group
    std::vector<RayIntensity> sums;       // of each group
};

// Of how many sizes the waves of any group stay near the cache: the same for all of them, whichever
// are wanted together, as waves are kept by piece.
int SizeFamilies::sizes_of_piece() const {
    int columns = 1;
    for (const RayGroup& group : groups_) columns = std::max(columns, group.columns());
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
        Eigen::VectorXd& to = piece.sums.back().at_angles;
        if (columns.block->size == 0) continue;
        if (piece.factors[i] == nullptr) {
            angular.add_intensity(*columns.block, to);
        } else {
            const int first = piece.first * groups_[piece.groups[i]].columns();
            angular.add_intensity(*columns.block,
                                  piece.factors[i]->middleCols(first, columns.block->size), to);
        }
    }
}

std::vector<FamilyIntensity> SizeFamilies::levels_of_rays(const std::vector<int>& levels,
                                                          const AngularFunctionsOf<float>& angular,
                                                          const Executor& run) {
    std::vector<RayPiece> pieces;
    std::vector<char> is_done(groups_.size(), 0);
    std::list<WeightedSizes> sizes;  // at places that stay
    std::list<std::array<Factors, 2>> factors;
    for (std::size_t g = 0; g < groups_.size(); ++g) {
        if (levels[g] < 0 || is_done[g]) continue;
        const RayGroup& group = groups_[g];
        const RaySizeRule rule = group.sizes_at(levels[g]);
        std::vector<std::size_t> together = {g};
        for (std::size_t other = g + 1; other < groups_.size(); ++other) {
            if (levels[other] >= 0 && !group.is_closed() && !groups_[other].is_closed() &&
                groups_[other].sizes_at(levels[other]) == rule)
                together.push_back(other);
        }
        for (const std::size_t other : together) is_done[other] = 1;
        const int most = sizes_of_piece();
        const WeightedSizes* of_both[2];
        for (const int family : {0, 1})
            of_both[family] = &sizes.emplace_back(ray_sizes_->of(rule, family));
        std::vector<const std::array<Factors, 2>*> own_factors;
        for (const std::size_t other : together) {
            const bool weighted = !rule.is_smooth() && groups_[other].is_way_by_way();
            own_factors.push_back(weighted
                                      ? &factors.emplace_back(interference_->factors_of_columns(
                                            groups_[other], of_both, angular, run))
                                      : nullptr);
        }
        for (const int family : {0, 1}) {
            const WeightedSizes& own = *of_both[family];
            const int count = static_cast<int>(own.parameters.size());
            for (int first = 0; first < count; first += most) {
                const int here = std::min(most, count - first);
                RayPiece piece{family, first, here, together, &own, {}, {}, {}};
                for (const auto* both : own_factors)
                    piece.factors.push_back(both == nullptr ? nullptr : &(*both)[family]);
                for (const std::size_t other : together) {
                    const double waves =
                        here * groups_[other].columns() * double(terms_of(own, {first, here}));
                    piece.places.push_back(
                        group.is_closed() ? nullptr
                                          : place_of(static_cast<int>(other), family, levels[other],
                                                     first, kBytesPerWave * waves));
                }
                pieces.push_back(std::move(piece));
            }
        }
    }
    run(static_cast<int>(pieces.size()), [&](int job) { sum(pieces[job], angular); });
    std::vector<FamilyIntensity> parts(levels.size());
    for (std::size_t g = 0; g < parts.size(); ++g) {
        if (levels[g] < 0) continue;
        parts[g].intensity = Eigen::MatrixXd::Zero(angular.angle_count(), 2);
        if (g < groups_.size())
            parts[g].share = share_of_level(groups_[g], groups_[g].sizes_at(levels[g]));
    }
    for (const RayPiece& piece : pieces) {
        for (std::size_t i = 0; i < piece.groups.size(); ++i) {
            FamilyIntensity& part = parts[piece.groups[i]];
            part.intensity.col(piece.family) += piece.sums[i].at_angles / 2;
            part.scattered[piece.family] += piece.sums[i].scattered / 2;
        }
    }
    for (std::size_t part = groups_.size(); part < parts.size(); ++part) {
        if (levels[part] >= 0)
            add_end(static_cast<int>(part), levels[part], angular, run, parts[part]);
    }
    return parts;
}

void SizeFamilies::add_end(int part, int level, const AngularFunctionsOf<float>& angular,
                           const Executor& run, FamilyIntensity& to) {
    struct Piece {
        int family;
        WeightedSizes sizes;
        std::vector<SizeChunks::Block> blocks;
        std::vector<KeptWaves*> places;
    };
    std::vector<Piece> pieces;
    const double width_um = window_->width() / wave_number_per_um_;
    const bool smallest = part == static_cast<int>(groups_.size());
    const RadiusRange end = smallest
                                ? RadiusRange{range_.smallest_um, range_.smallest_um + width_um}
                                : RadiusRange{range_.largest_um - width_um, range_.largest_um};
    for (const int family : {0, 1}) {
        const int count = std::max(
            kLeastFamilyChunk,
            static_cast<int>(std::lround(kFamilyShare[family] * window_->width() / kEndSpacing)));
        WeightedSizes sizes(nested_size_nodes(distribution_, end, count, level),
                            wave_number_per_um_);
        for (std::size_t i = 0; i < sizes.parameters.size(); ++i)
            sizes.weights[i] *= 1 - window_->at(sizes.parameters[i]);
        const SizeChunks chunks(static_cast<int>(sizes.parameters.size()), kMostChunksOfFamily,
                                kLeastFamilyChunk);
        for (int i = 0; i < chunks.count(); ++i) {
            Piece piece{family, sizes, chunks.blocks(i), {}};
            for (const SizeChunks::Block& of : piece.blocks)
                piece.places.push_back(place_of(part, family, level, of.first,
                                                kBytesPerWave * of.count * terms_of(sizes, of)));
            pieces.push_back(std::move(piece));
        }
    }
    std::vector<Intensity> sums(pieces.size());
    run(static_cast<int>(pieces.size()), [&](int job) {
        const Piece& piece = pieces[job];
        sums[job] = intensity_of(relative_index_, piece.sizes, piece.blocks, angular, piece.places);
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
