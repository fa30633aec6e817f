#include "rte/math/matrix_series.h"

#include <algorithm>

#include "rte/math/wigner.h"

namespace miebrdf::math {
namespace {

/// Nodes whose functions stay in the cache together.
constexpr int kNodesAtOnce = 64;

}  // namespace

// Half the integral of each column times its d^l_mn.
Eigen::MatrixXd matrix_series(Eigen::MatrixXd values, const Quadrature& rule, int degree) {
    constexpr struct {
        int m, n, column, columns;
    } kFamilies[] = {{0, 0, 0, 2}, {2, 2, 2, 1}, {2, -2, 3, 1}, {0, 2, 4, 2}};
    const bool is_matrix = values.cols() > 1;
    const auto count = static_cast<Eigen::Index>(rule.nodes.size());
    const Eigen::Map<const Eigen::VectorXd> x(rule.nodes.data(), count);
    values.array().colwise() *= Eigen::Map<const Eigen::ArrayXd>(rule.weights.data(), count);
    Eigen::MatrixXd result = Eigen::MatrixXd::Zero(degree + 1, values.cols());
    Eigen::MatrixXd functions;
    for (Eigen::Index first = 0; first < count; first += kNodesAtOnce) {
        const Eigen::Index here = std::min<Eigen::Index>(kNodesAtOnce, count - first);
        for (const auto [m, n, column, columns] : kFamilies) {
            if (column > 0 && !is_matrix) break;
            const Eigen::Index wide = is_matrix ? columns : 1;
            wigner_functions(m, n, degree + 1, x.segment(first, here), functions);
            if (functions.cols() == 0) continue;
            result.block(degree + 1 - functions.cols(), column, functions.cols(), wide).noalias() +=
                functions.transpose() * values.block(first, column, here, wide);
        }
    }
    result *= 0.5;
    if (!is_matrix) return result;
    const Eigen::VectorXd sum = result.col(2), difference = result.col(3);
    result.col(2) = 0.5 * (sum + difference);
    result.col(3) = 0.5 * (sum - difference);
    return result;
}

}  // namespace miebrdf::math
