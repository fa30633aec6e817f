// The average over sizes: passes of more sizes until the error estimate is met.
#pragma once

#include <complex>
#include <optional>

#include "mie/ensemble/ensemble.h"
#include "mie/ensemble/moment_transform.h"
#include "mie/ensemble/size_sums.h"
#include "mie/sizes/size_refinement.h"
#include "mie/sphere/angular_functions.h"

namespace miebrdf::mie {

/// average_over_sizes at work.
class EnsembleAverage {
  public:
    /// Computes everything. @throws std::invalid_argument  as average_over_sizes
    EnsembleAverage(const EnsembleRequest& request, const Executor& run);

    const EnsembleOptics& optics() const { return optics_; }

  private:
    void start();
    void prepare_even_rule();
    int band_width() const;
    SizeSumOptions sum_options() const;
    void add_pass();
    EnsembleOptics optics_of(const SizeSums& sums) const;
    void estimate_errors(const EnsembleOptics& before);
    void put_exact_extinction();
    void tabulate_phase();

    EnsembleRequest request_;
    const Executor& run_;
    std::complex<double> relative_index_;
    double wave_number_per_um_;
    RadiusRange range_;
    double tail_ = 0;   // of the geometric cross-section, outside range_
    double share_ = 1;  // of it, inside
    int terms_ = 0;
    bool moments_from_table_ = false;
    AngularFunctions angular_;
    std::optional<MomentTransform> transform_;  // tables that all passes share
    std::optional<SizeRefinement> refinement_;
    SizeSums total_;  // all passes that count so far
    double change_before_ = 0, absorption_before_ = 0;
    bool exact_known_ = false;
    double exact_q_ext_ = 0;  // of the even rule
    EnsembleOptics optics_;
};

}  // namespace miebrdf::mie
