// Many layers of analytic media in one call.
#include <miebrdf/brdf.h>
#include <miebrdf/error.h>
#include <miebrdf/layer_albedos.h>

#include <cmath>
#include <limits>
#include <random>

#include "pipeline/scene/scene_parts.h"
#include "rte/stack/layered_reflection.h"
#include "tests/support/catch.h"

using namespace miebrdf;

namespace {

constexpr double kInfinite = std::numeric_limits<double>::infinity();
const std::vector<double> kOne{1.0}, kZero{0.0}, kDeep{kInfinite};

struct RandomLayers {
    std::vector<double> albedo, g, depth, index, ground;

    explicit RandomLayers(std::size_t count) {
        std::mt19937_64 engine(11);
        const auto uniform = [&](double from, double to) {
            return from + (to - from) * (double(engine() >> 12) + 0.5) * 0x1p-52;
        };
        for (std::size_t i = 0; i < count; ++i) {
            albedo.push_back(i % 7 == 0 ? 1.0 : uniform(0.0, 1.0));
            g.push_back(uniform(-0.5, 0.85));
            depth.push_back(i % 3 == 0 ? kInfinite : std::exp(uniform(-3.0, 3.0)));
            index.push_back(i % 2 == 0 ? 1.0 : uniform(1.1, 1.8));
            ground.push_back(uniform(0.0, 1.0));
        }
    }
    LayerBatch batch(const std::vector<double>& mu_in) const {
        return {albedo, g, depth, index, ground, mu_in};
    }
};

}  // namespace

TEST_CASE("layers of a batch are those solved alone", "[pipeline][layers]") {
    const RandomLayers layers(150);  // three blocks
    const std::vector<double> mu_in{0.2, 1.0};
    const LayerAlbedos all = layer_albedos(layers.batch(mu_in));
    for (std::size_t i = 0; i < layers.albedo.size(); ++i) {
        CAPTURE(i, layers.albedo[i], layers.g[i], layers.depth[i], layers.index[i]);
        const auto optics = rte::henyey_greenstein_optics(layers.albedo[i], layers.g[i]);
        rte::Stack stack{.base = optics, .base_index = layers.index[i]};
        if (std::isfinite(layers.depth[i])) {
            stack.base_kind = rte::BaseKind::lambertian;
            stack.ground_albedo = layers.ground[i];
            stack.coats = {{optics, layers.depth[i], layers.index[i]}};
        }
        if (layers.index[i] > 1.0) stack.boundary = rte::Boundary{};
        const rte::AlbedoTable alone = rte::albedo(stack, mu_in);
        CHECK(all.spherical_albedo[i] == alone.spherical_albedo);
        CHECK((all.converged[i] == 1) == alone.report.converged);
        for (std::size_t k = 0; k < mu_in.size(); ++k) {
            CHECK(all.plane_albedo[i * 2 + k] == alone.plane_albedo[k]);
            const double passed = alone.transmittance.empty() ? 0.0 : alone.transmittance[k];
            CHECK(all.plane_transmittance[i * 2 + k] == passed);
        }
    }
}

TEST_CASE("a batch does what the words of a scene do", "[pipeline][layers]") {
    const std::vector<double> mu_in{0.6}, albedo{0.95}, g{0.5}, depth{2.0}, index{1.5}, ground{0.3};
    const LayerAlbedos all = layer_albedos({albedo, g, depth, index, ground, mu_in});
    Scene scene;
    scene.substrate = substrate("lambert:0.3");
    scene.layers.push_back(layer("hg:0.95,0.5@2"));
    scene.particles.host = host("index:1.5");
    scene.boundary = boundary("smooth");
    const auto values = solve(scene, {550}).albedo({0.6});
    CHECK(std::abs(all.plane_albedo[0] - values.plane_albedo[0][0]) <= 1e-12);
    CHECK(std::abs(all.spherical_albedo[0] - values.spherical_albedo[0]) <= 1e-12);
}

TEST_CASE("one value serves all layers, and threads change nothing", "[pipeline][layers]") {
    std::vector<double> albedo;
    for (int i = 0; i < 200; ++i) albedo.push_back(i / 199.0);
    const std::vector<double> g{0.3};
    const LayerBatch batch{albedo, g, kDeep, kOne, kZero, kOne};
    const LayerAlbedos one = layer_albedos(batch, {}, {.threads = 1});
    const LayerAlbedos two = layer_albedos(batch, {}, {.threads = 2});
    CHECK(one.plane_albedo == two.plane_albedo);
    REQUIRE(one.plane_albedo.size() == 200);
    CHECK(one.plane_albedo.front() == 0.0);
    CHECK(std::abs(one.plane_albedo.back() - 1.0) <= 1e-12);
    for (std::size_t i = 1; i < 200; ++i) CHECK(one.plane_albedo[i] > one.plane_albedo[i - 1]);
}

