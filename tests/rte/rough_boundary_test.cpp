#include "rte/boundary/rough_boundary.h"

#include <Eigen/Eigenvalues>
#include <Eigen/LU>
#include <algorithm>
#include <cmath>
#include <memory>
#include <numbers>

#include "rte/boundary/facet_lobes.h"
#include "rte/boundary/rough_boundaries.h"
#include "rte/math/quadrature.h"
#include "rte/stack/layered_reflection.h"
#include "rte/surface/fresnel.h"
#include "tests/support/catch.h"
#include "tests/support/reference_table.h"

using namespace miebrdf;
using Eigen::MatrixXd;
using Eigen::VectorXd;
using rte::MicrofacetDistribution;
using rte::RoughBoundary;
using rte::RoughSurface;

namespace {

VectorXd flux_weights(const RoughBoundary& boundary) {
    const auto grid = boundary.grid().in_medium(boundary.index());
    return (grid.mu.array() * grid.weights.array()).sqrt();
}

VectorXd cosines(std::initializer_list<double> mu) {
    return Eigen::Map<const VectorXd>(mu.begin(), Eigen::Index(mu.size()));
}

/// R in air of a medium whose reflection in order m has the single term p p^T.
MatrixXd seen_from_air(const RoughBoundary& boundary, const rte::LightFromAir& light, int m,
                       const MatrixXd& x) {
    const MatrixXd& e = light.entering[std::size_t(m)];
    const MatrixXd unity = MatrixXd::Identity(x.rows(), x.cols());
    const double n = boundary.index();
    return e * (unity - x * boundary.inside(m)).partialPivLu().solve(x * e.transpose()) /
           (2 * n * n);
}

/// sin^m: smooth in every order, of norm 0.6^m.
MatrixXd smooth_medium(const RoughBoundary& boundary, int m) {
    const auto grid = boundary.grid().in_medium(boundary.index());
    const VectorXd p = flux_weights(boundary).array() * (1 - grid.mu.array().square()).pow(0.5 * m);
    return std::pow(0.6, m) / p.squaredNorm() * p * p.transpose();
}

}  // namespace

TEST_CASE("rough boundary: the energies of all rays of a facet add up to 1", "[rte][boundary]") {
    const double alpha = GENERATE(1e-6, 0.02, 0.3, 1.0);
    const auto distribution =
        GENERATE(MicrofacetDistribution::ggx, MicrofacetDistribution::beckmann);
    const double relative_index = GENERATE(1 / 1.5, 1.5, 3.0);
    for (const double mu : {1e-5, 0.3, 0.7, 1.0, -0.05}) {
        const auto light = rte::scatter_by_facets(relative_index, {alpha, distribution}, mu);
        const double sum = light.reflected.sum() + light.refracted.sum();
        CAPTURE(alpha, relative_index, mu, sum);
        // Nothing rises against Gaussian slopes that are small against the ray's own.
        const bool none = mu < 0 && light.reflected.mu.empty();
        CHECK((none || std::abs(sum - 1) <= 1e-13));
    }
}

TEST_CASE("rough boundary: light that meets one facet from air is the project's surface lobe",
          "[rte][boundary]") {
    rte::SurfaceOptions options;
    options.beckmann_alpha = GENERATE(0.02, 0.1, 0.4, 1.0);
    options.distribution = GENERATE(MicrofacetDistribution::ggx, MicrofacetDistribution::beckmann);
    const RoughSurface surface{options.beckmann_alpha, options.distribution};
    for (const double mu : {0.01, 0.2, 0.6, 1.0}) {
        const auto light = rte::scatter_by_facets(1.5, surface, mu);
        const double rho = rte::directional_reflectance({1.5, 0}, options, mu, 1e-7).value;
        CAPTURE(options.beckmann_alpha, mu);
        // Quadrature: 1e-5 of the energy, most at grazing.
        CHECK(std::abs(rte::unhidden(light, surface, mu).reflected.sum() - rho) <= 3e-5);
        const auto fine = rte::unhidden(rte::scatter_by_facets(1.5, surface, mu, 2), surface, mu);
        CHECK(std::abs(fine.reflected.sum() - rho) <= 3e-6);
    }
}

