#include "rte/math/compiled_products.h"

namespace miebrdf::math {
namespace {

using Target = Eigen::Map<Eigen::MatrixXd, 0, Eigen::OuterStride<>>;

// compute(A, B) with the types of how the factors are stored.
template <typename Compute>
void for_storage(const Factor& A, const Factor& B, const Compute& compute) {
    const auto with_left = [&](const auto& left) {
        const FactorStride stride(B.stride, 1);
        if (B.by_rows) return compute(left, FactorByRows(B.data, B.rows, B.cols, stride));
        return compute(left, FactorByColumns(B.data, B.rows, B.cols, stride));
    };
    const FactorStride stride(A.stride, 1);
    if (A.by_rows) return with_left(FactorByRows(A.data, A.rows, A.cols, stride));
    return with_left(FactorByColumns(A.data, A.rows, A.cols, stride));
}

// A single row of numbers that lie side by side, as of one requested cosine: Eigen copies what it
// does not know at compile time to be a vector.
bool is_one_row(const Factor& A, ProductTarget target) {
    return A.rows == 1 && (A.by_rows || A.stride == 1) && target.stride == 1;
}

template <typename Compute>
void for_one_row(const Factor& A, const Factor& B, ProductTarget target, const Compute& compute) {
    const Eigen::Map<const Eigen::VectorXd> row(A.data, A.cols);
    Eigen::Map<Eigen::VectorXd> result(target.data, B.cols);
    const FactorStride stride(B.stride, 1);
    if (B.by_rows) {
        compute(result, FactorByRows(B.data, B.rows, B.cols, stride).transpose(), row);
    } else {
        compute(result, FactorByColumns(B.data, B.rows, B.cols, stride).transpose(), row);
    }
}

}  // namespace

void set_product(double scale, const Factor& A, const Factor& B, ProductTarget target) {
    if (is_one_row(A, target)) {
        for_one_row(A, B, target, [scale](auto& result, const auto& left, const auto& right) {
            result.noalias() = scale * left * right;
        });
        return;
    }
    Target result(target.data, A.rows, B.cols, Eigen::OuterStride<>(target.stride));
    for_storage(A, B, [&](const auto& left, const auto& right) {
        result.noalias() = scale * left * right;
    });
}

void add_product(double scale, const Factor& A, const Factor& B, ProductTarget target) {
    if (is_one_row(A, target)) {
        for_one_row(A, B, target, [scale](auto& result, const auto& left, const auto& right) {
            result.noalias() += scale * left * right;
        });
        return;
    }
    Target result(target.data, A.rows, B.cols, Eigen::OuterStride<>(target.stride));
    for_storage(A, B, [&](const auto& left, const auto& right) {
        result.noalias() += scale * left * right;
    });
}

}  // namespace miebrdf::math
