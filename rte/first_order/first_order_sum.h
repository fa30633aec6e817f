// The first order of scattering at all directions of a request, for one discretisation after the
// other.
#pragma once

#include <vector>

#include "rte/first_order/single_scattering.h"
#include "rte/stack/layered_reflection.h"

namespace miebrdf::rte {

/// Adds what is scattered once: exactly (TMS), or as the discrete equations see it.
///
/// Exact phase functions do not depend on the number of nodes: they are evaluated once, at the
/// first call, and kept (8 bytes for each medium and direction).
class FirstOrderSum {
  public:
    /// @param directions  must outlive this
    FirstOrderSum(const Directions& directions, const SolverOptions& options);

    /// @param media       of the same stack at every call; delta-M may differ
    /// @param reflection  in the order of ReflectionTable
    void add_to(std::vector<double>& reflection, const std::vector<ScaledMedium>& media);

  private:
    void add_narrow_features(std::vector<double>& reflection,
                             const std::vector<ScaledMedium>& media) const;
    /// Exact P of each medium at each direction: phase_[medium * directions + direction].
    void evaluate_phase(const std::vector<ScaledMedium>& media);

    const Directions& directions_;
    SolverOptions options_;
    std::vector<double> cos_azimuth_;
    std::vector<double> phase_;
};

}  // namespace miebrdf::rte