TEST_CASE(
    "rough boundary: a single facet loses the shares of diffuse internal light that others "
    "found",
    "[rte][boundary]") {
    struct Case {
        MicrofacetDistribution distribution;
        double alpha, lost;
    };
    const auto ggx = MicrofacetDistribution::ggx;
    const auto beckmann = MicrofacetDistribution::beckmann;
    // Random walks and a separate program; two digits.
    const auto c = GENERATE_COPY(values<Case>({{ggx, 0.1, 0.0337},
                                               {ggx, 0.2, 0.0992},
                                               {ggx, 0.3, 0.1740},
                                               {ggx, 0.5, 0.3158},
                                               {beckmann, 0.1, 0.006},
                                               {beckmann, 0.2, 0.024},
                                               {beckmann, 0.3, 0.054},
                                               {beckmann, 0.5, 0.14}}));
    const auto rule = math::gauss_legendre(24, 0.0, 1.0);
    double lost = 0;
    for (std::size_t i = 0; i < rule.nodes.size(); ++i) {
        const double mu = rule.nodes[i];
        const RoughSurface surface{c.alpha, c.distribution};
        const auto seen = rte::unhidden(rte::scatter_by_facets(1 / 1.5, surface, mu), surface, mu);
        lost += 2 * mu * rule.weights[i] * (1 - seen.reflected.sum() - seen.refracted.sum());
    }
    CAPTURE(c.alpha, lost);
    CHECK(std::abs(lost - c.lost) <= 0.02 * c.lost + 5e-4);  // their digits and 1 sigma
}

TEST_CASE("rough boundary: internal reflection agrees with random walks", "[rte][boundary]") {
    const support::ReferenceTable table("rte/rough_boundary_walk.csv");
    for (std::size_t row = 0; row < table.size(); ++row) {
        if (table.text(row, "mu") != "diffuse") continue;
        const double alpha = table.number(row, "alpha");
        const RoughBoundary boundary(1.5, {alpha, MicrofacetDistribution::ggx}, 24, 1);
        const double walk = table.number(row, "walk");
        CAPTURE(alpha, walk, boundary.internal_diffuse_reflectance());
        // 3 sigma; the scaling of single bounces that others use is 2 to 10 sigma low.
        CHECK(std::abs(boundary.internal_diffuse_reflectance() - walk) <=
              3 * table.number(row, "sigma"));

        const auto grid = boundary.grid().in_medium(1.5);
        const VectorXd d = flux_weights(boundary);
        const VectorXd reflected = (boundary.inside(0) * d).cwiseQuotient(d);
        for (++row; row < table.size() && table.text(row, "mu") != "diffuse"; ++row) {
            Eigen::Index node = 0;
            (grid.mu.array() - table.number(row, "mu")).abs().minCoeff(&node);
            REQUIRE(std::abs(grid.mu[node] - table.number(row, "mu")) <= 6e-5);
            CAPTURE(grid.mu[node], reflected[node]);
            // 4 sigma, and what conservation puts back: 2e-3 at alpha = 0.1.
            CHECK(std::abs(reflected[node] - table.number(row, "walk")) <=
                  4 * table.number(row, "sigma") + 2e-3);
        }
        --row;
    }
}

