// What passes a film, direction by direction.
#include <miebrdf/brdf.h>
#include <miebrdf/error.h>

#include <fmt/format.h>
#include <Eigen/LU>
#include <cmath>
#include <numbers>

#include "rte/math/quadrature.h"
#include "tests/support/catch.h"

using namespace miebrdf;

namespace {

Brdf film(const std::vector<std::string>& layers, const std::string& boundary = {},
          const std::string& substrate_words = "none") {
    Scene scene;
    for (const std::string& words : layers) scene.layers.push_back(layer(words));
    scene.substrate = substrate(substrate_words);
    if (!boundary.empty()) scene.boundary = miebrdf::boundary(boundary);
    return solve(scene, {550}, {.tolerance = 1e-4, .stokes = 1});
}

/// Mean over the azimuth of pi times the BTDF.
double mean_transmission(const FilmTransmission& film, double mu_in, double mu_out) {
    constexpr int kAzimuths = 64;
    std::vector<Direction> directions;
    for (int a = 0; a < kAzimuths; ++a)
        directions.push_back({mu_in, mu_out, 180.0 * (a + 0.5) / kAzimuths});
    std::vector<double> values(directions.size());
    film.evaluate(directions, values);
    double sum = 0.0;
    for (const double value : values) sum += value;
    return std::numbers::pi * sum / kAzimuths;
}

/// All that passes without and with scattering.
double transmittance(const FilmTransmission& film, double mu_in) {
    const auto rule = math::gauss_legendre(64, 0.0, 1.0);
    double sum = film.unscattered(0, mu_in);
    for (std::size_t q = 0; q < rule.nodes.size(); ++q) {
        const double mu = rule.nodes[q] * rule.nodes[q] * (2 - rule.nodes[q]);
        const double slope = rule.nodes[q] * (4 - 3 * rule.nodes[q]);
        sum += 2 * mu * slope * rule.weights[q] * mean_transmission(film, mu_in, mu);
    }
    return sum;
}

/// Adding and doubling of the azimuthal mean (van de Hulst 1963) from a layer so thin that light
/// is scattered in it once: R and T as of BRDF = R / pi, at Gauss nodes and, with no weight, at two
/// cosines of one's own.
double doubled(double albedo, double g, double depth, double mu_in, double mu_out) {
    constexpr int kNodes = 40, kDoublings = 22;
    const auto rule = math::gauss_legendre(kNodes, 0.0, 1.0);
    Eigen::ArrayXd mu(kNodes + 2), w(kNodes + 2);
    mu << mu_in, mu_out, Eigen::Map<const Eigen::ArrayXd>(rule.nodes.data(), kNodes);
    w << 0, 0, Eigen::Map<const Eigen::ArrayXd>(rule.weights.data(), kNodes);
    const Eigen::MatrixXd W = (2 * w * mu).matrix().asDiagonal();
    const double tau = std::ldexp(depth, -kDoublings);
    const Eigen::Index n = mu.size();
    Eigen::MatrixXd R(n, n), T(n, n);
    for (Eigen::Index i = 0; i < n; ++i) {
        for (Eigen::Index j = 0; j < n; ++j) {
            double forward = 0.0, back = 0.0;
            for (unsigned l = 0; l < 60; ++l) {
                const double term = (2 * l + 1) * std::pow(g, l) * std::legendre(l, mu[i]) *
                                    std::legendre(l, mu[j]);
                forward += term;
                back += l % 2 == 0 ? term : -term;
            }
            const double x = tau / mu[i], y = tau / mu[j];
            R(i, j) = albedo * back * -std::expm1(-x - y) / (4 * (mu[i] + mu[j]));
            const double difference =
                std::abs(x - y) < 1e-9 ? 1.0 : -std::expm1(-(x - y)) / (x - y);
            T(i, j) = albedo * forward * std::exp(-y) * difference * tau / (4 * mu[i] * mu[j]);
        }
    }
    Eigen::ArrayXd e = (-tau / mu).exp();
    for (int k = 0; k < kDoublings; ++k) {
        const Eigen::MatrixXd E = e.matrix().asDiagonal(), RW = R * W;
        const Eigen::MatrixXd down =
            (Eigen::MatrixXd::Identity(n, n) - RW * RW).partialPivLu().solve(T + RW * R * E);
        const Eigen::MatrixXd up = R * E + RW * down;
        const Eigen::MatrixXd passed = E * down + T * E + T * W * down;
        R += E * up + T * W * up;
        T = passed;
        e *= e;
    }
    return T(1, 0);
}

}  // namespace

