// Directional reflectances of one rough surface for many refractive indices.
#pragma once

#include <Eigen/Core>
#include <complex>
#include <cstddef>
#include <vector>

#include <miebrdf/surface.h>

namespace miebrdf::rte {

/// The index is in Fresnel's reflectance alone, which is a smooth function of the cosine with the
/// facet: a polynomial, whose coefficients change with the index, and whose integrals over the
/// facets, made once, do not.
class ReflectanceTable {
  public:
    /// Takes about four times as long as directional_reflectance of each cosine.
    /// @param mu_in    each in (0, 1]
    /// @param indices  so many will be asked for; a few are not worth a table, and integrated
    /// @throws UsageError  for options or a cosine out of range
    ReflectanceTable(const SurfaceOptions& options, std::vector<double> mu_in, std::size_t indices);

    /// As directional_reflectance, of each cosine, to 1e-6. Where the bound on that is larger (a
    /// critical angle, below which the reflectance is not smooth), that is what computes it.
    std::vector<double> at(std::complex<double> refractive_index) const;

  private:
    SurfaceOptions options_;
    std::vector<double> mu_in_;
    Eigen::MatrixXd integrals_;     ///< of the polynomials, cosines x degrees; empty: no table
    Eigen::MatrixXd errors_;        ///< of each
    Eigen::MatrixXd coefficients_;  ///< of a reflectance, from its values at as many points
};

}  // namespace miebrdf::rte