TEST_CASE("rough boundary: nothing is lost or won, in any direction", "[rte][boundary]") {
    const double n = GENERATE(1.05, 1.33, 1.5, 3.0);
    const double alpha = GENERATE(0.02, 0.15, 0.4, 1.0);
    const auto distribution =
        GENERATE(MicrofacetDistribution::ggx, MicrofacetDistribution::beckmann);
    const RoughBoundary boundary(n, {alpha, distribution}, 16, 3);
    CAPTURE(n, alpha);
    const double inside = boundary.internal_diffuse_reflectance();
    const double outside = boundary.external_diffuse_reflectance();
    CHECK(std::abs((1 - inside) * n * n - (1 - outside)) <= 1e-13 * n * n);

    const auto light = boundary.from_air(cosines({1e-3, 0.1, 0.5, 0.8, 1.0}));
    const VectorXd d = flux_weights(boundary);
    const MatrixXd white = d * d.transpose() / d.squaredNorm();
    const MatrixXd unity = MatrixXd::Identity(d.size(), d.size());
    const VectorXd escape = (unity - boundary.inside(0)) * d;
    const MatrixXd up = (unity - white * boundary.inside(0))
                            .partialPivLu()
                            .solve(white * light.entering[0].transpose());
    const VectorXd albedo = light.outer_reflectance + up.transpose() * escape;
    CHECK((albedo.array() - 1).abs().maxCoeff() <= 1e-13);  // rounding, 1 / (1 - r_int) = 15
    CHECK((light.outer_reflectance + light.entering[0] * d - VectorXd::Ones(5))
              .cwiseAbs()
              .maxCoeff() <= 1e-14);

    for (int m = 0; m < 3; ++m) {
        const MatrixXd& gamma = boundary.inside(m);
        CHECK((gamma - gamma.transpose()).cwiseAbs().maxCoeff() <= 1e-16);
        // No order sends back more than it received. The Lagrange functions at grazing allow for
        // a little more.
        const Eigen::SelfAdjointEigenSolver<MatrixXd> modes(gamma);
        CHECK(modes.eigenvalues().cwiseAbs().maxCoeff() <= 1.03);
    }
}

TEST_CASE("rough boundary: before anything is put back the walk conserves energy",
          "[rte][boundary]") {
    const double n = GENERATE(1.33, 1.5, 2.5);
    const double alpha = GENERATE(0.02, 0.05, 0.1, 0.3, 0.6, 1.0);
    const auto distribution =
        GENERATE(MicrofacetDistribution::ggx, MicrofacetDistribution::beckmann);
    const RoughBoundary boundary(n, {alpha, distribution}, 24, 1);
    const auto light = boundary.from_air(cosines({0.05, 0.2, 0.5, 0.8, 1.0}));
    CAPTURE(n, alpha, light.compensation.transpose());
    // Up to 80 % of this light meets several facets. The grid of the walk holds directions along
    // gentle facets of a dense medium least.
    const VectorXd missed = (light.compensation.array() - 1).abs();
    CHECK(missed[0] <= 6e-3);
    CHECK(missed.tail(4).maxCoeff() <= 4e-4);
}

TEST_CASE("rough boundary: gentle facets reflect straight light as a smooth boundary does",
          "[rte][boundary]") {
    // Light that meets one facet alone, nearly all of it: Fresnel's share at normal incidence, flat
    // to the fourth power of the slope, 1e-6 of it.
    const double n = GENERATE(1.33, 1.5, 2.5);
    const double alpha = GENERATE(0.02, 0.05);
    const RoughBoundary boundary(n, {alpha, MicrofacetDistribution::beckmann}, 24, 1);
    const double fresnel = (n - 1) * (n - 1) / ((n + 1) * (n + 1));
    CHECK(std::abs(boundary.from_air(cosines({1.0})).outer_reflectance[0] / fresnel - 1) <= 2e-4);
}

