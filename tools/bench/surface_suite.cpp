// The share that a rough surface reflects of light from one direction: an integral over its lobe.
#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <complex>

#include <miebrdf/surface.h>
#include "rte/math/quadrature.h"
#include "tools/bench/photon_tracer.h"
#include "tools/bench/suites.h"
#include "tools/bench/truth.h"

namespace miebrdf::bench {
namespace {

constexpr std::array kMuIn = {0.1, 0.4, 0.7, 1.0};

// Integral of R_s mu_out over the outgoing hemisphere on Gauss nodes of mu_out and azimuth.
double by_product_rule(const rte::SurfaceLobe& lobe, double mu_in, int count) {
    const auto t = math::gauss_legendre(count, 0.0, 1.0);
    const auto azimuth = math::gauss_legendre(count, 0.0, 180.0);
    double sum = 0;
    for (std::size_t i = 0; i < t.nodes.size(); ++i) {
        const double mu = t.nodes[i];
        for (std::size_t j = 0; j < azimuth.nodes.size(); ++j) {
            sum += t.weights[i] * azimuth.weights[j] * mu * lobe.brdf(mu_in, mu, azimuth.nodes[j]);
        }
    }
    return 2 * M_PI / 180 * sum;
}

Answer by_chance(const rte::SurfaceLobe& lobe, int count) {
    Answer answer;
    for (const double mu_in : kMuIn) {
        RandomStream random(1, 0);
        double sum = 0, squares = 0;
        for (int i = 0; i < count; ++i) {
            const double mu = std::sqrt(random.uniform());  // density proportional to the cosine
            const double value = M_PI * lobe.brdf(mu_in, mu, 360 * random.uniform());
            sum += value;
            squares += value * value;
        }
        const double mean = sum / count;
        answer.add(mean, std::sqrt((squares / count - mean * mean) / (count - 1)));
    }
    return answer;
}

template <typename Rho>
std::vector<double> at_all(const Rho& rho) {
    std::vector<double> values(kMuIn.size());
    std::transform(kMuIn.begin(), kMuIn.end(), values.begin(), rho);
    return values;
}

BenchCase reflectance(double alpha, std::complex<double> index) {
    BenchCase c{"surface",
                fmt::format("rho, alpha {}, n {} k {}", alpha, index.real(), index.imag()),
                "Directional reflectance rho_dt at cosines 0.1, 0.4, 0.7, 1.",
                "the model's textbook formulas (Beckmann, Smith, Fresnel in complex arithmetic), "
                "written once more for this purpose, by adaptive Gauss-Kronrod quadrature of Boost "
                "to 1e-11."};
    rte::SurfaceOptions options;
    options.beckmann_alpha = alpha;
    const rte::SurfaceLobe lobe(index, options);
    c.true_values = at_all([&](double mu) { return textbook_reflectance(alpha, index, mu); });
    c.add_each("miebrdf", "tol={:.0e}", {1e-2, 1e-4, 1e-6, 1e-8}, [=](double t) {
        return at_all(
            [&](double mu) { return rte::directional_reflectance(index, options, mu, t).value; });
    });
    c.add_each("Gauss in mu_out and azimuth", "{0} x {0}", {8, 16, 32, 64, 128}, [=](int n) {
        return at_all([&](double mu) { return by_product_rule(lobe, mu, n); });
    });
    c.add_each("Monte Carlo", "{} rays", {1000, 10000, 100000},
               [=](int n) { return by_chance(lobe, n); });
    return c;
}

}  // namespace

std::vector<BenchCase> surface_suite() {
    // The roughness of the paper's figures and one of its logo; TiO2-like and a metal.
    return {reflectance(0.3, {2.6, 0.0}), reflectance(0.1, {1.5, 0.0}),
            reflectance(0.3, {0.2, 3.4})};
}

}  // namespace miebrdf::bench
