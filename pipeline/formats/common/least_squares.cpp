#include "pipeline/formats/common/least_squares.h"

#include <algorithm>

#include <miebrdf/error.h>
#include "rte/math/matrices.h"

namespace miebrdf {
namespace {

Eigen::MatrixXd slopes_at(const BoundedSearch& search, const std::vector<double>& numbers,
                          const Eigen::VectorXd& here) {
    Eigen::MatrixXd slopes(here.size(), Eigen::Index(numbers.size()));
    for (std::size_t u = 0; u < numbers.size(); ++u) {
        std::vector<double> moved = numbers;
        const bool is_high = numbers[u] + search.difference > search.high[u];
        moved[u] += is_high ? -search.difference : search.difference;
        slopes.col(Eigen::Index(u)) = (search.residuals(moved) - here) / (moved[u] - numbers[u]);
    }
    return slopes;
}

/// Numbers that are at a bound and drawn beyond it stay there and out of the equations: the others
/// would move for a change that does not happen.
std::vector<double> moved_by(const BoundedSearch& search, std::vector<double> numbers,
                             const Eigen::MatrixXd& slopes, const Eigen::VectorXd& here,
                             double damping) {
    const Eigen::VectorXd gradient = slopes.transpose().lazyProduct(here);
    std::vector<Eigen::Index> moving;
    for (std::size_t u = 0; u < numbers.size(); ++u) {
        const bool is_held = gradient[Eigen::Index(u)] > 0.0 ? numbers[u] <= search.low[u]
                                                             : numbers[u] >= search.high[u];
        if (!is_held) moving.push_back(Eigen::Index(u));
    }
    const Eigen::MatrixXd of_moving = slopes(Eigen::all, moving);
    Eigen::MatrixXd normal = of_moving.transpose() * of_moving, inverse;
    normal.diagonal() *= 1.0 + damping;
    normal.diagonal().array() += 1e-12;
    if (moving.empty() || !math::invert_positive_definite(normal, inverse)) return numbers;
    const Eigen::VectorXd uphill = gradient(moving), change = inverse.lazyProduct(uphill);
    for (std::size_t m = 0; m < moving.size(); ++m) {
        const auto u = std::size_t(moving[m]);
        numbers[u] =
            std::clamp(numbers[u] - change[Eigen::Index(m)], search.low[u], search.high[u]);
    }
    return numbers;
}

}  // namespace

double improve(const BoundedSearch& search, std::vector<double>& numbers, int most_steps,
               const Control& control) {
    constexpr int kAttempts = 10;
    Eigen::VectorXd here = search.residuals(numbers);
    double damping = 1.0;
    for (int step = 0; step < most_steps; ++step) {
        if (control.is_cancelled && control.is_cancelled()) throw Cancelled();
        const double before = here.squaredNorm();
        const Eigen::MatrixXd slopes = slopes_at(search, numbers, here);
        bool better = false;
        for (int attempt = 0; attempt < kAttempts && !better; ++attempt) {
            std::vector<double> moved = moved_by(search, numbers, slopes, here, damping);
            Eigen::VectorXd there = search.residuals(moved);
            better = there.squaredNorm() < before;
            damping = std::max(better ? damping / 5.0 : damping * 5.0, 1e-9);
            if (!better) continue;
            numbers.swap(moved);
            here.swap(there);
        }
        if (!better || here.squaredNorm() > (1.0 - search.done) * before) break;
    }
    return here.squaredNorm();
}

}  // namespace miebrdf
