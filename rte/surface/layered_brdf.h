// The complete BRDF: surface lobe plus what it lets through of the layers below.
#pragma once

#include "rte/boundary/boundary.h"
#include "rte/surface/surface_lobe.h"

namespace miebrdf::rte {

/// How much of the subsurface BRDF R / pi is seen through the surface:
///     f = R_s + in(mu_in) out(mu_out) R / pi.
///
/// `paper`, Chen et al. 2013, eq. (5): in = 1 - rho, out = 1. Every incidence reflects
/// rho + (1 - rho) A, A being the layers' plane albedo, but f is not reciprocal.
/// `reciprocal`: in = 1 - rho(mu_in), out = (1 - rho(mu_out)) / T with T = 2 integral of
/// (1 - rho) mu dmu (Kelemen & Szirmay-Kalos 2001). For Lambertian layers of albedo A every
/// incidence again reflects rho + (1 - rho) A; for other layers the mean over a diffuse
/// illumination may differ from the paper's, up to max(1 - rho) / T (docs/maths-surface.md).
class SurfaceTransmission {
  public:
    SurfaceTransmission(const SurfaceLobe& lobe, SurfaceCoupling coupling);

    /// @param mu  in (0, 1]
    double in(double mu) const;
    double out(double mu) const;
    BoundaryWeights weights(double mu) const;  ///< both, from one rho

  private:
    SurfaceLobe lobe_;
    SurfaceCoupling coupling_;
    double mean_transmittance_ = 1.0;
};

/// f at one pair of directions, in 1/sr. For tables keep a SurfaceTransmission: each of its
/// factors is an integral that many pairs share.
/// @param reflection  R of the layers at these directions; a white Lambertian has R = 1
double complete_brdf(const SurfaceLobe& lobe, const SurfaceTransmission& transmission, double mu_in,
                     double mu_out, double azimuth_deg, double reflection);

}  // namespace miebrdf::rte
