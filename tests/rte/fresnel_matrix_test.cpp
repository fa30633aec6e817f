// Fresnel's Mueller matrices by themselves.
#include "rte/boundary/fresnel_matrix.h"

#include <cmath>
#include <complex>

#include "rte/boundary/smooth_boundary.h"
#include "rte/grid/refraction_grid.h"
#include "rte/surface/fresnel.h"
#include "tests/support/catch.h"

using namespace miebrdf;

TEST_CASE("Fresnel's matrices are what the scalar equations are the mean of", "[rte][stokes]") {
    const std::complex<double> indices[] = {1.5, 1.01, 0.6, {0.2, 3.4}, {3.5, 0.1}};
    for (const std::complex<double> index : indices) {
        for (const double mu : {1e-3, 0.2, 0.55, 0.83, 1.0}) {
            const auto r = rte::fresnel_reflection(1.0, index, mu);
            const double scalar =
                rte::boundary_reflectance(1.0, index, Eigen::VectorXd::Constant(1, mu))[0];
            CHECK(std::abs(r.unpolarised() - scalar) <= 1e-14);
            // Light that is fully polarised stays so.
            CHECK(std::abs(std::norm(r.cross) - r.parallel * r.across) <= 1e-14);
        }
        // A normal mirror returns I and Q as they are, U and V with the opposite sign.
        const Eigen::Matrix4d M = mueller_of(rte::fresnel_reflection(1.0, index, 1.0));
        const Eigen::Vector4d signs(1.0, 1.0, -1.0, -1.0);
        const double R = rte::normal_reflectance(index);
        CHECK((M - R * Eigen::Matrix4d(signs.asDiagonal())).cwiseAbs().maxCoeff() <= 1e-15);
    }
    // Brewster's angle, and from inside the same shares as from outside.
    CHECK(rte::fresnel_reflection(1.0, 1.5, 1.0 / std::hypot(1.0, 1.5)).parallel <= 1e-30);
    const auto outside = rte::fresnel_reflection(1.0, 1.5, 0.3);
    const auto inside = rte::fresnel_reflection(1.5, 1.0, rte::refracted_cosine(1.5, 0.3));
    CHECK(std::abs(outside.parallel - inside.parallel) <= 1e-15);
    CHECK(std::abs(outside.cross - inside.cross) <= 1e-15);
}

TEST_CASE("total reflection turns U into V by the phase of Fresnel's rhomb", "[rte][stokes]") {
    // Born & Wolf 1999, ch. 1.5: n 1.51, 54 degrees 37 minutes: 45 degrees.
    const double degree = std::acos(-1.0) / 180.0;
    const auto r = rte::fresnel_reflection(1.51, 1.0, std::cos((54.0 + 37.0 / 60.0) * degree));
    CHECK(r.parallel == 1.0);
    CHECK(r.across == 1.0);
    CHECK(std::abs(std::abs(r.cross) - 1.0) <= 1e-15);
    CHECK(std::abs(std::abs(std::arg(r.cross)) / degree - 45.0) <= 0.02);  // 1 minute of arc
    // The amplitudes themselves, with the root of a wave that decays for exp(-i omega t).
    for (const double mu : {0.1, 0.4, 0.6}) {
        const double m = 1.0 / 1.51;
        const std::complex<double> far(0.0, std::sqrt((1.0 - mu * mu) / (m * m) - 1.0));
        const auto rp = (m * mu - far) / (m * mu + far), rs = (mu - m * far) / (mu + m * far);
        CHECK(std::abs(rte::fresnel_reflection(1.51, 1.0, mu).cross - rp * std::conj(rs)) <= 1e-14);
    }
}
