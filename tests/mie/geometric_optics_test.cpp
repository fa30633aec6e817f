// Large transparent spheres against rays: a limit that owes nothing to partial waves.
#include <cmath>
#include <numbers>

#include <miebrdf/sphere.h>
#include "tests/support/catch.h"

using namespace miebrdf;
using std::numbers::pi;

namespace {

// Mean cosine of the light that is reflected (p = 0) or refracted and reflected p - 1 times inside,
// both polarisations; with as much light diffracted straight ahead.
double asymmetry_of_rays(double n) {
    constexpr int rays = 20000;
    double sum = 0;
    for (int i = 0; i < rays; ++i) {
        const double b_squared = (i + 0.5) / rays;  // of the impact parameter: equal areas
        const double incidence = std::asin(std::sqrt(b_squared));
        const double refraction = std::asin(std::sqrt(b_squared) / n);
        const double ci = std::cos(incidence), ct = std::cos(refraction);
        for (const double r : {(ci - n * ct) / (ci + n * ct), (n * ci - ct) / (n * ci + ct)}) {
            const double R = r * r;
            sum += 0.5 * R * std::cos(pi - 2 * incidence);
            double energy = (1 - R) * (1 - R);
            for (int p = 1; p < 200 && energy > 1e-15; ++p, energy *= R) {
                const double turned =
                    2 * (incidence - refraction) + (p - 1) * (pi - 2 * refraction);
                sum += 0.5 * energy * std::cos(turned);
            }
        }
    }
    return 0.5 * (1 + sum / rays);
}

struct Means {
    double excess = 0, asymmetry = 0, edge = 0;  // Q_ext - 2, g, x^(-2/3)
};

Means means_around(double n, double x) {
    Means means;
    constexpr int count = 1000;
    for (int i = 0; i < count; ++i) {
        const double here = x * (0.9 + 0.2 * (i + 0.5) / count);
        const auto sphere = mie::scatter_by_sphere(n, here);
        means.excess += (sphere.q_ext - 2) / count;
        means.asymmetry += sphere.asymmetry / count;
        means.edge += std::pow(here, -2.0 / 3) / count;
    }
    return means;
}

}  // namespace

TEST_CASE("large transparent spheres come to the limit of rays, with its edge",
          "[mie][sphere][geometric]") {
    const double n = GENERATE(1.33, 1.5, 2.0);
    const double x = GENERATE(300.0, 1000.0, 4000.0);
    const Means means = means_around(n, x);
    CAPTURE(n, x, means.excess / means.edge, means.asymmetry, asymmetry_of_rays(n));
    // Nussenzveig & Wiscombe 1980, Phys. Rev. Lett. 45, 1490: Q_ext = 2 + 1.9924 x^(-2/3) + ...,
    // the next term smaller by x^(-2/3); ripple of a few sizes leaves 0.5 %.
    CHECK(std::abs(means.excess / means.edge - 1.9924) <= 0.01 + 2 * means.edge);
    // Edge light of share x^(-2/3) goes forward in place of what it was.
    CHECK(std::abs(means.asymmetry - asymmetry_of_rays(n)) <= 0.5 * means.edge);
}
