// A ray at the boundary between air and a denser medium, smooth or rough: part of the photon
// tracer, without code or equations of rte/.
#pragma once

#include "tools/bench/random_stream.h"

namespace miebrdf::bench {

/// z points down, from air into the medium.
struct RayDirection {
    double x = 0.0, y = 0.0, z = 1.0;
};

/// Fresnel's reflectance of unpolarised light, and the cosine behind the boundary.
/// @param index  n + i 0 of what lies behind over what lies before
struct FresnelRay {
    double reflectance = 1.0;
    double cosine_behind = 0.0;  ///< 0 where all is reflected
};
FresnelRay fresnel(double index, double cosine);

/// The boundary between air and a medium.
struct TracedBoundary {
    double index = 1.0;      ///< of the medium, at least 1
    double roughness = 0.0;  ///< slope parameter alpha of GGX facets; 0: smooth

    bool is_there() const { return index != 1.0; }
};

struct BoundaryExit {
    bool into_medium = false;
    RayDirection direction;
};

/// Follows one ray that meets the boundary. A smooth one reflects or refracts it once. A rough
/// one is the random walk of Heitz, Hanika, d'Eon & Dachsbacher 2016 (ACM Trans. Graph. 35, 58):
/// free paths between facets by Smith's Lambda, facets by their visible area, until it leaves.
BoundaryExit meet_boundary(const TracedBoundary& boundary, bool from_air, const RayDirection& ray,
                           RandomStream& random);

}  // namespace miebrdf::bench
