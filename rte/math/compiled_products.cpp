#include "rte/math/compiled_products.h"

namespace miebrdf::math {
namespace {

using Target = Eigen::Map<Eigen::MatrixXd, 0, Eigen::OuterStride<>>;

// compute(A, B) with the types of how the factors are stored.
template <typename Compute>
void for_storage(const Factor& A, const Factor& B, const Compute& compute) {
    const auto with_left = [&](const auto& left) {
        const Eigen::OuterStride<> stride(B.stride);
        if (B.by_rows) return compute(left, FactorByRows(B.data, B.rows, B.cols, stride));
        return compute(left, FactorByColumns(B.data, B.rows, B.cols, stride));
    };
    const Eigen::OuterStride<> stride(A.stride);
    if (A.by_rows) return with_left(FactorByRows(A.data, A.rows, A.cols, stride));
    return with_left(FactorByColumns(A.data, A.rows, A.cols, stride));
}

}  // namespace

void set_product(double scale, const Factor& A, const Factor& B, ProductTarget target) {
    Target result(target.data, A.rows, B.cols, Eigen::OuterStride<>(target.stride));
    for_storage(A, B, [&](const auto& left, const auto& right) {
        result.noalias() = scale * left * right;
    });
}

void add_product(double scale, const Factor& A, const Factor& B, ProductTarget target) {
    Target result(target.data, A.rows, B.cols, Eigen::OuterStride<>(target.stride));
    for_storage(A, B, [&](const auto& left, const auto& right) {
        result.noalias() += scale * left * right;
    });
}

}  // namespace miebrdf::math
