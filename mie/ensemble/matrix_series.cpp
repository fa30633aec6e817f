#include "mie/ensemble/matrix_series.h"

#include <algorithm>
#include <limits>
#include <vector>

namespace miebrdf::mie {
void put_series(const Eigen::MatrixXd& series, MatrixOptics& matrix) {
    // Coefficients without 2l + 1 that are rounding of the sums are left out.
    const double rounding = 4 * std::numeric_limits<double>::epsilon() * series(0, 0);
    Eigen::Index count = series.rows();
    while (count > 1 && series.row(count - 1).cwiseAbs().maxCoeff() <= rounding) --count;
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
