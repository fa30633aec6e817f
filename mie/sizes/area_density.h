// How the geometric cross-section of an ensemble is shared out over the radii.
#pragma once

#include <complex>

#include <miebrdf/sizes.h>

namespace miebrdf::mie {

/// Share of the geometric cross-section per micrometre of radius: n(r) r^2 over its integral.
class AreaDensity {
  public:
    /// @throws std::invalid_argument  as radius_range; and for mono, which has no density
    explicit AreaDensity(const SizeDistribution& distribution);
    double operator()(double radius_um) const;
    /// Its analytic continuation, for Re radius > 0; not for tabulated, which has none.
    std::complex<double> operator()(std::complex<double> radius_um) const;

  private:
    SizeDistribution distribution_;
    RadiusRange range_;
    double log_ratio_;
    double log_norm_ = 0;    ///< of the analytic continuation
    double table_area_ = 0;  ///< integral of n r^2 of a table
};

}  // namespace miebrdf::mie
