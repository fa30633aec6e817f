#include "tools/bench/photon_tracer.h"

#include <algorithm>
#include <cmath>

namespace miebrdf::bench {
namespace {

RayDirection operator*(double a, const RayDirection& b) { return {a * b.x, a * b.y, a * b.z}; }
RayDirection operator+(const RayDirection& a, const RayDirection& b) {
    return {a.x + b.x, a.y + b.y, a.z + b.z};
}
double dot(const RayDirection& a, const RayDirection& b) {
    return a.x * b.x + a.y * b.y + a.z * b.z;
}
RayDirection normalised(const RayDirection& d) { return 1 / std::sqrt(dot(d, d)) * d; }
RayDirection other_side_up(const RayDirection& d) { return {d.x, d.y, -d.z}; }

/// Smith's Lambda of GGX for a ray that rises (up > 0) or falls: Lambda(-w) = -1 - Lambda(w).
double lambda(double alpha, const RayDirection& d) {
    const double tan2 = (d.x * d.x + d.y * d.y) / (d.z * d.z);
    const double rising = (std::sqrt(1 + alpha * alpha * tan2) - 1) / 2;
    return d.z > 0 ? rising : -1 - rising;
}

/// Slope towards w of a facet of alpha 1 that is seen from w = (sine, cosine): its density is
/// (cosine + x sine) / (2 (1 + x^2)^(3/2)), whose integral f(x) = (cosine x - sine) /
/// (2 (1 + x^2)^(1/2)) is sin(phi - delta) / 2 with x = tan(phi).
double visible_slope(double sine, double cosine, double u) {
    const double r = std::hypot(sine, cosine);
    const double f = -r + u * (cosine + r);
    const double phi = std::atan2(sine, cosine) + std::asin(std::clamp(f / r, -1.0, 1.0));
    return std::tan(phi);
}

/// tan(psi), psi drawn from cos^2 between -pi/2 and pi/2: the other slope over (1 + x^2)^(1/2).
double slope_across(RandomStream& random) {
    for (;;) {
        const double psi = M_PI * (random.uniform() - 0.5);
        const double c = std::cos(psi);
        if (random.uniform() <= c * c) return std::tan(psi);
    }
}

/// Normal (z up) of a facet that is met by light from the direction w (z up, may point down).
RayDirection visible_normal(double alpha, const RayDirection& w, RandomStream& random) {
    const double sine = std::hypot(w.x, w.y);
    const double x = visible_slope(alpha * sine, w.z, random.uniform());
    const double y = slope_across(random) * std::sqrt(1 + x * x);
    // Towards w the surface falls: the normal leans towards it.
    const double c = sine > 0 ? w.x / sine : 1, s = sine > 0 ? w.y / sine : 0;
    return normalised({alpha * (x * c - y * s), alpha * (x * s + y * c), 1});
}

/// One facet: reflects or refracts a ray that arrives along d. True if it is refracted.
bool turn(double index, const RayDirection& normal, RayDirection& d, RandomStream& random) {
    const double cosine = std::max(0.0, -dot(normal, d));
    const FresnelRay ray = fresnel(index, cosine);
    if (random.uniform() < ray.reflectance) {
        d = normalised(d + 2 * cosine * normal);
        return false;
    }
    d = normalised(1 / index * d + (cosine / index - ray.cosine_behind) * normal);
    return true;
}

}  // namespace

FresnelRay fresnel(double index, double cosine) {
    const double sine2 = (1 - cosine) * (1 + cosine) / (index * index);
    if (sine2 >= 1) return {};
    const double behind = std::sqrt(1 - sine2);
    const double s = (cosine - index * behind) / (cosine + index * behind);
    const double p = (index * cosine - behind) / (index * cosine + behind);
    return {(s * s + p * p) / 2, behind};
}

BoundaryExit meet_boundary(const TracedBoundary& boundary, bool from_air, const RayDirection& ray,
                           RandomStream& random) {
    bool in_air = from_air;
    // Seen from the side on which the ray is: z points away from the boundary.
    RayDirection d = in_air ? other_side_up(ray) : ray;
    double height = 1;  // the share of the surface that lies lower
    for (;;) {
        const double index = in_air ? boundary.index : 1 / boundary.index;
        RayDirection normal{0, 0, 1};
        if (boundary.roughness > 0) {
            height /= std::pow(random.uniform(), 1 / lambda(boundary.roughness, d));
            if (height >= 1 && d.z > 0) break;
            normal = visible_normal(boundary.roughness, -1.0 * d, random);
        } else if (d.z > 0) {
            break;
        }
        if (turn(index, normal, d, random)) {
            d = other_side_up(d);
            height = 1 - height;
            in_air = !in_air;
        }
    }
    return {!in_air, in_air ? other_side_up(d) : d};
}

}  // namespace miebrdf::bench
