#include <cmath>
#include <numbers>

#include <miebrdf/surface.h>
#include "rte/math/quadrature.h"
#include "tests/support/catch.h"

using namespace miebrdf;
using rte::SurfaceCoupling;

namespace {

const rte::SurfaceLobe& rough_glass() {
    static const rte::SurfaceLobe lobe({1.8, 0.0}, {});
    return lobe;
}

/// f = R_s + in out R / pi at one pair of directions.
double complete_brdf(const rte::SurfaceLobe& lobe, const rte::SurfaceTransmission& transmission,
                     double mu_in, double mu_out, double azimuth_deg, double reflection) {
    return lobe.brdf(mu_in, mu_out, azimuth_deg) +
           transmission.in(mu_in)*transmission.out(mu_out) * reflection / std::numbers::pi;
}

}  // namespace

TEST_CASE("coupled as in the paper, the subsurface is weakened by 1 - rho of the incidence alone",
          "[rte][coupling]") {
    const rte::SurfaceTransmission transmission(rough_glass(), SurfaceCoupling::paper);
    CHECK(transmission.out(0.3) == 1.0);
    const double expected =
        rough_glass().brdf(0.5, 0.3, 20) +
        (1 - rough_glass().directional_reflectance(0.5)) * 0.8 / std::numbers::pi;
    CHECK(complete_brdf(rough_glass(), transmission, 0.5, 0.3, 20, 0.8) ==
          Approx(expected).epsilon(1e-15));
}

TEST_CASE("the reciprocal coupling is reciprocal, the paper's is not", "[rte][coupling]") {
    const auto value = [](SurfaceCoupling coupling, double mu_in, double mu_out) {
        const rte::SurfaceTransmission transmission(rough_glass(), coupling);
        return complete_brdf(rough_glass(), transmission, mu_in, mu_out, 120, 0.9);
    };
    CHECK(value(SurfaceCoupling::reciprocal, 0.1, 0.9) ==
          Approx(value(SurfaceCoupling::reciprocal, 0.9, 0.1)).epsilon(1e-13));
    CHECK(std::abs(value(SurfaceCoupling::paper, 0.1, 0.9) -
                   value(SurfaceCoupling::paper, 0.9, 0.1)) > 0.01);
}

TEST_CASE("over a Lambertian base both couplings reflect rho + (1 - rho) A", "[rte][coupling]") {
    const auto coupling = GENERATE(SurfaceCoupling::paper, SurfaceCoupling::reciprocal);
    const double albedo = GENERATE(0.3, 1.0);
    const rte::SurfaceTransmission transmission(rough_glass(), coupling);
    const auto rule = math::gauss_legendre(48, 0.0, 1.0);
    for (const double mu_in : {0.05, 0.5, 1.0}) {
        double diffuse = 0;  // 2 pi integral of f mu dmu, of the subsurface part
        for (std::size_t i = 0; i < rule.nodes.size(); ++i) {
            diffuse += 2 * rule.weights[i] * rule.nodes[i] *
                       transmission.in(mu_in)*transmission.out(rule.nodes[i]) * albedo;
        }
        const double rho = rough_glass().directional_reflectance(mu_in);
        CAPTURE(mu_in, rho, diffuse);
        // The mean's tolerance of 1e-5.
        CHECK(rho + diffuse == Approx(rho + (1 - rho) * albedo).margin(1e-5));
        CHECK(rho + diffuse <= 1 + 1e-5);
    }
}