TEST_CASE("rough boundary: the raised lobe has the energy that does not enter", "[rte][boundary]") {
    rte::SurfaceOptions options;
    options.beckmann_alpha = GENERATE(0.15, 0.5);
    options.distribution = GENERATE(MicrofacetDistribution::ggx, MicrofacetDistribution::beckmann);
    const auto boundary = std::make_shared<const RoughBoundary>(
        1.5, RoughSurface{options.beckmann_alpha, options.distribution}, 24, 1);
    const rte::OuterLobeScale scale(boundary);
    const rte::SurfaceLobe lobe({1.5, 0}, options);
    const auto rule = math::gauss_legendre(200, 0.0, 1.0);
    const VectorXd mu = Eigen::Map<const VectorXd>(rule.nodes.data(), 200);
    const VectorXd out = scale.at(mu);
    for (const double mu_in : {0.15, 0.3, 0.6, 0.95}) {
        const auto light = boundary->from_air(cosines({mu_in}));
        double sum = 0.0;
        for (Eigen::Index o = 0; o < 200; ++o) {
            for (int a = 0; a < 1000; ++a)
                sum += 2 * std::numbers::pi / 1000 * rule.weights[std::size_t(o)] * mu[o] * out[o] *
                       lobe.brdf(mu_in, mu[o], 360.0 * (a + 0.5) / 1000);
        }
        CAPTURE(options.beckmann_alpha, mu_in, light.outer_reflectance[0]);
        // 200 x 1000 directions sum a lobe of this width to 1e-4.
        CHECK(std::abs(scale.at(cosines({mu_in}))[0] * sum / light.outer_reflectance[0] - 1) <=
              1e-3);
    }
}

TEST_CASE("rough boundary: a nearly smooth one is the smooth one", "[rte][boundary]") {
    const double n = GENERATE(1.33, 1.5, 2.0);
    const auto distribution =
        GENERATE(MicrofacetDistribution::ggx, MicrofacetDistribution::beckmann);
    const RoughBoundary boundary(n, {1e-6, distribution}, 16, 4);
    const auto grid = boundary.grid().in_medium(n);
    VectorXd r(grid.size());
    for (Eigen::Index p = 0; p < r.size(); ++p) {
        const bool total = n * n * (1 - grid.mu[p] * grid.mu[p]) >= 1;
        r[p] = total ? 1.0 : rte::fresnel_reflectance(1 / n, grid.mu[p]);
    }
    for (int m = 0; m < 4; ++m) {
        MatrixXd difference = boundary.inside(m);
        difference.diagonal() -= r;
        // The first nodes of the panels lie at mu = 1e-4 or 2e-5 in q, where slopes of 1e-6 are
        // not small.
        CAPTURE(n, m, difference.cwiseAbs().maxCoeff());
        CHECK(difference.cwiseAbs().maxCoeff() <= 1e-4);
        CHECK((difference * flux_weights(boundary)).cwiseAbs().maxCoeff() <= 1e-5);
    }
    const auto air = boundary.grid().in_medium(1.0);
    const VectorXd mu = air.mu.tail(4);  // nodes: one row entry each, t / D
    const auto light = boundary.from_air(mu);
    const VectorXd d = flux_weights(boundary);
    for (Eigen::Index k = 0; k < 4; ++k) {
        const Eigen::Index p = d.size() - 4 + k;
        VectorXd row = light.entering[2].row(k).transpose().cwiseProduct(d);
        row[p] -= 1 - r[p];
        CHECK(row.cwiseAbs().maxCoeff() <= 1e-5);
    }
}

TEST_CASE("rough boundary: 16 streams are enough", "[rte][boundary]") {
    const double n = GENERATE(1.33, 1.5, 2.0);
    const double alpha = GENERATE(0.1, 0.3, 0.8);
    const auto distribution =
        GENERATE(MicrofacetDistribution::ggx, MicrofacetDistribution::beckmann);
    const VectorXd mu = cosines({0.1, 0.4, 0.7, 1.0});
    const RoughBoundary coarse(n, {alpha, distribution}, 16, 4);
    const RoughBoundary fine(n, {alpha, distribution}, 24, 4);
    const auto light_coarse = coarse.from_air(mu);
    const auto light_fine = fine.from_air(mu);
    for (int m = 0; m < 4; ++m) {
        const MatrixXd difference =
            seen_from_air(coarse, light_coarse, m, smooth_medium(coarse, m)) -
            seen_from_air(fine, light_fine, m, smooth_medium(fine, m));
        CAPTURE(n, alpha, m);
        CHECK(difference.cwiseAbs().maxCoeff() <= (n == 1.5 && alpha < 0.5 ? 2e-4 : 5e-4));
    }
}

