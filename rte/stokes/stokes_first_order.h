// Polarised light scattered exactly once: the scattering matrix between the meridian planes.
#pragma once

#include <Eigen/Core>
#include <vector>

#include <miebrdf/solver.h>
#include "rte/phase/scaled_medium.h"

namespace miebrdf::rte {

/// F turned from the plane of scattering to the meridian planes of both rays, 4 x 4: light that
/// comes down at mu_in and goes up at mu_out. Of light that goes back where it came from, and of
/// vertical rays, the limit at this azimuth.
Eigen::Matrix4d turned_to_meridians(const ScatteringMatrix& matrix, double mu_in, double mu_out,
                                    double azimuth_deg);

/// The same of light that comes down and goes on downwards. Of light scattered upside down, coming
/// up at mu_in, both are D M D, D = diag(1, 1, -1, -1).
Eigen::Matrix4d turned_forward(const ScatteringMatrix& matrix, double mu_in, double mu_out,
                               double azimuth_deg);

/// The medium that the discrete equations see, as one whose coefficients are all of it.
Optics as_seen_by_equations(const ScaledMedium& medium);

/// The media whose scattering matrices are those of light scattered once: the media themselves
/// (exact, TMS), or what the discrete equations see of them.
std::vector<Optics> media_of_first_order(const std::vector<ScaledMedium>& media, bool exact);

/// Light scattered once at one pair of directions, 4 x 4, without what NarrowFeatures corrects.
/// @param optics  media_of_first_order(media, exact)
Eigen::Matrix4d scattered_once(const std::vector<ScaledMedium>& media,
                               const std::vector<Optics>& optics, double mu_in, double mu_out,
                               double azimuth_deg);

/// Adds what is scattered once to Mueller matrices, as FirstOrderSum does to numbers: exact
/// matrices (TMS), evaluated at the first call and kept (8 c^2 bytes for each medium and
/// direction), or those of the discrete equations.
class StokesFirstOrder {
  public:
    /// @param directions  must outlive this
    StokesFirstOrder(const Directions& directions, int components, const SolverOptions& options);

    /// @param media       of the same stack at every call; delta-M may differ
    /// @param reflection  [((in * outs + out) * c^2 + row * c + column) * azimuths + azimuth]
    void add_to(std::vector<double>& reflection, const std::vector<ScaledMedium>& media);

  private:
    /// Of every medium at every direction, in the order of `reflection`.
    std::vector<double> turned(const std::vector<Optics>& media) const;
    void add_narrow_features(std::vector<double>& first_order,
                             const std::vector<ScaledMedium>& media) const;

    const Directions& directions_;
    int components_;
    SolverOptions options_;
    std::vector<double> exact_;
};

}  // namespace miebrdf::rte