TEST_CASE("a batch names the value that is out of range", "[pipeline][layers]") {
    const std::vector<double> two{0.5, 0.6}, three{0.1, 0.2, 0.3}, bad{0.5, 1.5}, nan{std::nan("")};
    const auto solve_with = [&](const std::vector<double>& albedo, const std::vector<double>& g) {
        return layer_albedos({albedo, g, kDeep, kOne, kZero, kOne});
    };
    CHECK_THROWS_WITH(solve_with(bad, kZero), Catch::Contains("single_scattering_albedo[1]: 1.5") &&
                                                  Catch::Contains("[0, 1]"));
    CHECK_THROWS_WITH(solve_with(two, three), Catch::Contains("asymmetry: 3 values"));
    CHECK_THROWS_WITH(solve_with(two, kOne), Catch::Contains("asymmetry[0]: 1"));
    CHECK_THROWS_AS(solve_with(nan, kZero), UsageError);
    CHECK_THROWS_AS(layer_albedos({two, kZero, kDeep, kOne, kZero, kZero}), UsageError);  // mu_in
    CHECK(layer_albedos({{}, kZero, kDeep, kOne, kZero, kOne}).spherical_albedo.empty());
    const LayerAlbedos no_incidence = layer_albedos({two, kZero, kDeep, kOne, kZero, {}});
    CHECK(no_incidence.plane_albedo.empty());
    CHECK(no_incidence.spherical_albedo.size() == 2);
}

namespace {

/// The spherical albedo of an isotropic half-space: 1 - 2 (1 - w)^1/2 alpha_1, alpha_1 the first
/// moment of Chandrasekhar's H, here by iteration of his equation with 200 points of the midpoint
/// rule in mu^1/2 (Chandrasekhar 1960, ch. V).
double isotropic_spherical_albedo(double w) {
    constexpr int n = 200;
    std::vector<double> mu(n), weight(n), h(n, 1.0);
    for (int i = 0; i < n; ++i) {
        const double x = (i + 0.5) / n;
        mu[std::size_t(i)] = x * x;
        weight[std::size_t(i)] = 2.0 * x / n;
    }
    const double root = std::sqrt(1.0 - w);
    for (int step = 0; step < 400; ++step) {
        for (std::size_t i = 0; i < n; ++i) {
            double sum = 0.0;
            for (std::size_t j = 0; j < n; ++j) sum += weight[j] * mu[j] * h[j] / (mu[i] + mu[j]);
            h[i] = 0.5 * (h[i] + 1.0 / (root + 0.5 * w * sum));
        }
    }
    double moment = 0.0;
    for (std::size_t i = 0; i < n; ++i) moment += weight[i] * mu[i] * h[i];
    return 1.0 - 2.0 * root * moment;
}

}  // namespace

TEST_CASE("the subsurface colour of isotropic scattering is Chandrasekhar's spherical albedo",
          "[pipeline][layers]") {
    const std::vector<double> w{0.1, 0.5, 0.9, 0.99}, isotropic{0.0}, no_boundary{1.0};
    const auto colour = subsurface_colour(w, isotropic, no_boundary, {.tolerance = 1e-6});
    // The rule of the reference errs by 3e-5 with 200 points (a third of that of 100).
    for (std::size_t i = 0; i < w.size(); ++i)
        CHECK(std::abs(colour[i] - isotropic_spherical_albedo(w[i])) <= 1e-4);
}

TEST_CASE("a subsurface albedo gives the colour that it was asked for", "[pipeline][layers]") {
    std::vector<double> colour, g, n;
    for (const double c : {0.0, 1e-4, 0.1, 0.5, 0.9, 0.999, 1.0}) {
        for (const double asymmetry : {-0.3, 0.0, 0.9}) {
            for (const double index : {1.0, 1.33, 1.8}) {
                colour.push_back(c);
                g.push_back(asymmetry);
                n.push_back(index);
            }
        }
    }
    const auto albedo = subsurface_albedo(colour, g, n);
    const auto seen = subsurface_colour(albedo, g, n);
    for (std::size_t i = 0; i < colour.size(); ++i) {
        CAPTURE(colour[i], g[i], n[i], albedo[i]);
        CHECK(std::abs(seen[i] - colour[i]) <= 1e-5);  // a hundredth of the tolerance
        CHECK((albedo[i] >= 0.0 && albedo[i] <= 1.0));
    }
    // Below a boundary less comes out of the same medium, so that a colour needs more of it.
    CHECK(subsurface_albedo(std::vector{0.5}, std::vector{0.0}, std::vector{1.5})[0] >
          subsurface_albedo(std::vector{0.5}, std::vector{0.0}, std::vector{1.0})[0]);
    CHECK_THROWS_WITH(subsurface_albedo(std::vector{0.2, 1.2}, kZero, kOne),
                      Catch::Contains("colour[1]") && Catch::Contains("1.2"));
    CHECK_THROWS_WITH(subsurface_albedo(kOne, std::vector{1.5}, kOne), Catch::Contains("1.5"));
}