TEST_CASE("rough boundary refuses nonsense with the value", "[rte][boundary][errors]") {
    const auto ggx = MicrofacetDistribution::ggx;
    CHECK_THROWS_WITH(RoughBoundary(1.01, {0.2, ggx}, 16, 1),
                      Catch::Contains("1.01") && Catch::Contains("1.05 to 3"));
    CHECK_THROWS_WITH(RoughBoundary(1.5, {0.0, ggx}, 16, 1), Catch::Contains("alpha"));
    CHECK_THROWS_WITH(RoughBoundary(1.5, {std::nan(""), ggx}, 16, 1), Catch::Contains("nan"));
    CHECK_THROWS_WITH(RoughBoundary(1.5, {0.2, ggx}, 2, 1), Catch::Contains("streams"));
    CHECK_THROWS_WITH(RoughBoundary(1.5, {0.2, ggx}, 16, 0), Catch::Contains("orders"));
    const RoughBoundary boundary(1.5, {0.2, ggx}, 8, 1);
    CHECK_THROWS_WITH(boundary.from_air(cosines({0.0})), Catch::Contains("mu_air"));
}

TEST_CASE("rough boundary: matrices between indices follow a parabola", "[rte][boundary]") {
    const double index = GENERATE(1.1, 1.206, 1.334, 1.4963, 2.337, 2.9969);
    const auto distribution =
        GENERATE(MicrofacetDistribution::ggx, MicrofacetDistribution::beckmann);
    const double alpha = GENERATE(0.02, 0.2, 0.6);
    constexpr int streams = 16, orders = 6;
    const rte::Boundary kind{alpha, distribution, rte::BoundaryMatrices::interpolated};
    rte::RoughBoundaries boundaries;
    const auto between =
        boundaries.find(index, kind, rte::RefractionGrid({index}, streams), orders);
    const RoughBoundary followed(index, {alpha, distribution}, streams, orders);
    const auto mu = cosines({0.05, 0.3, 0.8, 1.0});
    const auto light = between->from_air(mu), expected = followed.from_air(mu);
    CAPTURE(index, alpha);
    const double bound = 3e-5;  // the third difference over steps of .01
    for (int m = 0; m < orders; ++m) {
        const MatrixXd x = smooth_medium(followed, m);
        const MatrixXd a = seen_from_air(*between, light, m, x);
        const MatrixXd b = seen_from_air(followed, expected, m, x);
        CAPTURE(m, (a - b).cwiseAbs().maxCoeff(), b.cwiseAbs().maxCoeff());
        CHECK((a - b).cwiseAbs().maxCoeff() <= bound);
    }
    CHECK((light.outer_reflectance - expected.outer_reflectance).cwiseAbs().maxCoeff() <= bound);
    // Energy is kept exactly all the same.
    const VectorXd D = flux_weights(*between);
    const VectorXd energy = light.entering[0] * D + light.outer_reflectance;
    CHECK((energy.array() - 1).abs().maxCoeff() <= 1e-13);
    const double n2 = index * index;
    CHECK(std::abs((1 - between->internal_diffuse_reflectance()) * n2 -
                   (1 - between->external_diffuse_reflectance())) <= 1e-12);
}

namespace {

/// A film of almost nothing in glass, its surface rough.
rte::Stack rough_film(const rte::Optics& particles, double depth, double alpha) {
    rte::Stack stack;
    stack.base_kind = rte::BaseKind::mirror;
    stack.base_index = 1.5;
    stack.coats = {{particles, depth, 1.5}};
    stack.boundary = rte::Boundary{.roughness = alpha};
    return stack;
}

const rte::Directions kAcross{{0.7}, {0.7}, {0, 60, 180}};

}  // namespace

