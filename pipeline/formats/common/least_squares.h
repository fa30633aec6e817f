// Levenberg and Marquardt's least squares between bounds: models of few numbers in place of a BRDF.
#pragma once

#include <Eigen/Core>
#include <functional>
#include <vector>

#include <miebrdf/control.h>

namespace miebrdf {

struct BoundedSearch {
    std::vector<double> low, high;  ///< of each number
    std::function<Eigen::VectorXd(const std::vector<double>& numbers)> residuals;
    double difference;  ///< by which slopes are taken: large against the noise of the residuals
    double done;        ///< a step that takes off less of the sum of squares is the last one
};

/// Improves the numbers by so many steps or fewer; the sum of squares that is left.
/// @throws Cancelled
double improve(const BoundedSearch& search, std::vector<double>& numbers, int most_steps,
               const Control& control);

}  // namespace miebrdf
