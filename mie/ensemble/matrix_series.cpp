#include "mie/ensemble/matrix_series.h"

#include <algorithm>
#include <vector>

#include "rte/math/wigner.h"

namespace miebrdf::mie {
namespace {

/// Nodes whose functions stay in the cache together.
constexpr int kNodesAtOnce = 64;
/// Coefficients without 2l + 1 that are rounding of the sums.
constexpr double kNegligible = 1e-15;

}  // namespace

// Half the integral of each column times its d^l_mn.
Eigen::MatrixXd matrix_series(Eigen::MatrixXd values, const math::Quadrature& rule, int degree) {
    constexpr struct {
        int m, n, column, columns;
    } kFamilies[] = {{0, 0, 0, 2}, {2, 2, 2, 1}, {2, -2, 3, 1}, {0, 2, 4, 2}};
    const auto count = static_cast<Eigen::Index>(rule.nodes.size());
    const Eigen::Map<const Eigen::VectorXd> x(rule.nodes.data(), count);
    values.array().colwise() *= Eigen::Map<const Eigen::ArrayXd>(rule.weights.data(), count);
    Eigen::MatrixXd result = Eigen::MatrixXd::Zero(degree + 1, 6);
    Eigen::MatrixXd functions;
    for (Eigen::Index first = 0; first < count; first += kNodesAtOnce) {
        const Eigen::Index here = std::min<Eigen::Index>(kNodesAtOnce, count - first);
        for (const auto [m, n, column, columns] : kFamilies) {
            math::wigner_functions(m, n, degree + 1, x.segment(first, here), functions);
            if (functions.cols() == 0) continue;
            result.block(degree + 1 - functions.cols(), column, functions.cols(), columns)
                .noalias() += functions.transpose() * values.block(first, column, here, columns);
        }
    }
    result *= 0.5;
    const Eigen::VectorXd sum = result.col(2), difference = result.col(3);
    result.col(2) = 0.5 * (sum + difference);
    result.col(3) = 0.5 * (sum - difference);
    return result;
}

double series_change(const Eigen::MatrixXd& a, const Eigen::MatrixXd& b) {
    const Eigen::MatrixXd& longer = a.rows() > b.rows() ? a : b;
    const Eigen::Index common = std::min(a.rows(), b.rows());
    if (longer.rows() == 0) return 0;
    Eigen::MatrixXd change = longer;
    change.topRows(common) = a.topRows(common) - b.topRows(common);
    return change.cwiseAbs().maxCoeff();
}

void put_series(const Eigen::MatrixXd& series, MatrixOptics& matrix) {
    Eigen::Index count = series.rows();
    while (count > 1 && series.row(count - 1).cwiseAbs().maxCoeff() <= kNegligible * series(0, 0))
        --count;
    const Eigen::MatrixXd kept = series.topRows(count) / series(0, 0);
    const Eigen::ArrayXd two_l_1 = 2.0 * Eigen::ArrayXd::LinSpaced(count, 0, double(count - 1)) + 1;
    const auto list = [&](int column) {
        const Eigen::ArrayXd values = two_l_1 * kept.col(column).array();
        return std::vector<double>(values.begin(), values.end());
    };
    matrix.optics.chi.assign(kept.col(0).begin(), kept.col(0).end());
    matrix.expansion = {list(2), list(3), list(1), list(4), list(5)};
}

}  // namespace miebrdf::mie