TEST_CASE("rough boundary over mirrors: photons that walk over the facets", "[rte][boundary]") {
    // 8,000,000 photons of tools/bench/traced_boundary.cpp, whose facets are walked one by one:
    // means of the BRDF over mu_out +- .02 and azimuths +- 3 degrees, and their standard errors.
    struct Case {
        double alpha;
        std::complex<double> mirror;
        double mu_out, azimuth_deg, mean, error;
    };
    const std::complex<double> metal{0.5, 5.0}, air{1.0, 0.0};
    const Case c = GENERATE_COPY(
        Case{0.1, metal, 0.7, 0, 21.5746, 0.0288}, Case{0.1, metal, 0.5, 0, 2.63071, 0.0118},
        Case{0.1, metal, 0.7, 60, 0.01417, 0.00047}, Case{0.3, metal, 0.7, 0, 3.00144, 0.0107},
        Case{0.3, metal, 0.7, 60, 0.12223, 0.0014}, Case{0.3, metal, 0.5, 0, 1.84112, 0.0098},
        Case{0.3, air, 0.7, 0, 0.36548, 0.0027}, Case{0.3, air, 0.7, 60, 0.02285, 0.0006},
        Case{0.3, air, 0.5, 0, 0.53538, 0.0048});
    rte::Stack stack = rough_film(rte::isotropic_optics(0.5), 1e-9, c.alpha);
    stack.mirror_index = c.mirror;
    rte::Directions bin{{0.7}, {}, {}};
    for (const double at : {-0.8, -0.4, 0.0, 0.4, 0.8}) {
        bin.mu_out.push_back(c.mu_out + 0.02 * at);
        bin.azimuth_deg.push_back(c.azimuth_deg + 3.0 * at);
    }
    const auto table = rte::reflect(stack, bin, {.tolerance = 1e-3});
    double sum = 0.0, weight = 0.0;
    for (std::size_t k = 0; k < table.reflection.size(); ++k) {
        const double mu = bin.mu_out[k / bin.azimuth_deg.size()];
        sum += mu * table.reflection[k] / std::numbers::pi;
        weight += mu;
    }
    CAPTURE(c.alpha, c.mirror, c.mu_out, c.azimuth_deg, sum / weight);
    // FacetWalk, which follows light through several facets, is within 2e-3 of the energy.
    CHECK(std::abs(sum / weight - c.mean) <= 4 * c.error + 5e-3 * c.mean);
}

TEST_CASE("rough boundary over mirrors: the lobe by orders is the lobe ray by ray",
          "[rte][boundary]") {
    const auto distribution =
        GENERATE(rte::MicrofacetDistribution::ggx, rte::MicrofacetDistribution::beckmann);
    const double alpha = GENERATE(0.05, 0.1, 0.4);
    const rte::MirroredLobe lobe(1.5, {alpha, distribution}, [](double mu) { return 0.9 * mu; });
    const auto values = [&](const std::vector<double>& mu_out, int azimuths) {
        rte::Directions to{{0.4, 0.8}, mu_out, {}};
        for (int a = 0; a < azimuths; ++a) to.azimuth_deg.push_back(180.0 * a / azimuths);
        std::vector<double> reflection(2 * mu_out.size() * to.azimuth_deg.size(), 0.0);
        lobe.add_to(reflection, to, Eigen::VectorXd::Ones(2),
                    Eigen::VectorXd::Ones(Eigen::Index(mu_out.size())));
        return reflection;
    };
    // One azimuth of one direction is less work by rays, a thousand are by orders.
    const std::vector<double> by_orders = values({0.75, 0.8, 0.4}, 1000);
    const std::vector<double> by_rays = values({0.75, 0.8, 0.4}, 1);
    for (const std::size_t in : {0, 1}) {
        const double largest = by_rays[3 * in + (in == 0 ? 2 : 1)];
        CAPTURE(distribution, alpha, in, largest);
        // The rays of a beam, about 1,500, err by 3e-4 of the largest value, orders by 2e-4.
        for (std::size_t out = 0; out < 3; ++out)
            CHECK(std::abs(by_rays[3 * in + out] - by_orders[1000 * (3 * in + out)]) <=
                  5e-4 * largest);
    }
    const Eigen::VectorXd both{{0.4, 0.8}};
    const auto orders = lobe.by_order(both, Eigen::VectorXd::Ones(2), lobe.orders());
    CHECK(orders[0](0, 1) == orders[0](1, 0));
}

