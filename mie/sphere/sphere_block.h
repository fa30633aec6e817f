// Mie coefficients of many spheres of one index at once, for averages over sizes.
#pragma once

#include <Eigen/Core>
#include <cstddef>
#include <span>
#include <vector>

#include "mie/sphere/scatterer.h"

namespace miebrdf::mie {

/// U_n = a_n + b_n and V_n = a_n - b_n of `size` spheres, each times the root of its weight.
/// Row n = order (row 0 unused), columns [0, size) the real, [imaginary, imaginary + size) the
/// imaginary parts. `size` is the number of spheres rounded up to whole vectors; the rest have
/// weight 0. Both parts of a row begin with a line of the cache.
/// Scalar: double, or float (half the memory traffic, products twice as fast).
template <typename Scalar>
struct SphereBlockOf {
    using Matrix = Eigen::Matrix<Scalar, Eigen::Dynamic, Eigen::Dynamic, Eigen::RowMajor>;
    /// Numbers in the widest register of any machine, and in a line of its cache.
    static constexpr int kWidest = 64 / static_cast<int>(sizeof(Scalar));
    Matrix U, V;
    int size = 0;
    int imaginary = 0;
    int terms = 0;
    struct Orders {
        int first, last;
    };
    /// Rows of each eight columns [8 i, 8 i + 8) and their imaginary parts: those below and above
    /// are zero, or too little to count.
    std::vector<Orders> orders;

    /// Makes room, and lets all columns have all orders; memory grows, and is reused while the
    /// number of spheres stays. Rows may be more than terms + 1.
    void make_room(int terms, int size);

    /// Rows of all columns [first_column, first_column + count), and of those that the widest
    /// register of any machine holds together with them: what is too little to count is then the
    /// same whatever the width of vectors.
    Orders orders_of(int first_column, int count) const;
};

using SphereBlock = SphereBlockOf<double>;

/// Sums over spheres s with weights w_s of a block; all terms are positive but for the last.
struct SphereSums {
    double scattered = 0;   ///< sum w_s sum_n (2n+1) (|a_n|^2 + |b_n|^2) = sum w_s x_s^2 Q_sca / 2
    double absorbed = 0;    ///< the same with Re a_n - |a_n|^2; exactly 0 for a real index
    double asymmetric = 0;  ///< sum w_s x_s^2 Q_sca g / 4

    void add(const SphereSums& other);
    void scale(double factor);
};

/// Computes the coefficients of all sizes, eight at a time in one vector, by the formulas of
/// mie_coefficients without its care for small spheres: those below x = 2 take that path.
///
/// Relative error of the sums below 1e-11 (measured against mie_coefficients).
///
/// @param size_parameters  ascending, at least one
/// @param weights  one per size, >= 0
/// @param block    U and V are filled when not null
/// @param every_other  when not null, the sums over the first, third, ... size are added to it
template <typename Scalar>
SphereSums compute_spheres(const Scatterer& scatterer, std::span<const double> size_parameters,
                           std::span<const double> weights, SphereBlockOf<Scalar>* block,
                           SphereSums* every_other = nullptr);

/// The sums alone.
SphereSums compute_spheres(const Scatterer& scatterer, std::span<const double> size_parameters,
                           std::span<const double> weights, std::nullptr_t = nullptr);

}  // namespace miebrdf::mie
