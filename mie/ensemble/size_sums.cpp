#include "mie/ensemble/size_sums.h"

#include <algorithm>
#include <type_traits>

#include <miebrdf/sphere.h>
#include "mie/sphere/lane_math.h"
#include "mie/sphere/radial_functions.h"

namespace miebrdf::mie {
namespace {

constexpr int kAnglesPerGroup = 128;

constexpr int kMostChunks = 8;
constexpr int kLeastChunk = 32;
constexpr double kChunkMemory = 24e6;  // bytes, all bands of a pass together

int most_chunks(int size_count, const SizeSumOptions& options) {
    // Each chunk has sums of its own, which cost as much as some ten sizes.
    const double band_bytes = 2 * 8.0 * (options.terms + 1) * (std::max(options.band_width, 0) + 1);
    const int fitting = std::max(4, static_cast<int>(kChunkMemory / band_bytes));
    return std::min(size_count >= 2048 ? kMostChunks : 4, fitting);
}

// To whole vectors.
int rounded_up(int size) { return (size + kLaneCount - 1) / kLaneCount * kLaneCount; }

template <typename Scalar>
SizeSums sum_over_blocks(std::complex<double> relative_index, const WeightedSizes& sizes,
                         const SizeSumOptions& options,
                         const std::vector<SizeChunks::Block>& blocks) {
    const bool with_moments = options.band_width >= 0;
    const bool with_waves = with_moments || options.angles != nullptr;
    SizeSums sums;
    if (with_moments) sums.covariance = BandCovariance(options.terms, options.band_width);
    if (options.angles && options.with_matrix) {
        sums.products = Eigen::ArrayXXd::Zero(options.angles->angle_count(), 4);
    } else if (options.angles) {
        sums.intensity = Eigen::VectorXd::Zero(options.angles->angle_count());
    }
    SphereBlockOf<Scalar> block;
    if (with_waves) {
        const auto& last = blocks.back();
        block.make_room(number_of_terms(sizes.parameters[last.first + last.count - 1]),
                        kMostSizesPerBlock);
    }
    for (const auto [first, count] : blocks) {
        const std::size_t here = count;
        sums.spheres.add(compute_spheres(relative_index, {sizes.parameters.data() + first, here},
                                         {sizes.weights.data() + first, here},
                                         with_waves ? &block : nullptr));
        if (with_moments) sums.covariance.add(block);
        if constexpr (std::is_same_v<Scalar, double>) {
            if (options.angles && options.with_matrix) {
                options.angles->add_products(block, sums.products);
            } else if (options.angles) {
                options.angles->add_intensity(block, sums.intensity);
            }
        }
    }
    return sums;
}

}  // namespace

template <typename Scalar>
AngularFunctionsOf<Scalar>::AngularFunctionsOf(std::span<const double> angles_deg, int terms,
                                               const Executor& run)
    : plus_(static_cast<Eigen::Index>(angles_deg.size()), terms + 1),
      minus_(plus_.rows(), terms + 1) {
    Eigen::ArrayXd mu(plus_.rows());
    for (Eigen::Index i = 0; i < mu.size(); ++i) mu[i] = cosine_of_scattering_angle(angles_deg[i]);
    fill(mu, run);
}

template <typename Scalar>
AngularFunctionsOf<Scalar>::AngularFunctionsOf(const Eigen::ArrayXd& cosines, int terms,
                                               const Executor& run)
    : plus_(cosines.size(), terms + 1), minus_(plus_.rows(), terms + 1) {
    fill(cosines, run);
}

template <typename Scalar>
void AngularFunctionsOf<Scalar>::fill(const Eigen::ArrayXd& mu, const Executor& run) {
    const int groups = static_cast<int>(mu.size() + kAnglesPerGroup - 1) / kAnglesPerGroup;
    run(groups, [&](int group) {
        const Eigen::Index first = group * Eigen::Index(kAnglesPerGroup);
        fill(first, mu.segment(first, std::min<Eigen::Index>(kAnglesPerGroup, mu.size() - first)));
    });
}

// As in scattering_amplitudes, several angles at once.
template <typename Scalar>
void AngularFunctionsOf<Scalar>::fill(Eigen::Index first, const Eigen::ArrayXd& mu) {
    const Eigen::Index count = mu.size();
    plus_.col(0).segment(first, count).setZero();
    minus_.col(0).segment(first, count).setZero();
    Eigen::ArrayXd pi_before = Eigen::ArrayXd::Zero(count), pi = Eigen::ArrayXd::Ones(count);
    Eigen::ArrayXd s(count), t(count), tau(count);
    for (Eigen::Index n = 1; n < plus_.cols(); ++n) {
        const double order = static_cast<double>(n);
        s = mu * pi;
        t = s - pi_before;
        tau = order * t - pi_before;
        const double weight = (2 * order + 1) / (order * (order + 1));
        plus_.col(n).segment(first, count) = (weight * (pi + tau)).matrix().template cast<Scalar>();
        minus_.col(n).segment(first, count) =
            (weight * (pi - tau)).matrix().template cast<Scalar>();
        pi_before.swap(pi);
        pi = s + (order + 1) / order * t;
    }
}

template <typename Scalar>
void AngularFunctionsOf<Scalar>::add_squares(const Matrix& functions,
                                             const typename SphereBlockOf<Scalar>::Matrix& waves,
                                             int first, int terms, int columns,
                                             Eigen::VectorXd& intensity) const {
    Matrix amplitude(functions.rows(), columns);
    const int count = terms - first + 1;
    amplitude.noalias() =
        functions.middleCols(first, count) * waves.block(first, 0, count, columns);
    for (int column = 0; column < columns; ++column) {
        intensity += amplitude.col(column).template cast<double>().cwiseAbs2();
    }
}

template <typename Scalar>
void AngularFunctionsOf<Scalar>::add_intensity(const SphereBlockOf<Scalar>& block,
                                               Eigen::VectorXd& intensity) const {
    const int columns = 2 * block.size;
    add_squares(plus_, block.U, block.first_term, block.terms, columns, intensity);
    add_squares(minus_, block.V, block.first_term, block.terms, columns, intensity);
}

template <typename Scalar>
void AngularFunctionsOf<Scalar>::add_forms(double weight, const Matrix& plus, const Matrix& minus,
                                           int first, Eigen::VectorXd& intensity) const {
    const auto add = [&](const Matrix& functions, const Matrix& form) {
        const auto here = functions.middleCols(first, form.cols());
        const Matrix rows = here * form;
        intensity += weight * rows.cwiseProduct(here).rowwise().sum().template cast<double>();
    };
    add(plus_, plus);
    add(minus_, minus);
}

template <typename Scalar>
void AngularFunctionsOf<Scalar>::add_products(const SphereBlockOf<Scalar>& block,
                                              Eigen::ArrayXXd& products) const {
    const int first = block.first_term, count = block.terms - first + 1, size = block.size;
    Matrix sum(angle_count(), 2 * size), difference(angle_count(), 2 * size);
    sum.noalias() = plus_.middleCols(first, count) * block.U.block(first, 0, count, 2 * size);
    difference.noalias() =
        minus_.middleCols(first, count) * block.V.block(first, 0, count, 2 * size);
    const auto dot = [&](const Matrix& a, int of_a, const Matrix& b, int of_b) {
        return a.middleCols(of_a, size)
            .cwiseProduct(b.middleCols(of_b, size))
            .rowwise()
            .sum()
            .template cast<double>()
            .array();
    };
    products.col(0) += dot(sum, 0, sum, 0) + dot(sum, size, sum, size);
    products.col(1) += dot(difference, 0, difference, 0) + dot(difference, size, difference, size);
    products.col(2) += dot(sum, 0, difference, 0) + dot(sum, size, difference, size);
    products.col(3) += dot(sum, size, difference, 0) - dot(sum, 0, difference, size);
}

template class AngularFunctionsOf<float>;
template class AngularFunctionsOf<double>;

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
    const int count = (end - first + kMostSizesPerBlock - 1) / kMostSizesPerBlock;
    const int size = rounded_up((end - first + count - 1) / count);
    std::vector<Block> list;
    for (int at = first; at < end; at += size) list.push_back({at, std::min(size, end - at)});
    return list;
}

void SizeSums::add(const SizeSums& other) {
    spheres.add(other.spheres);
    if (covariance.width() >= 0) covariance.add(other.covariance);
    if (intensity.size() > 0) intensity += other.intensity;
    if (products.size() > 0) products += other.products;
}

void SizeSums::scale(double factor) {
    spheres.scale(factor);
    covariance.scale(factor);
    intensity *= factor;
    products *= factor;
}

SizeSums sum_over_sizes(std::complex<double> relative_index, const WeightedSizes& sizes,
                        const SizeSumOptions& options, const Executor& run) {
    const int count = static_cast<int>(sizes.parameters.size());
    const SizeChunks chunks(count, most_chunks(count, options), kLeastChunk);
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
