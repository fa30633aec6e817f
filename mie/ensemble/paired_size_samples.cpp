#include "mie/ensemble/paired_size_samples.h"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <span>
#include <type_traits>
#include <utility>
#include <vector>

#include "mie/sizes/size_nodes.h"

namespace miebrdf::mie {
namespace {

// Bytes of angular functions at once.
constexpr double kMostOfFunctions = 256e6;

struct Chunk {
    int sample;
    std::vector<SizeChunks::Block> blocks;
};

// Puts the rows of some angles where they belong among all.
void append(const std::vector<PairedIntensity>& parts, Eigen::Index count, Eigen::Index first,
            std::vector<PairedIntensity>& all) {
    all.resize(parts.size());
    for (std::size_t i = 0; i < parts.size(); ++i) {
        if (parts[i].intensity.size() == 0) continue;
        Eigen::MatrixXd intensity = std::move(all[i].intensity);
        all[i] = parts[i];
        if (intensity.size() == 0) intensity.resize(count, 2);
        intensity.middleRows(first, parts[i].intensity.rows()) = parts[i].intensity;
        all[i].intensity = std::move(intensity);
    }
}

}  // namespace

PairedSizeSamples::PairedSizeSamples(const Ensemble& ensemble, PhaseMethod method)
    : ensemble_(ensemble), rippled_(ensemble.ripples() || method != PhaseMethod::sizes) {
    if (ensemble.law().single_size) {
        sample_count_ = 1;
        return;
    }
    // One in x, which is about the period of ripple.
    const int unit = std::max(SizeRule::kFirstEven, rippled_ ? int(ensemble.width_in_x()) : 0) / 2;
    for (const int sample : {0, 1})
        first_counts_[sample] =
            static_cast<int>(std::lround((rippled_ ? kSampleShare[sample] : 1.0) * unit));
    const int together = first_counts_[0] + first_counts_[1];
    if (!rippled_) {
        // Four sizes a period resolve exp(2i x).
        const double levels =
            std::log2(ensemble.width_in_x() / (0.25 * std::numbers::pi * together));
        resolved_level_ = std::max(0, static_cast<int>(std::ceil(levels)));
    }
    while (together << (last_level_ + 1) <= SizeRule::kMostEven) ++last_level_;
    if (method == PhaseMethod::sizes) return;
    last_level_ = PairedRaySamples::kLastLevel;
    rays_.emplace(ensemble, method == PhaseMethod::exact_rays);
}

WeightedSizes PairedSizeSamples::sizes_of(int sample, int level) const {
    const RadiusRange& range = ensemble_.range;
    if (sample_count_ == 1)
        return WeightedSizes({{range.largest_um}, {1.0}}, ensemble_.wave_number_per_um);
    const int count = first_counts_[sample];
    return WeightedSizes(
        rippled_ ? nested_size_nodes(ensemble_.sizes, range, count, level, SizeSpacing::equal)
                 : nested_size_nodes(ensemble_.sizes, range, count, level == 0 ? sample : level + 1,
                                     SizeSpacing::geometric),
        ensemble_.wave_number_per_um);
}

int PairedSizeSamples::sizes_at(int level) const {
    if (sample_count_ == 1) return 1;
    return (first_counts_[0] + first_counts_[1]) << std::max(0, level - 1);
}

template <typename Scalar>
PairedIntensity PairedSizeSamples::level(int level, const AngularFunctionsOf<Scalar>& angular,
                                         const Executor& run) {
    const int first_sample = rippled_ || level == 0 ? 0 : 1;
    std::vector<WeightedSizes> sizes(sample_count_);
    std::vector<Chunk> chunks;
    for (int sample = first_sample; sample < sample_count_; ++sample) {
        sizes[sample] = sizes_of(sample, level);
        const SizeChunks parts(static_cast<int>(sizes[sample].parameters.size()));
        for (int i = 0; i < parts.count(); ++i) chunks.push_back({sample, parts.blocks(i)});
    }
    // From small to large spheres.
    std::stable_sort(chunks.begin(), chunks.end(), [](const Chunk& a, const Chunk& b) {
        return a.blocks.front().first < b.blocks.front().first;
    });
    std::vector<std::vector<KeptWaves*>> places(chunks.size());
    if constexpr (std::is_same_v<Scalar, float>) {
        for (std::size_t i = 0; i < chunks.size(); ++i) {
            const int sample = chunks[i].sample;
            for (const SizeChunks::Block& of : chunks[i].blocks) {
                places[i].push_back(waves_.place_of(
                    {0, sample, level, of.first},
                    double(of.count) * terms_of(ensemble_.scatterer, sizes[sample], of)));
            }
        }
    }
    std::vector<SphereIntensity> parts(chunks.size());
    const int count = static_cast<int>(chunks.size());
    run(count, [&](int job) {
        const int i = chunk_of_job(job, count);
        const auto& [sample, blocks] = chunks[i];
        parts[i] =
            intensity_of_spheres(ensemble_.scatterer, sizes[sample], blocks, angular, places[i]);
    });
    PairedIntensity total{Eigen::MatrixXd::Zero(angular.angle_count(), 2), {0, 0}};
    const int samples = sample_count_ - first_sample;
    for (std::size_t i = 0; i < chunks.size(); ++i) {
        total.intensity.col(chunks[i].sample) += parts[i].at_angles / samples;
        total.scattered[chunks[i].sample] += parts[i].scattered / samples;
    }
    return total;
}

std::vector<PairedIntensity> PairedSizeSamples::levels(const std::vector<int>& levels,
                                                       const std::vector<double>& angles_deg,
                                                       bool in_double, const Executor& run) {
    const int terms = ensemble_.terms();
    const double bytes = 2.0 * terms * (in_double ? sizeof(double) : sizeof(float));
    const auto most = static_cast<std::size_t>(std::max(1.0, kMostOfFunctions / bytes));
    std::vector<PairedIntensity> all;
    for (std::size_t first = 0; first < angles_deg.size(); first += most) {
        const std::span angles =
            std::span(angles_deg).subspan(first, std::min(most, angles_deg.size() - first));
        std::vector<PairedIntensity> parts;
        if (rays_) {
            parts =
                rays_->levels(levels, AngularFunctionsOf<float>(angles, terms, run), run, waves_);
        } else if (in_double) {
            parts = {level(levels.front(), AngularFunctions(angles, terms, run), run)};
        } else {
            parts = {level(levels.front(), AngularFunctionsOf<float>(angles, terms, run), run)};
        }
        if (most >= angles_deg.size()) return parts;
        append(parts, static_cast<Eigen::Index>(angles_deg.size()),
               static_cast<Eigen::Index>(first), all);
    }
    return all;
}

PairedIntensity PairedSizeSamples::with_level(const PairedIntensity& before,
                                              const PairedIntensity& level) const {
    PairedIntensity all = level;
    if (rippled_) {
        const double rest = 1 - level.share;
        all.intensity = level.share * level.intensity + rest * before.intensity;
        for (int sample : {0, 1})
            all.scattered[sample] =
                level.share * level.scattered[sample] + rest * before.scattered[sample];
        return all;
    }
    all.intensity.col(0) = before.intensity.rowwise().sum();
    all.scattered[0] = before.scattered[0] + before.scattered[1];
    all.intensity *= 0.5;
    for (double& scattered : all.scattered) scattered *= 0.5;
    return all;
}

}  // namespace miebrdf::mie
