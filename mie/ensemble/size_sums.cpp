#include "mie/ensemble/size_sums.h"

#include <algorithm>
#include <type_traits>

#include "mie/sphere/lanes.h"
#include "mie/sphere/terms.h"

namespace miebrdf::mie {
namespace {

constexpr int largest_chunk_count = 8;
constexpr int least_chunk_size = 32;
constexpr double chunk_memory = 24e6;  // bytes, all bands of a pass together

int most_chunks(int size_count, const SizeSumOptions& options) {
    // Each chunk has sums of its own, which cost as much as some ten sizes.
    const double band_bytes = 2 * 8.0 * (options.terms + 1) * (std::max(options.band_width, 0) + 1);
    const int fitting = std::max(4, static_cast<int>(chunk_memory / band_bytes));
    return std::min(size_count >= 2048 ? largest_chunk_count : 4, fitting);
}

// To whole vectors.
int rounded_up(int size) { return (size + lane_count - 1) / lane_count * lane_count; }

template <typename Scalar>
SizeSums sum_over_blocks(std::complex<double> relative_index, const WeightedSizes& sizes,
                         const SizeSumOptions& options,
                         const std::vector<SizeChunks::Block>& blocks) {
    const bool with_moments = options.band_width >= 0;
    const bool with_waves = with_moments || options.angles != nullptr;
    SizeSums sums;
    if (with_moments) sums.covariance = BandCovariance(options.terms, options.band_width);
    if (options.angles) sums.intensity = Eigen::VectorXd::Zero(options.angles->angle_count());
    SphereBlockOf<Scalar> block;
    if (with_waves) {
        const auto& last = blocks.back();
        block.make_room(number_of_terms(sizes.parameters[last.first + last.count - 1]),
                        most_sizes_per_block);
    }
    for (const auto [first, count] : blocks) {
        const std::size_t here = count;
        sums.spheres.add(compute_spheres(relative_index, {sizes.parameters.data() + first, here},
                                         {sizes.weights.data() + first, here},
                                         with_waves ? &block : nullptr));
        if (with_moments) sums.covariance.add(block);
        if constexpr (std::is_same_v<Scalar, double>) {
            if (options.angles) options.angles->add_intensity(block, sums.intensity);
        }
    }
    return sums;
}

}  // namespace

WeightedSizes::WeightedSizes(const SizeNodes& nodes, double wave_number_per_um) {
    for (std::size_t i = 0; i < nodes.radius_um.size(); ++i) {
        const double x = wave_number_per_um * nodes.radius_um[i];
        parameters.push_back(x);
        weights.push_back(nodes.area_share[i] / x / x);
    }
}

SizeChunks::SizeChunks(int size_count, int most, int least)
    : size_count_(size_count), count_(std::clamp(size_count / least, 1, most)) {
    per_chunk_ = rounded_up((size_count + count_ - 1) / count_);
    count_ = (size_count + per_chunk_ - 1) / per_chunk_;  // rounding may leave the last one empty
}

std::vector<SizeChunks::Block> SizeChunks::blocks(int chunk) const {
    const int first = chunk * per_chunk_;
    const int end = std::min(size_count_, first + per_chunk_);
    const int count = (end - first + most_sizes_per_block - 1) / most_sizes_per_block;
    const int size = rounded_up((end - first + count - 1) / count);
    std::vector<Block> list;
    for (int at = first; at < end; at += size) list.push_back({at, std::min(size, end - at)});
    return list;
}

void SizeSums::add(const SizeSums& other) {
    spheres.add(other.spheres);
    if (covariance.width() >= 0) covariance.add(other.covariance);
    if (intensity.size() > 0) intensity += other.intensity;
}

void SizeSums::scale(double factor) {
    spheres.scale(factor);
    covariance.scale(factor);
    intensity *= factor;
}

SizeSums sum_over_sizes(std::complex<double> relative_index, const WeightedSizes& sizes,
                        const SizeSumOptions& options, const Executor& run) {
    const int count = static_cast<int>(sizes.parameters.size());
    const SizeChunks chunks(count, most_chunks(count, options), least_chunk_size);
    std::vector<SizeSums> parts(chunks.count());
    run(chunks.count(), [&](int job) {
        const int chunk = chunk_of_job(job, chunks.count());
        const auto blocks = chunks.blocks(chunk);
        parts[chunk] = options.single_precision && !options.angles
                           ? sum_over_blocks<float>(relative_index, sizes, options, blocks)
                           : sum_over_blocks<double>(relative_index, sizes, options, blocks);
    });
    SizeSums total = std::move(parts[0]);
    for (int chunk = 1; chunk < chunks.count(); ++chunk) total.add(parts[chunk]);
    return total;
}

}  // namespace miebrdf::mie
