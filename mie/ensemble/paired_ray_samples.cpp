#include "mie/ensemble/paired_ray_samples.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <list>
#include <utility>

#include "mie/ensemble/far_rays.h"
#include "mie/sphere/lane_math.h"

namespace miebrdf::mie {
namespace {

// docs/internals/constants.md says what each constant does.
struct RaySampleRule {
    /// The sizes of levels 0 and 1 may err, where rays interfere, by so many times what the samples
    /// differ by, and by this share of the part's value (docs/internals/mie-log.md#rays).
    static constexpr double kDifference[] = {3, 2}, kShare[] = {0.05, 0.003};
    /// Columns of a block that stay near the cache.
    static constexpr int kMostColumns = 80;
    /// Parts of P by rays at sharp ends, that of small spheres first; the spacing in x of one
    /// sample of sizes there.
    static constexpr int kEnds = 2;
    static constexpr double kEndSpacing = 0.5;
};

// The share of a level in the mean over it and those before. Under weights of their own, twice as
// many sizes err by a third: the newest counts for most.
double share_of_level(const RayGroup& group, const RaySizeRule& rule) {
    if (rule.nested_level <= 0) return 1;
    return group.is_way_by_way() && rule.nested_level > 1 ? 0.75 : 0.5;
}

}  // namespace

PairedRaySamples::PairedRaySamples(const Ensemble& ensemble, bool exact)
    : ensemble_(ensemble), groups_(ray_groups(exact)) {
    if (exact && ensemble.law().has_ends)
        window_.emplace(ensemble.scatterer.n(), ensemble.smallest_x(), ensemble.largest_x());
    sizes_ = std::make_unique<const RaySizes>(ensemble, window_);
    interference_ = std::make_unique<const RayInterference>(ensemble.scatterer.n(), *sizes_);
}

int PairedRaySamples::part_count() const {
    return static_cast<int>(groups_.size()) + (window_ ? RaySampleRule::kEnds : 0);
}

double PairedRaySamples::noise_floor_at_level(std::size_t i, int level, double lower_theta,
                                              double upper_theta, double difference,
                                              double value) const {
    if (i >= groups_.size() || groups_[i].is_closed() || level > 1 ||
        upper_theta < AverageLimits::kBackward)  // elsewhere nodes are far enough apart to tell
        return difference;
    const RayGroup& group = groups_[i];
    bool interferes = !group.is_way_by_way();
    for (int way = group.first_way; way <= group.last_way && !interferes; ++way) {
        for (const double theta : {lower_theta, upper_theta})
            interferes = interferes || interference_->is_seen(way, theta);
    }
    if (!interferes) return difference;
    return std::max(RaySampleRule::kDifference[level] * difference,
                    RaySampleRule::kShare[level] * value);
}

// Sizes of one sample that groups with equal sizes share.
struct PairedRaySamples::Piece {
    int sample, first, count;
    std::vector<std::size_t> groups;
    const WeightedSizes* sizes;
    std::vector<const Factors*> factors;  // of each group, over all sizes; null: none
    std::vector<KeptWaves*> places;       // of each group
    std::vector<RayIntensity> sums;       // of each group
};

// The waves of so many sizes of any group stay near the cache. It is one number for all groups,
// whichever are wanted together, as waves are kept by piece.
int PairedRaySamples::sizes_of_piece() const {
    int columns = 1;
    for (const RayGroup& group : groups_) columns = std::max(columns, group.columns());
    return std::max(1, RaySampleRule::kMostColumns / (kLaneCount * columns)) * kLaneCount;
}

void PairedRaySamples::sum(Piece& piece, const AngularFunctionsOf<float>& angular) const {
    const RayGroup& group = groups_[piece.groups.front()];
    if (group.is_closed()) {
        piece.sums = {intensity_of_far_rays(ensemble_.scatterer.relative_index, group.first_way,
                                            *piece.sizes, piece.first, piece.count, angular)};
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
        put_rays(ensemble_.scatterer.relative_index, *piece.sizes, piece.first, piece.count,
                 missing);
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

// Pieces of all groups, and what they refer to, at places that stay.
struct PairedRaySamples::Work {
    std::vector<Piece> pieces = {};
    std::list<WeightedSizes> sizes = {};
    std::list<std::array<Factors, 2>> factors = {};
};

// Groups with equal sizes share the responses of the boundary.
std::vector<std::vector<std::size_t>> PairedRaySamples::groups_together(
    const std::vector<int>& levels) const {
    std::vector<std::vector<std::size_t>> all;
    for (std::size_t g = 0; g < groups_.size(); ++g) {
        if (levels[g] < 0) continue;
        const auto together = std::find_if(all.begin(), all.end(), [&](const auto& others) {
            const std::size_t first = others.front();
            return !groups_[g].is_closed() && !groups_[first].is_closed() &&
                   groups_[first].sizes_at(levels[first]) == groups_[g].sizes_at(levels[g]);
        });
        if (together != all.end()) {
            together->push_back(g);
        } else {
            all.push_back({g});
        }
    }
    return all;
}

void PairedRaySamples::add_pieces(const std::vector<std::size_t>& together,
                                  const std::vector<int>& levels,
                                  const AngularFunctionsOf<float>& angular, const Executor& run,
                                  WaveStore& waves, Work& work) const {
    const RaySizeRule rule = groups_[together.front()].sizes_at(levels[together.front()]);
    const WeightedSizes* of_both[2];
    for (const int sample : {0, 1})
        of_both[sample] = &work.sizes.emplace_back(sizes_->of(rule, sample));
    std::vector<const std::array<Factors, 2>*> factors;
    for (const std::size_t g : together) {
        const bool weighted = !rule.is_smooth() && groups_[g].is_way_by_way();
        factors.push_back(weighted ? &work.factors.emplace_back(interference_->factors_of_columns(
                                         groups_[g], of_both, angular, run))
                                   : nullptr);
    }
    const int most = sizes_of_piece();
    for (const int sample : {0, 1}) {
        const WeightedSizes& own = *of_both[sample];
        const int count = static_cast<int>(own.parameters.size());
        for (int first = 0; first < count; first += most) {
            const int here = std::min(most, count - first);
            Piece piece{sample, first, here, together, &own, {}, {}, {}};
            for (const auto* both : factors)
                piece.factors.push_back(both == nullptr ? nullptr : &(*both)[sample]);
            const double orders = terms_of(ensemble_.scatterer, own, {first, here});
            for (const std::size_t g : together) {
                const WaveStore::Key key{static_cast<int>(g), sample, levels[g], first};
                piece.places.push_back(
                    groups_[g].is_closed()
                        ? nullptr
                        : waves.place_of(key, here * groups_[g].columns() * orders));
            }
            work.pieces.push_back(std::move(piece));
        }
    }
}

std::vector<PairedIntensity> PairedRaySamples::levels(const std::vector<int>& levels,
                                                      const AngularFunctionsOf<float>& angular,
                                                      const Executor& run, WaveStore& waves) const {
    Work work;
    for (const std::vector<std::size_t>& together : groups_together(levels))
        add_pieces(together, levels, angular, run, waves, work);
    run(static_cast<int>(work.pieces.size()), [&](int job) { sum(work.pieces[job], angular); });
    std::vector<PairedIntensity> parts(levels.size());
    for (std::size_t i = 0; i < parts.size(); ++i) {
        if (levels[i] < 0) continue;
        parts[i].intensity = Eigen::MatrixXd::Zero(angular.angle_count(), 2);
        if (i < groups_.size())
            parts[i].share = share_of_level(groups_[i], groups_[i].sizes_at(levels[i]));
    }
    for (const Piece& piece : work.pieces) {
        for (std::size_t i = 0; i < piece.groups.size(); ++i) {
            PairedIntensity& part = parts[piece.groups[i]];
            part.intensity.col(piece.sample) += piece.sums[i].at_angles / 2;
            part.scattered[piece.sample] += piece.sums[i].scattered / 2;
        }
    }
    for (std::size_t i = groups_.size(); i < parts.size(); ++i) {
        if (levels[i] >= 0) add_end(static_cast<int>(i), levels[i], angular, run, waves, parts[i]);
    }
    return parts;
}

void PairedRaySamples::add_end(int part, int level, const AngularFunctionsOf<float>& angular,
                               const Executor& run, WaveStore& waves, PairedIntensity& to) const {
    struct Chunk {
        int sample;
        WeightedSizes sizes;
        std::vector<SizeChunks::Block> blocks;
        std::vector<KeptWaves*> places;
    };
    std::vector<Chunk> chunks;
    const double width_um = window_->width() / ensemble_.wave_number_per_um;
    const bool smallest = part == static_cast<int>(groups_.size());
    const RadiusRange end =
        smallest ? RadiusRange{ensemble_.range.smallest_um, ensemble_.range.smallest_um + width_um}
                 : RadiusRange{ensemble_.range.largest_um - width_um, ensemble_.range.largest_um};
    for (const int sample : {0, 1}) {
        const int count = static_cast<int>(
            std::lround(kSampleShare[sample] * window_->width() / RaySampleRule::kEndSpacing));
        WeightedSizes sizes(nested_size_nodes(ensemble_.sizes, end, count, level),
                            ensemble_.wave_number_per_um);
        for (std::size_t i = 0; i < sizes.parameters.size(); ++i)
            sizes.weights[i] *= 1 - window_->at(sizes.parameters[i]);
        const SizeChunks cuts(static_cast<int>(sizes.parameters.size()));
        for (int i = 0; i < cuts.count(); ++i) {
            Chunk chunk{sample, sizes, cuts.blocks(i), {}};
            for (const SizeChunks::Block& of : chunk.blocks)
                chunk.places.push_back(
                    waves.place_of({part, sample, level, of.first},
                                   double(of.count) * terms_of(ensemble_.scatterer, sizes, of)));
            chunks.push_back(std::move(chunk));
        }
    }
    std::vector<SphereIntensity> sums(chunks.size());
    run(static_cast<int>(chunks.size()), [&](int job) {
        const Chunk& chunk = chunks[job];
        sums[job] = intensity_of_spheres(ensemble_.scatterer, chunk.sizes, chunk.blocks, angular,
                                         chunk.places);
    });
    for (std::size_t i = 0; i < chunks.size(); ++i) {
        to.intensity.col(chunks[i].sample) += sums[i].at_angles / 2;
        to.scattered[chunks[i].sample] += sums[i].scattered / 2;
    }
}

}  // namespace miebrdf::mie
