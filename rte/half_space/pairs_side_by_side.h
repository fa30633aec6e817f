// Sums over nodes in several Fourier orders side by side: between requested cosines, and of one
// order.
#pragma once

#include "rte/grid/directions.h"
#include "rte/math/matrices_side_by_side.h"

#ifdef MIEBRDF_HAS_FOUR_DOUBLES

namespace miebrdf::rte {

/// pairs = A_o B_i^T or pairs += A_o B_i^T of the outgoing rows of A and the incident ones of B.
/// @param A, B      cosines x n, by columns
/// @param out, in   memory for as many elements of these rows
/// @param pairs     out x in, by columns
template <bool add, typename Doubles>
void multiply_pairs(const Doubles* A, const Doubles* B, int n, const RequestedDirections& requested,
                    Doubles* out, Doubles* in, Doubles* pairs) {
    const auto cosines = requested.mu.size();
    Doubles* to = out;
    for (int c = 0; c < n; ++c)
        for (const int row : requested.out) *to++ = A[row + c * cosines];
    to = in;
    for (const int row : requested.in)
        for (int c = 0; c < n; ++c) *to++ = B[row + c * cosines];
    math::multiply_each<add>(out, in, pairs, int(requested.out.size()), n,
                             int(requested.in.size()));
}

/// result += matrix times vector, of the first order alone.
/// @param matrix  result.size() x vector.size(), by columns
template <typename Doubles>
void add_first_order(const Doubles* matrix, const Eigen::VectorXd& vector,
                     Eigen::VectorXd& result) {
    for (const double value : vector)
        for (double& sum : result) sum += (*matrix++)[0] * value;
}

/// Divides by 4 (mu_out + mu_in).
template <typename Doubles>
void divide_by_cosines(const RequestedDirections& requested, Doubles* pairs) {
    for (const int i : requested.in)
        for (const int o : requested.out) *pairs++ /= 4.0 * (requested.mu[o] + requested.mu[i]);
}

}  // namespace miebrdf::rte

#endif
