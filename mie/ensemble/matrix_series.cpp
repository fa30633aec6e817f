#include "mie/ensemble/matrix_series.h"

#include <algorithm>
#include <cmath>

#include "rte/math/wigner.h"

namespace miebrdf::mie {
namespace {

/// Nodes whose functions stay in the cache together.
constexpr int kNodesAtOnce = 64;
/// Coefficients without 2l + 1 that are rounding of the sums.
constexpr double kNegligible = 1e-15;

}  // namespace

// Rows l = 0 ... degree: (2l + 1)/2 times the integral of each column times its d^l_mn.
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
    for (int l = 0; l <= degree; ++l) result.row(l) *= l + 0.5;
    return result;
}

MatrixExpansion expansion_of(const Eigen::MatrixXd& rows) {
    MatrixExpansion e;
    for (Eigen::Index l = 0; l < rows.rows(); ++l) {
        e.a1.push_back(rows(l, 0));
        e.a4.push_back(rows(l, 1));
        e.a2.push_back(0.5 * (rows(l, 2) + rows(l, 3)));
        e.a3.push_back(0.5 * (rows(l, 2) - rows(l, 3)));
        e.b1.push_back(rows(l, 4));
        e.b2.push_back(rows(l, 5));
    }
    return e;
}

double largest_change(const MatrixExpansion& a, const MatrixExpansion& b) {
    double change = 0;
    for (const auto list : {&MatrixExpansion::a1, &MatrixExpansion::a2, &MatrixExpansion::a3,
                            &MatrixExpansion::a4, &MatrixExpansion::b1, &MatrixExpansion::b2}) {
        for (std::size_t l = 0; l < (a.*list).size(); ++l)
            change = std::max(change, std::abs((a.*list)[l] - (b.*list)[l]) / (2.0 * l + 1.0));
    }
    return change;
}

// Without the end that is rounding.
void trim(MatrixExpansion& e) {
    std::size_t size = e.a1.size();
    const auto is_negligible = [&](std::size_t l) {
        double largest = 0;
        for (const auto* list : {&e.a1, &e.a2, &e.a3, &e.a4, &e.b1, &e.b2})
            largest = std::max(largest, std::abs((*list)[l]));
        return largest <= kNegligible * (2.0 * l + 1.0);
    };
    while (size > 1 && is_negligible(size - 1)) --size;
    for (auto* list : {&e.a1, &e.a2, &e.a3, &e.a4, &e.b1, &e.b2}) list->resize(size);
}

}  // namespace miebrdf::mie
