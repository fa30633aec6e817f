// How light meets a rough surface: the choices that a microfacet model leaves open.
#pragma once

#include <optional>

namespace miebrdf::rte {

/// Density of the normals of the small mirrors that make up the surface.
enum class MicrofacetDistribution {
    beckmann,  ///< slopes are Gaussian (Beckmann & Spizzichino 1963)
    ggx,       ///< longer tails (Trowbridge & Reitz 1975; Walter et al. 2007)
};

/// Which share of the mirrors is lit and seen.
enum class Shadowing {
    smith_correlated,  ///< G = 1 / (1 + Lambda_in + Lambda_out): heights of both rays correlate
    smith_separable,   ///< G = G1(in) G1(out), G1 = 1 / (1 + Lambda)
    v_cavity,          ///< Torrance & Sparrow 1967: long symmetric grooves
};

enum class FresnelKind {
    exact,    ///< unpolarised Fresnel reflectance of n + ik
    schlick,  ///< Schlick 1994 with the exact reflectance at normal incidence
};

/// How the layers below are weakened by what the surface reflects (rte/surface/layered_brdf.h).
enum class SurfaceCoupling {
    paper,       ///< 1 - rho(mu_in): Chen et al. 2013, eq. (5); not reciprocal
    reciprocal,  ///< (1 - rho(mu_in)) (1 - rho(mu_out)), normalised
};

struct SurfaceOptions {
    double beckmann_alpha = 0.3;  ///< slope parameter of the distribution, in [1e-4, 4]
    MicrofacetDistribution distribution = MicrofacetDistribution::beckmann;
    Shadowing shadowing = Shadowing::smith_correlated;
    FresnelKind fresnel = FresnelKind::exact;
    /// Whose Lambda the Smith forms use. Empty: that of `distribution`, the only choice for which
    /// the visible mirrors add up to the surface that is seen.
    std::optional<MicrofacetDistribution> shadowing_distribution = {};
};

/// @throws std::invalid_argument  for a slope parameter out of range, with its value
void validate(const SurfaceOptions& options);

}  // namespace miebrdf::rte
