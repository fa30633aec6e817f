// Series of scattering matrices (rte/math/matrix_series.h) as results.
#pragma once

#include <Eigen/Core>

#include <miebrdf/ensemble.h>

namespace miebrdf::mie {

/// Sets moments and coefficients, of which a1_0 becomes 1 and the end that is rounding is cut off.
void put_series(const Eigen::MatrixXd& series, MatrixOptics& matrix);

}  // namespace miebrdf::mie
