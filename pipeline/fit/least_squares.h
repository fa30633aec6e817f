// Bounded nonlinear least squares, as the plug-in around Ceres solves them: the
// border between our code and that library.
#pragma once

#include <functional>
#include <limits>
#include <span>
#include <string>
#include <vector>

#include <miebrdf/fit.h>

namespace miebrdf::fitting {

struct LeastSquares {
    std::vector<double> start, low,
        high;  ///< of each unknown; start within the bounds
    std::size_t residuals = 0;
    /// Fills in the residuals at x and the Jacobian, row = residual, column = unknown. False where
    /// there are none (no such scene): the step is then tried shorter.
    std::function<bool(std::span<const double> x, std::span<double> residuals,
                       std::span<double> jacobian)>
        evaluate;
    FitLoss loss = FitLoss::squares;
    double loss_width = 2.0;
    int most_iterations = 50;
    /// A step that changes the sum of squares by no more than this share of it is the last: a
    /// thousandth of a sigma in each unknown is less than anybody reads.
    double least_gain = 1e-8;
    /// Called after each iteration; true ends the search.
    std::function<bool(int iteration)> is_enough = {};
};

struct Minimum {
    std::vector<double> x = {};  ///< the best so far where it has not converged
    std::vector<double> residuals = {}, jacobian = {};  ///< at x; empty: there were none
    double sum_of_squares = std::numeric_limits<double>::infinity();  ///< of the loss
    int iterations = 0;
    bool converged = false;
    std::string message = {};  ///< of the library
};

/// @throws UsageError  when the plug-in is missing
Minimum minimise(const LeastSquares& problem);

}  // namespace miebrdf::fitting
