// What the facets of a rough boundary do to light of one direction at their first meeting.
#pragma once

#include <span>
#include <vector>

#include <miebrdf/surface.h>

namespace miebrdf::rte {

/// The statistics of the facets of a boundary.
struct RoughSurface {
    double alpha = 0.3;  ///< slope parameter, in [1e-6, 1]
    MicrofacetDistribution distribution = MicrofacetDistribution::ggx;
};

/// Rays on one side of the boundary, each from facets of one slope.
struct ScatteredRays {
    std::vector<double> energy;       ///< share of the beam
    std::vector<double> mu;           ///< in [-1, 1], positive away from the boundary
    std::vector<double> cos_azimuth;  ///< 1 = straight on

    void add(double ray_energy, double ray_mu, double ray_cos_azimuth);
    double sum() const;  ///< of the energies
};

struct FacetScattering {
    ScatteredRays reflected;  ///< on the side that the beam came from
    ScatteredRays refracted;  ///< on the far side
};

/// A beam that meets a facet, and what becomes of it before it may meet another one: facets of the
/// slopes x (towards the light) and y are met in proportion to
///
///     P(x, y) max(0, mu + x sine) dx dy
///
/// and reflect F, by Fresnel's equations for the cosine with their normal. Walter et al. 2007;
/// Heitz et al. 2016. The energies of all rays add up to 1, or to 0 where no facet can be met.
///
/// Gauss nodes line by line between the curves on which a ray crosses a horizon, the critical angle
/// of the boundary as a whole (where Lagrange functions of RefractionGrid jump), or begins to be
/// totally reflected by the facet. All are conics in the slopes.
///
/// @param relative_index  n of the far side / n of the side that the light comes from
/// @param mu  cosine of the direction that the light comes from, in (-1, 1]; negative: it goes
///            away from the surface and is met all the same by a higher facet
/// @param refinement  scales the number of nodes
/// @param edges  further cosines in the denser medium where something jumps, each above 0
FacetScattering scatter_by_facets(double relative_index, const RoughSurface& surface, double mu,
                                  double refinement = 1.0, std::span<const double> edges = {});

/// Of these rays those that leave the boundary without meeting another facet. Heights of the facets
/// that a beam from mu > 0 meets and of those that would hide a ray are correlated; with Lambda of
/// both, these shares are seen:
///     reflected  (1 + in) / (1 + in + out),   refracted  (1 + in) B(1 + in, 1 + out),
/// B the beta function: the masking-shadowing functions of Smith (as in SurfaceLobe) and of Heitz
/// et al. 2016, over the visible share 1 / (1 + in).
FacetScattering unhidden(const FacetScattering& light, const RoughSurface& surface, double mu);

/// The same, and the others: rays that meet another facet.
struct FirstMeeting {
    FacetScattering leaving, hidden;
};
FirstMeeting split_by_facets(const FacetScattering& light, const RoughSurface& surface, double mu);

/// B(1 + in, 1 + out): the share of facets that are seen from both sides of the boundary, by the
/// light that meets them and in the direction into which they refract it.
double seen_from_both_sides(double one_plus_lambda, double beyond);

}  // namespace miebrdf::rte
