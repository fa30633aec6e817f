#include "mie/ensemble/size_sums.h"

#include <algorithm>
#include <cstring>
#include <type_traits>
#include <utility>

#include <miebrdf/sphere.h>
#include "mie/ensemble/amplitude_tiles.h"
#include "mie/sphere/lane_math.h"
#include "mie/sphere/radial_functions.h"
#include "rte/math/interruption.h"

namespace miebrdf::mie {
namespace {

// Chosen by run time (docs/internals/performance-log.md): no result hangs on them but by rounding.
struct SumRule {
    static constexpr int kTilesPerJob = 10;
    /// Tiles from which on waves, which every tile reads again, are copied together.
    static constexpr int kTilesWorthACopy = 16;
    /// Bytes of all bands of a pass together.
    static constexpr double kChunkMemory = 24e6;
};

int most_chunks(int size_count, const SizeSumOptions& options) {
    // Each chunk has sums of its own, which cost as much as some ten sizes.
    const double band_bytes = 2 * 8.0 * (options.terms + 1) * (std::max(options.band_width, 0) + 1);
    const int fitting =
        std::max(SizeChunks::kMost, static_cast<int>(SumRule::kChunkMemory / band_bytes));
    return std::min((size_count >= 2048 ? 2 : 1) * SizeChunks::kMost, fitting);
}

// Columns that many tiles read again, copied order behind order, and the stride between orders.
template <typename Scalar, bool kHalves>
std::pair<WaveColumns<Scalar, kHalves>, std::ptrdiff_t> close_together(
    const WaveColumns<Scalar, kHalves>& columns, std::ptrdiff_t stride, int count, int tiles) {
    if (tiles < SumRule::kTilesWorthACopy) return {columns, stride};
    const int step = columns.kNumbers;
    thread_local Eigen::Array<Scalar, Eigen::Dynamic, 1> kept;
    if (kept.size() < Eigen::Index(count) * step) kept.resize(Eigen::Index(count) * step);
    columns.copy(stride, count, kept.data());
    return {{kept.data(), kept.data() + step / 2}, step};
}

// To whole vectors.
int rounded_up(int size) { return (size + kLaneCount - 1) / kLaneCount * kLaneCount; }

template <typename Scalar>
SizeSums sum_over_blocks(const Scatterer& scatterer, const WeightedSizes& sizes,
                         const SizeSumOptions& options,
                         const std::vector<SizeChunks::Block>& blocks) {
    const bool with_moments = options.band_width >= 0;
    const auto* angles = std::get_if<AngularFunctionsOf<Scalar>>(options.angles);
    const bool with_waves = with_moments || angles != nullptr;
    SizeSums sums;
    if (with_moments) sums.covariance = BandCovariance(options.terms, options.band_width);
    if (angles && options.with_matrix) {
        sums.products = Eigen::ArrayXXd::Zero(angles->angle_count(), 4);
    } else if (angles) {
        sums.intensity = Eigen::VectorXd::Zero(angles->angle_count());
    }
    SphereBlockOf<Scalar> block;
    if (with_waves) {
        const auto& last = blocks.back();
        block.make_room(scatterer.terms(sizes.parameters[last.first + last.count - 1]),
                        kMostSizesPerBlock);
    }
    for (const auto [first, count] : blocks) {
        const std::size_t here = count;
        sums.spheres.add(compute_spheres(scatterer, {sizes.parameters.data() + first, here},
                                         {sizes.weights.data() + first, here},
                                         with_waves ? &block : nullptr, &sums.every_other));
        if (with_moments) sums.covariance.add(block);
        if (angles && options.with_matrix) {
            angles->add_products(block, sums.products);
        } else if (angles) {
            angles->add_intensity(block, sums.intensity);
        }
    }
    return sums;
}

// The first kCount numbers of some vectors.
template <int kCount, typename Scalar>
MIEBRDF_VECTOR void store_first(const Vector* vectors, Scalar* to) {
    for (int first = 0; first < kCount; first += kVectorSize, ++vectors) {
        const int count = std::min(kVectorSize, kCount - first);
        if constexpr (std::is_same_v<Scalar, float>) {
            const FloatVector rounded = single(*vectors);
            std::memcpy(to + first, &rounded, count * sizeof(float));
        } else {
            std::memcpy(to + first, vectors, count * sizeof(double));
        }
    }
}

}  // namespace

template <typename Scalar>
int TriangularForm<Scalar>::piece_end(int column) {
    constexpr int piece = 2 * kRegisterSize<Scalar>;
    return (column / piece + 1) * piece;
}

template <typename Scalar>
void TriangularForm<Scalar>::make_room(int count) {
    count_ = count;
    row_size_ = piece_end(count - 1);
    const std::size_t size = static_cast<std::size_t>(count) * row_size_;
    if (values_.size() < size) values_.resize(size);
}

template class TriangularForm<float>;
template class TriangularForm<double>;

template <typename Scalar>
AngularFunctionsOf<Scalar>::AngularFunctionsOf(std::span<const double> angles_deg, int terms,
                                               const Executor& run) {
    make_room(static_cast<Eigen::Index>(angles_deg.size()), terms);
    Eigen::ArrayXd mu(angle_count_);
    for (Eigen::Index i = 0; i < mu.size(); ++i) mu[i] = cosine_of_scattering_angle(angles_deg[i]);
    fill(mu, run);
}

template <typename Scalar>
AngularFunctionsOf<Scalar>::AngularFunctionsOf(const Eigen::ArrayXd& cosines, int terms,
                                               const Executor& run) {
    make_room(cosines.size(), terms);
    fill(cosines, run);
}

template <typename Scalar>
void AngularFunctionsOf<Scalar>::make_room(Eigen::Index angle_count, int terms) {
    angle_count_ = static_cast<int>(angle_count);
    terms_ = terms;
    const Eigen::Index columns = tile_count() * Eigen::Index(terms + 1);
    plus_.resize(kAnglesPerTile, columns);
    minus_.resize(kAnglesPerTile, columns);
}

template <typename Scalar>
int AngularFunctionsOf<Scalar>::tile_count() const {
    return (angle_count_ + kAnglesPerTile - 1) / kAnglesPerTile;
}

template <typename Scalar>
int AngularFunctionsOf<Scalar>::angles_in(int tile) const {
    return std::min(kAnglesPerTile, angle_count_ - tile * kAnglesPerTile);
}

template <typename Scalar>
const Scalar* AngularFunctionsOf<Scalar>::of_tile(const Matrix& functions, int tile,
                                                  int order) const {
    return functions.data() + (tile * Eigen::Index(terms_ + 1) + order) * kAnglesPerTile;
}

template <typename Scalar>
void AngularFunctionsOf<Scalar>::fill(const Eigen::ArrayXd& mu, const Executor& run) {
    cosines_ = mu;
    const int jobs = (tile_count() + SumRule::kTilesPerJob - 1) / SumRule::kTilesPerJob;
    run(jobs, [&](int job) {
        const int end = std::min(tile_count(), (job + 1) * SumRule::kTilesPerJob);
        for (int tile = job * SumRule::kTilesPerJob; tile < end; ++tile) {
            math::interruption_point();
            fill_tile(tile, mu.data() + tile * kAnglesPerTile);
        }
    });
}

// As in scattering_amplitudes, all angles of a tile at once; those that a tile which is not full
// lacks are 90 degrees.
template <typename Scalar>
void AngularFunctionsOf<Scalar>::fill_tile(int tile, const double* cosines) {
    constexpr int kVectors = (kAnglesPerTile + kVectorSize - 1) / kVectorSize;
    Vector mu[kVectors] = {}, pi[kVectors], pi_before[kVectors] = {};
    std::memcpy(mu, cosines, angles_in(tile) * sizeof(double));
    for (Vector& one : pi) one = Vector{} + 1;
    Scalar* plus = plus_.data() + tile * Eigen::Index(terms_ + 1) * kAnglesPerTile;
    Scalar* minus = minus_.data() + tile * Eigen::Index(terms_ + 1) * kAnglesPerTile;
    std::fill_n(plus, kAnglesPerTile, Scalar(0));
    std::fill_n(minus, kAnglesPerTile, Scalar(0));
    for (int n = 1; n <= terms_; ++n) {
        plus += kAnglesPerTile;
        minus += kAnglesPerTile;
        const double order = n, weight = (2 * order + 1) / (order * (order + 1));
        const double growth = (order + 1) / order;
        Vector sums[kVectors], differences[kVectors];
        for (int i = 0; i < kVectors; ++i) {
            const Vector s = mu[i] * pi[i];
            const Vector t = s - pi_before[i];
            const Vector tau = order * t - pi_before[i];
            sums[i] = weight * (pi[i] + tau);
            differences[i] = weight * (pi[i] - tau);
            pi_before[i] = pi[i];
            pi[i] = s + growth * t;
        }
        store_first<kAnglesPerTile>(sums, plus);
        store_first<kAnglesPerTile>(differences, minus);
    }
}

// Calls visit(angle, first column, registers of sums) for real and imaginary parts of the same
// spheres together. Spheres of a block differ in size: columns end with their own last order.
template <typename Scalar>
template <typename Visit>
void AngularFunctionsOf<Scalar>::visit_amplitudes(const Matrix& functions,
                                                  const SphereBlockOf<Scalar>& block,
                                                  const Waves& waves, const Visit& visit) const {
    constexpr int whole = kRegisterSize<Scalar>;
    const std::ptrdiff_t stride = waves.outerStride();
    const auto visit_columns = [&]<bool kHalves>(int column, int width) {
        math::interruption_point();
        const auto [first, last] = block.orders_of(column, width);
        const int count = last - first + 1;
        const Scalar* start = waves.data() + first * stride + column;
        const auto [columns, step] =
            close_together(WaveColumns<Scalar, kHalves>{start, start + block.imaginary}, stride,
                           count, tile_count());
        for (int tile = 0; tile < tile_count(); ++tile) {
            const int first_angle = tile * kAnglesPerTile, angles = angles_in(tile);
            visit_angles(angles, of_tile(functions, tile, first), columns, step, count,
                         [&](int angle, const auto& sums) {
                             if (angle < angles) visit(first_angle + angle, column, sums);
                         });
        }
    };
    int column = 0;
    for (; column + whole <= block.size; column += whole)
        visit_columns.template operator()<false>(column, whole);
    // Sizes come in eights: half a register of sixteen.
    if (column < block.size) visit_columns.template operator()<true>(column, block.size - column);
}

template <typename Scalar>
void AngularFunctionsOf<Scalar>::add_intensity(const SphereBlockOf<Scalar>& block,
                                               Eigen::VectorXd& intensity) const {
    const auto add = [&](int angle, int, const auto& sums) {
        auto square = sums[0] * sums[0];
        if constexpr (std::extent_v < std::remove_reference_t < decltype(sums) >>> 1)
            square += sums[1] * sums[1];
        double whole = 0;
        for (int i = 0; i < kRegisterSize<Scalar>; ++i) whole += square[i];
        intensity[angle] += whole;
    };
    visit_amplitudes(plus_, block, block.U, add);
    visit_amplitudes(minus_, block, block.V, add);
}

template <typename Scalar>
void AngularFunctionsOf<Scalar>::add_intensity(const SphereBlockOf<Scalar>& block,
                                               const Eigen::Ref<const Factors>& factors,
                                               Eigen::VectorXd& intensity) const {
    const auto add = [&](int angle, int column, const auto& sums) {
        constexpr bool is_half = std::extent_v<std::remove_reference_t<decltype(sums)>> == 1;
        auto square = sums[0] * sums[0];
        if constexpr (!is_half) square += sums[1] * sums[1];
        constexpr int columns = is_half ? kRegisterSize<Scalar> / 2 : kRegisterSize<Scalar>;
        const Scalar* factor = factors.data() + angle * factors.outerStride() + column;
        double whole = 0;
        for (int i = 0; i < kRegisterSize<Scalar>; ++i) whole += square[i] * factor[i % columns];
        intensity[angle] += whole;
    };
    visit_amplitudes(plus_, block, block.U, add);
    visit_amplitudes(minus_, block, block.V, add);
}

// Row = angle, columns as those of the waves.
template <typename Scalar>
typename AngularFunctionsOf<Scalar>::Waves AngularFunctionsOf<Scalar>::amplitudes(
    const Matrix& functions, const SphereBlockOf<Scalar>& block, const Waves& waves) const {
    Waves result(angle_count_, 2 * block.size);
    visit_amplitudes(functions, block, waves, [&](int angle, int column, const auto& sums) {
        Scalar* real = result.row(angle).data() + column;
        Scalar* imaginary = real + block.size;
        constexpr std::size_t part = sizeof(sums) / 2;
        const char* from = reinterpret_cast<const char*>(&sums);
        std::memcpy(real, from, part);
        std::memcpy(imaginary, from + part, part);
    });
    return result;
}

template <typename Scalar>
void AngularFunctionsOf<Scalar>::add_forms(double weight, const TriangularForm<Scalar>& plus,
                                           const TriangularForm<Scalar>& minus, int first,
                                           Eigen::VectorXd& intensity) const {
    constexpr int half = kRegisterSize<Scalar>, piece = 2 * half;
    const auto add = [&](const Matrix& functions, const TriangularForm<Scalar>& form) {
        for (int column = 0; column < form.count(); column += piece) {
            math::interruption_point();
            const Scalar* start = form.row(column) + column;
            const int columns = std::min(piece, form.count() - column);
            const int count = form.count() - column;
            const auto [waves, step] =
                close_together(WaveColumns<Scalar, false>{start, start + half}, form.row_size(),
                               count, tile_count());
            for (int tile = 0; tile < tile_count(); ++tile) {
                const int first_angle = tile * kAnglesPerTile, angles = angles_in(tile);
                const Scalar* own = of_tile(functions, tile, first + column);
                visit_angles(angles, own, waves, step, count, [&](int angle, const auto& sums) {
                    if (angle >= angles) return;
                    double whole = 0;
                    for (int m = 0; m < columns; ++m)
                        whole += sums[m / half][m % half] * own[m * kAnglesPerTile + angle];
                    intensity[first_angle + angle] += weight * whole;
                });
            }
        }
    };
    add(plus_, plus);
    add(minus_, minus);
}

template <typename Scalar>
typename AngularFunctionsOf<Scalar>::Amplitudes AngularFunctionsOf<Scalar>::amplitudes(
    const SphereBlockOf<Scalar>& block) const {
    return {amplitudes(plus_, block, block.U), amplitudes(minus_, block, block.V)};
}

template <typename Scalar>
void AngularFunctionsOf<Scalar>::add_products(
    const Amplitudes& one, const Amplitudes& other,
    const Eigen::Array<Scalar, 1, Eigen::Dynamic>& factors, Eigen::ArrayXXd& products) {
    const Eigen::Index size = one.sum.cols() / 2;
    const auto dot = [&](const Waves& a, Eigen::Index of_a, const Waves& b, Eigen::Index of_b) {
        const auto product = a.middleCols(of_a, size).cwiseProduct(b.middleCols(of_b, size));
        Eigen::Array<Scalar, Eigen::Dynamic, 1> sums;
        if (factors.size() == 0) {
            sums = product.rowwise().sum();
        } else {
            sums = product * factors.matrix().transpose();
        }
        return sums.template cast<double>().eval();
    };
    const auto real = [&](const Waves& a, const Waves& b) -> Eigen::ArrayXd {
        return dot(a, 0, b, 0) + dot(a, size, b, size);
    };
    products.col(0) += real(one.sum, other.sum);
    products.col(1) += real(one.difference, other.difference);
    if (products.cols() == 2) return;
    products.col(2) += real(one.sum, other.difference);
    products.col(3) +=
        dot(one.sum, size, other.difference, 0) - dot(one.sum, 0, other.difference, size);
}

template <typename Scalar>
void AngularFunctionsOf<Scalar>::add_products(const SphereBlockOf<Scalar>& block,
                                              Eigen::ArrayXXd& products) const {
    const Amplitudes own = amplitudes(block);
    add_products(own, own, {}, products);
}

template class AngularFunctionsOf<float>;
template class AngularFunctionsOf<double>;

AngularTables angular_tables(const Eigen::ArrayXd& cosines, int terms, bool single_precision,
                             const Executor& run) {
    if (single_precision) return AngularFunctionsOf<float>(cosines, terms, run);
    return AngularFunctions(cosines, terms, run);
}

WeightedSizes::WeightedSizes(const SizeNodes& nodes, double wave_number_per_um) {
    for (std::size_t i = 0; i < nodes.radius_um.size(); ++i) {
        const double x = wave_number_per_um * nodes.radius_um[i];
        parameters.push_back(x);
        weights.push_back(nodes.area_share[i] / x / x);
    }
}

SizeChunks::SizeChunks(int size_count, int most)
    : size_count_(size_count), count_(std::clamp(size_count / kLeast, 1, most)) {
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
    every_other.add(other.every_other);
    doubt += other.doubt;
    if (covariance.width() >= 0) covariance.add(other.covariance);
    if (intensity.size() > 0) intensity += other.intensity;
    if (other.products.rows() > products.rows()) {
        const Eigen::Index before = products.rows();
        products.conservativeResize(other.products.rows(), other.products.cols());
        products.bottomRows(products.rows() - before).setZero();
    }
    if (other.products.size() > 0) products.topRows(other.products.rows()) += other.products;
}

void SizeSums::scale(double factor) {
    spheres.scale(factor);
    every_other.scale(factor);
    doubt *= factor;
    covariance.scale(factor);
    intensity *= factor;
    products *= factor;
}

SizeSums sum_over_sizes(const Scatterer& scatterer, const WeightedSizes& sizes,
                        const SizeSumOptions& options, const Executor& run) {
    const int count = static_cast<int>(sizes.parameters.size());
    const SizeChunks chunks(count, most_chunks(count, options));
    const bool in_single = options.angles ? is_single(*options.angles) : options.single_precision;
    std::vector<SizeSums> parts(chunks.count());
    run(chunks.count(), [&](int job) {
        const int chunk = chunk_of_job(job, chunks.count());
        const auto blocks = chunks.blocks(chunk);
        parts[chunk] = in_single ? sum_over_blocks<float>(scatterer, sizes, options, blocks)
                                 : sum_over_blocks<double>(scatterer, sizes, options, blocks);
    });
    SizeSums total = std::move(parts[0]);
    for (int chunk = 1; chunk < chunks.count(); ++chunk) total.add(parts[chunk]);
    return total;
}

}  // namespace miebrdf::mie