TEST_CASE("the azimuthal mean of what passes a film is that of adding and doubling",
          "[pipeline][transmission]") {
    struct Case {
        double albedo, g, depth;
    };
    const auto [albedo, g, depth] =
        GENERATE(Case{1.0, 0.0, 1.0}, Case{0.9, 0.6, 0.3}, Case{0.99, 0.7, 5.0});
    const FilmTransmission passed(film({fmt::format("hg:{},{}@{}", albedo, g, depth)}));
    CAPTURE(albedo, g, depth);
    CHECK(passed.report().converged());
    for (const double mu_in : {0.15, 0.6, 1.0}) {
        for (const double mu_out : {0.2, 0.6, 0.95}) {
            const double wanted = doubled(albedo, g, depth, mu_in, mu_out);
            const double found = mean_transmission(passed, mu_in, mu_out);
            CAPTURE(mu_in, mu_out, wanted, found);
            CHECK(std::abs(found - wanted) <= 3e-4 * wanted);  // the tolerance, and interpolation
        }
    }
}

TEST_CASE("what passes in all directions and straight on is the plane transmittance",
          "[pipeline][transmission]") {
    const Brdf scene =
        GENERATE(film({"hg:0.95,0.7@2"}, {}, "black"), film({"hg:1,0.5 in index:1.5@1"}, "smooth"),
                 film({"hg:0.9,0.3@0.5", "hg:0.99,0.7@1.5"}),
                 film({"hg:0.9,0.3 in index:1.6@0.5", "hg:0.99,0.7 in index:1.3@1.5"}, "smooth"),
                 film({"index:1.5,radius=0.15,volume=5% in index:1.33@30um"}, "smooth"));
    CAPTURE(describe(scene.scene()));
    const FilmTransmission passed(scene);
    CHECK(passed.report().converged());
    const AlbedoValues all = scene.albedo({0.3, 0.7, 1.0});
    for (std::size_t i = 0; i < all.mu_in.size(); ++i) {
        const double sum = transmittance(passed, all.mu_in[i]);
        CAPTURE(all.mu_in[i], sum, all.plane_transmittance[0][i], passed.unscattered(0, 1.0));
        CHECK(std::abs(sum - all.plane_transmittance[0][i]) <= 5e-4 * sum);
    }
}

TEST_CASE("a film that absorbs nothing reflects what does not pass", "[pipeline][transmission]") {
    const Brdf scene = film({"hg:1,0.6 in index:1.5@3", "hg:1,0 in index:1.5@0.2"}, "smooth");
    const FilmTransmission passed(scene);
    for (const double mu_in : {0.2, 0.9}) {
        const double all = transmittance(passed, mu_in) + scene.albedo({mu_in}).at(0, 0);
        CHECK(std::abs(all - 1) <= 3e-4);
    }
}

TEST_CASE("a film turned over passes the same between exchanged directions",
          "[pipeline][transmission]") {
    const std::string a = "hg:0.9,0.3 in index:1.6@0.5", b = "hg:0.7,0.7 in index:1.3@1.5";
    const std::string boundary = GENERATE("", "smooth");
    const FilmTransmission one(film({a, b}, boundary)), turned(film({b, a}, boundary));
    for (const double azimuth : {0.0, 70.0, 180.0}) {
        const std::vector<Direction> there{{0.3, 0.8, azimuth}}, back{{0.8, 0.3, azimuth}};
        double down = 0.0, up = 0.0;
        one.evaluate(there, {&down, 1});
        turned.evaluate(back, {&up, 1});
        CAPTURE(boundary, azimuth, down, up);
        CHECK(std::abs(down - up) <= 2e-4 * down);
    }
}

TEST_CASE("where nothing passes, or no direction of it is known, the reason is said",
          "[pipeline][transmission][errors]") {
    using Catch::Contains;
    CHECK_THROWS_WITH(FilmTransmission(solve({.base = medium("hg:0.9,0.5")}, {550})),
                      Contains("half-space"));
    CHECK_THROWS_WITH(FilmTransmission(film({"hg:0.9,0.5@1"}, {}, "lambert:0.5")),
                      Contains("no far side"));
    CHECK_THROWS_WITH(FilmTransmission(film({"hg:0.9,0.5 in index:1.5@1"}, "smooth", "black")),
                      Contains("substrate none"));
    CHECK_THROWS_WITH(FilmTransmission(film({"hg:0.9,0.5 in index:1.5@1"}, "rough:0.2")),
                      Contains("rough boundary"));
    CHECK_THROWS_WITH(FilmTransmission(film({"hg:0.9,0.5@inf"})), Contains("nothing pass"));
    const FilmTransmission passed(film({"hg:0.9,0.5@1"}));
    CHECK_THROWS_WITH(passed.unscattered(0, 1.5), Contains("1.5"));
    CHECK_THROWS_WITH(passed.unscattered(3, 0.5), Contains("3"));
}
