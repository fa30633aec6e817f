// The half vector between light and view, and Beckmann's distribution of it.
#pragma once

namespace miebrdf::render {

struct HalfVector {
    double cos_normal;  ///< with the surface normal
    double cos_light;   ///< with either direction
};

/// From cosines and relative azimuth (1 = mirror side, where the half vector is the normal).
HalfVector half_vector(double mu_in, double mu_out, double cos_azimuth);

/// Beckmann's density of facet normals per solid angle, exp(-tan^2/alpha^2) / (pi alpha^2 cos^4):
/// its integral times the cosine over the hemisphere is 1.
double beckmann_density(double cos_normal, double alpha);

}  // namespace miebrdf::render
