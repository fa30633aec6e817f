// The search itself: one problem, from one or several starts to its minima.
#pragma once

#include <miebrdf/control.h>
#include <miebrdf/fit.h>

#include <optional>
#include <span>
#include <string>
#include <vector>

#include "pipeline/fit/model.h"

namespace miebrdf::fitting {

/// Values of the data beside the model's, with the weight 1 / sigma of each (1:
/// not known).
struct Target {
    std::vector<double> values, weights;
    /// Of each its correlation with the value before it, its neighbour in a spectrum; 0: none.
    std::vector<double> correlation;

    /// Differences of values, row by row, in sigmas, of which each is independent of the others:
    /// where neighbours are correlated, what the one does not tell of the next.
    void to_sigmas(std::span<double> rows) const;
    void from_sigmas(std::span<double> rows) const;
    std::vector<double> sigmas_off(const std::vector<double>& values) const;
};
Target target_of(const FitProblem& problem);

struct Search {
    std::vector<FitMinimum> minima = {};  ///< best first; numbers of the slots
    bool converged = false;               ///< the best one
    bool interrupted = false;
    std::string reason = {};
    /// The best point lies at the edge of what can be computed: nothing is certain about it.
    bool is_at_edge = false;
    std::vector<std::string> notes = {};  ///< about scenes that cannot be, and about other minima
    int iterations = 0;
    /// Of the model at the best minimum; where nothing was solved, values are NaN and derivatives
    /// empty.
    std::vector<double> values = {}, derivatives = {};
    double loss_width = 0.0;                   ///< in units of the weighted residuals
    std::optional<double> lattice_shift = {};  ///< FitResult::interpolation_shift
};

/// @throws UsageError, InputError  where the scene of the start cannot be
/// solved, with a start that can be
Search search(const FitProblem& problem, Model& model, const Target& target,
              const Control& control);

}  // namespace miebrdf::fitting
