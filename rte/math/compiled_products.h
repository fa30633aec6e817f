// Products of matrices of doubles are compiled once, in compiled_products.cpp, and not for every
// expression that contains one: Eigen instantiates five ways to multiply for each pair of types
// (blocks, vectors of either kind, few elements), which takes the compiler about two seconds, and
// rte has two hundred such pairs. What is computed is the same, in the same order. Without this
// header all works as well, the build takes longer.
#pragma once

#include <Eigen/Core>
#include <concepts>

namespace miebrdf::math {

/// A matrix that a product reads: element (i, j) is data[i + j * stride], or data[i * stride + j]
/// where it is stored by rows.
struct Factor {
    const double* data;
    Eigen::Index rows, cols, stride;
    bool by_rows;

    Factor transposed() const { return {data, cols, rows, stride, !by_rows}; }
};

/// Where a product goes, stored by columns.
struct ProductTarget {
    double* data;
    Eigen::Index stride;
};

/// target = scale A B, and target += scale A B. A.cols = B.rows; the target is A.rows x B.cols and
/// overlaps neither.
void set_product(double scale, const Factor& A, const Factor& B, ProductTarget target);
void add_product(double scale, const Factor& A, const Factor& B, ProductTarget target);

/// A stride type that nothing else in the project uses: IsCompiledFactor tells these maps from
/// those of other code by it.
using FactorStride = Eigen::Stride<Eigen::Dynamic, 1>;
template <typename Stored>
using FactorMap = Eigen::Map<const Stored, 0, FactorStride>;
using FactorByColumns = FactorMap<Eigen::MatrixXd>;
using FactorByRows =
    FactorMap<Eigen::Matrix<double, Eigen::Dynamic, Eigen::Dynamic, Eigen::RowMajor>>;

/// Factors that are multiplied here: all but the factors of compiled_products.cpp itself.
template <typename Expression>
concept IsCompiledFactor =
    std::same_as<typename Expression::Scalar, double> &&
    !std::same_as<typename Eigen::internal::blas_traits<Expression>::_ExtractType,
                  FactorByColumns> &&
    !std::same_as<typename Eigen::internal::blas_traits<Expression>::_ExtractType, FactorByRows>;

template <typename Dense>
Factor factor_of(const Dense& matrix) {
    return {matrix.data(), matrix.rows(), matrix.cols(), matrix.outerStride(),
            bool(Dense::IsRowMajor)};
}

/// target = scale lhs rhs or target += scale lhs rhs, by one of the functions above. A factor that
/// is not stored (a sum, a product with a diagonal) is computed first, as Eigen does; factors of
/// -A, 2 * A and A^T are taken out.
template <auto product, typename Target, typename Lhs, typename Rhs>
void apply_product(Target& target, const Lhs& lhs, const Rhs& rhs, double scale) {
    using OfLhs = Eigen::internal::blas_traits<Lhs>;
    using OfRhs = Eigen::internal::blas_traits<Rhs>;
    const typename OfLhs::DirectLinearAccessType& left = OfLhs::extract(lhs);
    const typename OfRhs::DirectLinearAccessType& right = OfRhs::extract(rhs);
    const Factor A = factor_of(left), B = factor_of(right);
    scale = Eigen::internal::combine_scalar_factors(scale, lhs, rhs);
    if constexpr (!Eigen::internal::blas_traits<Target>::HasUsableDirectAccess ||
                  Eigen::internal::inner_stride_at_compile_time<Target>::ret != 1) {
        Eigen::MatrixXd stored = target;
        product(scale, A, B, {stored.data(), stored.outerStride()});
        target = stored;
    } else {
        const Factor result = factor_of(target);
        const ProductTarget place{target.data(), result.stride};
        if (result.by_rows) {  // (A B)^T = B^T A^T
            product(scale, B.transposed(), A.transposed(), place);
        } else {
            product(scale, A, B, place);
        }
    }
}

}  // namespace miebrdf::math

// Where Eigen itself looks how to multiply (3.4; later versions have other names).
#if EIGEN_WORLD_VERSION == 3 && EIGEN_MAJOR_VERSION == 4
namespace Eigen::internal {

template <miebrdf::math::IsCompiledFactor Lhs, miebrdf::math::IsCompiledFactor Rhs>
struct generic_product_impl<Lhs, Rhs, DenseShape, DenseShape, GemmProduct> {
    template <typename Target>
    static void evalTo(Target& target, const Lhs& lhs, const Rhs& rhs) {
        miebrdf::math::apply_product<miebrdf::math::set_product>(target, lhs, rhs, 1.0);
    }
    template <typename Target>
    static void addTo(Target& target, const Lhs& lhs, const Rhs& rhs) {
        scaleAndAddTo(target, lhs, rhs, 1.0);
    }
    template <typename Target>
    static void subTo(Target& target, const Lhs& lhs, const Rhs& rhs) {
        scaleAndAddTo(target, lhs, rhs, -1.0);
    }
    template <typename Target>
    static void scaleAndAddTo(Target& target, const Lhs& lhs, const Rhs& rhs, double scale) {
        miebrdf::math::apply_product<miebrdf::math::add_product>(target, lhs, rhs, scale);
    }
};

}  // namespace Eigen::internal
#endif
