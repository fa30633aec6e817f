// Half-spaces, bare and under a coat: against closed forms and tables of another solver.
#include <fmt/format.h>
#include <boost/math/quadrature/tanh_sinh.hpp>

#include <algorithm>
#include <cmath>
#include <stdexcept>

#include "tools/bench/bench_scene.h"
#include "tools/bench/peers.h"
#include "tools/bench/suites.h"
#include "tools/bench/truth.h"

namespace miebrdf::bench {
namespace {

// ln H(mu) = -(mu/pi) int_0^{pi/2} ln(1 - a t cot t) / (cos^2 t + mu^2 sin^2 t) dt
// (Chandrasekhar 1960, ch. V, eq. 23 in another variable; tests/reference has 30 digits of it).
double h_function(double mu, double albedo) {
    boost::math::quadrature::tanh_sinh<double> integrator;
    const auto integrand = [&](double t) {
        const double c = std::cos(t), s = std::sin(t);
        const double t_cot = t < 1e-8 ? 1.0 : t * c / s;
        return std::log(1 - albedo * t_cot) / (c * c + mu * mu * s * s);
    };
    return std::exp(-mu / M_PI * integrator.integrate(integrand, 0.0, M_PI / 2, 1e-14));
}

BenchCase isotropic() {
    BenchCase c;
    c.suite = "half-space";
    c.name = "isotropic 0.9, R";
    c.quantity = "R of an isotropic half-space, albedo 0.9, at cosines 0.1, 0.3, 0.6, 1.";
    c.truth = "Chandrasekhar's H-function by tanh-sinh quadrature, 13 digits.";
    const Wanted wanted{{0.1, 0.3, 0.6, 1}, {0.1, 0.3, 0.6, 1}, {0}};
    for (const double i : wanted.mu_in) {
        for (const double o : wanted.mu_out) {
            c.true_values.push_back(0.9 / (4 * (i + o)) * h_function(i, 0.9) * h_function(o, 0.9));
        }
    }
    const BenchScene scene{{0.9, 0, 0}, {}};
    c.question = question_of(scene, wanted);
    c.contenders = all_methods(scene, wanted);
    return c;
}

BenchCase conservative_albedo() {
    BenchCase c;
    c.suite = "half-space";
    c.name = "g 0.9, albedo 1, plane albedo";
    c.quantity = "Plane albedo of a Henyey-Greenstein half-space without absorption, g = 0.9.";
    c.truth = "1: what is not absorbed comes back.";
    const Wanted wanted{{0.1, 0.5, 1}, {}, {}};
    c.true_values = {1, 1, 1};
    const BenchScene scene{{1.0, 0.9, 0}, {}};
    c.question = question_of(scene, wanted);
    c.contenders = all_methods(scene, wanted);
    return c;
}

double from_table(const ReferenceData& table, double g, double albedo, double in, double out,
                  double azimuth) {
    // The table lists mu_o >= mu_i; R is reciprocal.
    for (std::size_t row = 0; row < table.size(); ++row) {
        if (table.number(row, "g") == g && table.number(row, "alpha") == albedo &&
            table.number(row, "mu_i") == std::min(in, out) &&
            table.number(row, "mu_o") == std::max(in, out) &&
            table.number(row, "phi_deg") == azimuth) {
            return table.number(row, "R");
        }
    }
    throw std::logic_error("reference table lacks a direction");
}

BenchCase peaked(double g, double albedo) {
    BenchCase c;
    c.suite = "half-space";
    c.name = fmt::format("g {}, albedo {}, R", g, albedo);
    c.quantity =
        "R of a Henyey-Greenstein half-space at cosines 0.2, 0.5, 0.9, azimuths 0, 90, 180.";
    c.truth = "tests/reference/rte/R_halfspace_HG.csv, 10 digits or more, checked against CDISORT.";
    const Wanted wanted{{0.2, 0.5, 0.9}, {0.2, 0.5, 0.9}, {0, 90, 180}};
    const ReferenceData table("rte/R_halfspace_HG.csv");
    for (const double i : wanted.mu_in) {
        for (const double o : wanted.mu_out) {
            for (const double a : wanted.azimuth_deg) {
                c.true_values.push_back(from_table(table, g, albedo, i, o, a));
            }
        }
    }
    const BenchScene scene{{albedo, g, 0}, {}};
    c.question = question_of(scene, wanted);
    c.contenders = all_methods(scene, wanted);
    return c;
}

}  // namespace

std::vector<BenchCase> half_space_suite() {
    return {isotropic(),          peaked(0.5, 0.9),  peaked(0.75, 0.9),
            peaked(0.75, 0.9999), peaked(0.9, 0.99), conservative_albedo()};
}

namespace {

BenchCase coated(const char* coat, double tau, const std::vector<double>& cosines,
                 const char* remark) {
    const ReferenceData table("rte/R_coated_halfspace.csv");
    BenchCase c;
    c.suite = "coat";
    const Wanted wanted{cosines, cosines, {0, 90, 180}};
    BenchScene scene{{0.95, 0.7, 0}, SimpleLayer{}};
    for (const double i : wanted.mu_in) {
        for (const double o : wanted.mu_out) {
            for (const double a : wanted.azimuth_deg) {
                for (std::size_t row = 0; row < table.size(); ++row) {
                    if (table.text(row, "coat") != coat || table.number(row, "tau") != tau ||
                        table.number(row, "mu_i") != std::min(i, o) ||
                        table.number(row, "mu_o") != std::max(i, o) ||
                        table.number(row, "phi_deg") != a) {
                        continue;
                    }
                    scene.coat = SimpleLayer{table.number(row, "coat_alpha"),
                                             table.number(row, "coat_g"), tau};
                    c.true_values.push_back(table.number(row, "R"));
                    break;
                }
            }
        }
    }
    const std::size_t wanted_count = cosines.size() * cosines.size() * 3;
    if (c.true_values.size() != wanted_count)
        throw std::logic_error("reference table lacks a direction");
    c.name = fmt::format("coat {}/{}, depth {}{}", scene.coat->single_scattering_albedo,
                         scene.coat->asymmetry, tau, remark);
    c.quantity = fmt::format(
        "R of a coat (albedo {}, g {}) of optical depth {} on a half-space (0.95, 0.7).",
        scene.coat->single_scattering_albedo, scene.coat->asymmetry, tau);
    c.truth =
        "tests/reference/rte/R_coated_halfspace.csv, 10 digits or more, checked against CDISORT.";
    c.question = question_of(scene, wanted);
    c.contenders = library_methods(scene, wanted);
    for (auto& more : stepwise_coats(scene, wanted)) c.contenders.push_back(std::move(more));
    for (auto& more : outside_methods(scene, wanted)) c.contenders.push_back(std::move(more));
    return c;
}

// Names of the first white and the first dark coat in the table.
std::string name_of(double albedo, double g) {
    const ReferenceData table("rte/R_coated_halfspace.csv");
    for (std::size_t row = 0; row < table.size(); ++row) {
        if (table.number(row, "coat_alpha") == albedo && table.number(row, "coat_g") == g) {
            return table.text(row, "coat");
        }
    }
    throw std::logic_error("reference table lacks a coat");
}

}  // namespace

std::vector<BenchCase> coat_suite() {
    // The coats of the paper's Table 2, logo 1: green and red.
    const std::string bright = name_of(0.9, 0.46), dark = name_of(0.1, 0.54);
    return {coated(bright.c_str(), 0.1, {0.2, 0.5, 0.9}, ""),
            coated(dark.c_str(), 0.1, {0.2, 0.5, 0.9}, ""),
            coated(bright.c_str(), 1, {0.2, 0.5, 0.9}, ""),
            coated(bright.c_str(), 0.1, {0.05, 0.1}, ", grazing")};
}

}  // namespace miebrdf::bench