TEST_CASE("rough boundary over mirrors: so few particles do not matter", "[rte][boundary]") {
    rte::Stack stack = rough_film(rte::isotropic_optics(0.5), 1e-4, 0.3);
    stack.mirror_index = {0.5, 5.0};
    const auto table = rte::reflect(stack, kAcross, {.tolerance = 1e-3});
    for (const double g : {0.01, 0.3, 0.6, 0.9}) {
        stack.coats[0].optics = rte::henyey_greenstein_optics(0.5, g);
        const auto other = rte::reflect(stack, kAcross, {.tolerance = 1e-3});
        CAPTURE(g, other.reflection);
        for (std::size_t k = 0; k < 3; ++k) {
            // Both within the tolerance, relative to the largest; 1e-4 scatters less than that.
            CHECK(std::abs(other.reflection[k] - table.reflection[k]) <=
                  2e-3 * table.reflection[0]);
        }
    }
}

TEST_CASE("rough boundary over mirrors: values settle with the nodes", "[rte][boundary]") {
    const double alpha = GENERATE(0.05, 0.1, 0.3);
    rte::Stack stack = rough_film(rte::henyey_greenstein_optics(0.5, 0.6), 1e-4, alpha);
    stack.mirror_index = GENERATE(std::complex<double>{0.5, 5.0}, std::complex<double>{1.0, 0.0});
    const auto values = [&](int streams) {
        return rte::reflect(stack, kAcross, {.tolerance = 1e-4, .streams = streams}).reflection;
    };
    const std::vector<double> few = values(32), more = values(48);
    CAPTURE(alpha, stack.mirror_index, few, more);
    for (std::size_t k = 0; k < 3; ++k) CHECK(std::abs(few[k] - more[k]) <= 2e-3 * more[0]);
}

TEST_CASE("rough boundary over denser layers", "[rte][boundary]") {
    rte::Stack stack = rough_film(rte::isotropic_optics(0.5), 0.1, 0.2);
    stack.base_kind = rte::BaseKind::half_space;
    stack.base = rte::isotropic_optics(1.0);
    stack.base_index = 2.0;
    stack.coats[0].optics = rte::isotropic_optics(1.0);
    const auto albedo = rte::albedo(stack, {0.3, 1.0}, {});
    // Nothing absorbs. As far as the facets' balance holds on these nodes.
    for (const double value : albedo.plane_albedo) CHECK(std::abs(value - 1.0) <= 1e-12);
    CHECK(rte::reflect(stack, kAcross, {.streams = 3}).reflection.size() == 3);
}

TEST_CASE("rough boundary: energy below indices close to 1", "[rte][boundary]") {
    rte::Stack stack;
    stack.base = rte::henyey_greenstein_optics(1.0, 0.7);
    stack.base_index = GENERATE(1.05, 1.1, 1.5);
    stack.boundary = rte::Boundary{.roughness = GENERATE(0.0, 0.2)};
    const auto albedo = rte::albedo(stack, {0.1, 0.5, 1.0}, {});
    CAPTURE(stack.base_index, stack.boundary->roughness, albedo.plane_albedo);
    for (const double value : albedo.plane_albedo) CHECK(std::abs(value - 1.0) <= 1e-13);
    CHECK(std::abs(albedo.spherical_albedo - 1.0) <= 1e-13);
}
