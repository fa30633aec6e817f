// Light that meets one facet of a rough boundary on each passage, pair of directions by pair: the
// lobe that is reflected at once, and the one that enters, comes back from mirrors below without
// being scattered, and leaves. Nodes see such lobes no better than they are far apart.
#pragma once

#include <Eigen/Core>
#include <functional>
#include <memory>
#include <vector>

#include <miebrdf/solver.h>
#include "rte/boundary/facet_scattering.h"
#include "rte/boundary/rough_boundary.h"
#include "rte/grid/directions.h"

namespace miebrdf::rte {

/// s for SurfaceLobe of the same distribution with correlated Smith shadowing: the light that does
/// not enter has the BRDF s(mu_in) s(mu_out) SurfaceLobe, whose integral is outer_reflectance. What
/// is reflected by several facets goes where one sends it.
class OuterLobeScale {
  public:
    explicit OuterLobeScale(std::shared_ptr<const RoughBoundary> boundary);
    Eigen::VectorXd at(const Eigen::VectorXd& mu_air) const;

  private:
    Eigen::VectorXd functions_at(double mu) const;
    Eigen::RowVectorXd sent_to_points(double mu_air) const;

    std::shared_ptr<const RoughBoundary> boundary_;
    Eigen::VectorXd scale_;  ///< at the points
};

/// Of light that a boundary lets in, what comes back below it without being scattered, by the
/// cosine in the medium.
using UnscatteredReturn = std::function<double(double mu)>;

/// The lobe through a rough boundary onto mirrors below it and back, one facet on each passage.
class MirroredLobe {
  public:
    MirroredLobe(double index, const RoughSurface& surface, UnscatteredReturn returned);

    /// Fourier orders within which the lobe falls to 1e-4 of the first: a passage turns light by
    /// (n - 1) times the slope of its facet, and GGX slopes of alpha give orders that fall like
    /// exp(-alpha (n - 1) m).
    int orders() const;
    /// The first of them: scale(mu) scale(mu') R^m of all pairs of directions. What is computed for
    /// each direction is where it enters, so that pairs cost a product of matrices.
    /// @param mu     in air
    /// @param scale  LightFromAir::compensation
    std::vector<Eigen::MatrixXd> by_order(const Eigen::VectorXd& mu, const Eigen::VectorXd& scale,
                                          int count) const;
    /// Adds scale(mu_in) scale(mu_out) R, laid out as a reflection: by orders, or ray by ray where
    /// that is less work.
    void add_to(std::vector<double>& reflection, const Directions& directions,
                const Eigen::VectorXd& scale_in, const Eigen::VectorXd& scale_out) const;

  private:
    /// What enters from one direction by one facet and returns, and how its cosines are hidden.
    struct Returning {
        std::vector<double> energy, mu, sine, cos_azimuth, sin_azimuth, one_plus_lambda;
    };
    /// A direction in air, as light that comes from there sees the facets.
    struct Leaving {
        double mu, sine, one_plus_lambda;
    };
    class Passage;

    Leaving towards(double mu_air) const;
    Returning entering(double mu_air) const;
    double leaving(const Returning& light, const Leaving& towards, double azimuth) const;
    void add_by_rays(std::vector<double>& reflection, const Directions& directions,
                     const Eigen::VectorXd& scale_in, const Eigen::VectorXd& scale_out) const;

    double index_;
    RoughSurface surface_;
    UnscatteredReturn returned_;
};

}  // namespace miebrdf::rte
