// Half-spaces, bare, under a coat and under a refracting boundary: against closed forms and tables
// of another solver.
#include <fmt/format.h>
#include <boost/math/quadrature/tanh_sinh.hpp>

#include <algorithm>
#include <cmath>
#include <limits>
#include <optional>

#include "tools/bench/peers.h"
#include "tools/bench/scenes.h"
#include "tools/bench/suites.h"
#include "tools/bench/truth.h"

namespace miebrdf::bench {
namespace {

using rte::Directions;

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

/// A case without its truth, with the methods for layers.
BenchCase layer_case(const std::string& suite, const std::string& name, const std::string& quantity,
                     const std::string& truth, const rte::Stack& stack, const Directions& wanted) {
    BenchCase c{suite, name, quantity, truth, {}, {}, question_of(simple(stack), wanted)};
    add_library_methods(stack, wanted, c);
    if (!stack.coats.empty()) add_stepwise_coats(stack, wanted, c);
    add_outside_methods(stack, wanted, c);
    return c;
}

BenchCase isotropic() {
    const Directions wanted{{0.1, 0.3, 0.6, 1}, {0.1, 0.3, 0.6, 1}, {0}};
    BenchCase c =
        layer_case("half-space", "isotropic 0.9, R",
                   "R of an isotropic half-space, albedo 0.9, at cosines 0.1, 0.3, 0.6, 1.",
                   "Chandrasekhar's H-function by tanh-sinh quadrature, 13 digits.",
                   {scatterers(0.9, 0)}, wanted);
    for_each_direction(wanted, [&](double i, double o, double) {
        c.true_values.push_back(0.9 / (4 * (i + o)) * h_function(i, 0.9) * h_function(o, 0.9));
    });
    return c;
}

BenchCase conservative_albedo() {
    BenchCase c = layer_case(
        "half-space", "g 0.9, albedo 1, plane albedo",
        "Plane albedo of a Henyey-Greenstein half-space without absorption, g = 0.9.",
        "1: what is not absorbed comes back.", {scatterers(1, 0.9)}, {{0.1, 0.5, 1}, {}, {}});
    c.true_values = {1, 1, 1};
    return c;
}

/// R of a table whose rows have these numbers, and mu_o >= mu_i: R is reciprocal.
std::vector<double> from_table(const ReferenceData& table, const std::vector<Where>& which,
                               const Directions& wanted) {
    std::vector<double> values;
    for_each_direction(wanted, [&](double in, double out, double azimuth) {
        auto row = which;
        row.insert(
            row.end(),
            {{"mu_i", std::min(in, out)}, {"mu_o", std::max(in, out)}, {"phi_deg", azimuth}});
        values.push_back(table.number("R", row));
    });
    return values;
}

BenchCase peaked(double g, double albedo) {
    const Directions wanted{{0.2, 0.5, 0.9}, {0.2, 0.5, 0.9}, {0, 90, 180}};
    BenchCase c = layer_case(
        "half-space", fmt::format("g {}, albedo {}, R", g, albedo),
        "R of a Henyey-Greenstein half-space at cosines 0.2, 0.5, 0.9, azimuths 0, 90, 180.",
        "tests/reference/rte/R_halfspace_HG.csv, 10 digits or more, checked against CDISORT.",
        {scatterers(albedo, g)}, wanted);
    c.true_values =
        from_table(ReferenceData("rte/R_halfspace_HG.csv"), {{"g", g}, {"alpha", albedo}}, wanted);
    return c;
}

BenchCase coated(double albedo, double g, double depth, const std::vector<double>& cosines,
                 const char* remark) {
    const Directions wanted{cosines, cosines, {0, 90, 180}};
    BenchCase c = layer_case(
        "coat", fmt::format("coat {}/{}, depth {}{}", albedo, g, depth, remark),
        fmt::format(
            "R of a coat (albedo {}, g {}) of optical depth {} on a half-space (0.95, 0.7).",
            albedo, g, depth),
        "tests/reference/rte/R_coated_halfspace.csv, 10 digits or more, checked against CDISORT.",
        {.base = scatterers(0.95, 0.7), .coats = {{scatterers(albedo, g), depth}}}, wanted);
    c.true_values = from_table(ReferenceData("rte/R_coated_halfspace.csv"),
                               {{"coat_alpha", albedo}, {"coat_g", g}, {"tau", depth}}, wanted);
    return c;
}

double internal_reflectance(double index) {
    return ReferenceData("interface/diffuse_fresnel.csv").number("r_int", {{"n", index}});
}

/// The classics that people use instead of a solver with a boundary: what is known of diffuse light
/// inside, corrected at each incident cosine.
void add_classics(double index, const SimpleLayer& medium, std::optional<double> ground,
                  const rte::Stack& bare, const std::vector<double>& cosines, BenchCase& c) {
    const double inside = internal_reflectance(index);
    const auto at_cosines = [=](const auto& total) {
        std::vector<double> values;
        values.reserve(cosines.size());
        for (const double mu : cosines) values.push_back(total(fresnel(index, mu).reflectance));
        return values;
    };
    const auto corrected = [=](double body) {
        return at_cosines([=](double r) { return saunderson(body, r, inside); });
    };
    c.add("no boundary", "-", [=] { return rte::albedo(bare, cosines).plane_albedo; });
    const auto kubelka_munk = [=] {
        return ground ? kubelka_munk_film(medium, *ground) : kubelka_munk_reflectance({medium, {}});
    };
    if (kubelka_munk())
        c.add("Kubelka-Munk, Saunderson", "-", [=] { return corrected(*kubelka_munk()); });
    c.add_each("exact body, Saunderson", "tol={:.0e}", {1e-2, 1e-3}, [=](double tolerance) {
        return corrected(rte::albedo(bare, {1.0}, {.tolerance = tolerance}).spherical_albedo);
    });
    if (ground) return;
    c.add("diffusion, extrapolated boundary", "-", [=] {
        const double body = *diffusion_reflectance({medium, {}}, inside);
        return at_cosines([=](double r) { return r + (1 - r) * body; });
    });
}

/// A row of interface/slabs.csv: a film on a Lambertian ground, or a half-space.
BenchCase in_binder(const std::string& name, double index, double albedo, double g, double depth,
                    std::optional<double> ground) {
    const std::vector<double> cosines = {1.0, 0.5};
    BenchCase c{
        "boundary", name,
        fmt::format("Plane albedo at cosines 1 and .5, mirror reflection included, of "
                    "Henyey-Greenstein particles (albedo {}, g {}) in a binder of index {}.",
                    albedo, g, index),
        "tests/reference/interface/slabs.csv, 8 digits, checked against iad."};
    const ReferenceData table("interface/slabs.csv");
    const std::size_t row =
        table.row({{"n", index},
                   {"albedo", albedo},
                   {"g", g},
                   {"tau", depth},
                   {"base", !ground        ? "air"
                            : *ground == 0 ? "black"
                                           : fmt::format("lambert {:.1f}", *ground)}});
    c.true_values = {table.number(row, "UR1"), table.number(row, "A_mu_0.5")};
    const auto medium = rte::henyey_greenstein_optics(albedo, g);
    rte::Stack bare;
    if (ground) {
        bare.base_kind = rte::BaseKind::lambertian;
        bare.ground_albedo = *ground;
        bare.coats = {{medium, depth}};
    } else {
        bare.base = medium;
    }
    rte::Stack stack = bare;
    stack.boundary = rte::Boundary{};
    stack.base_index = index;
    for (rte::Coat& coat : stack.coats) coat.index = index;
    const Directions wanted{cosines, {}, {}};
    c.add_each("miebrdf", "tol={:.0e}", {1e-1, 1e-2, 1e-3, 1e-4, 1e-6},
               [=](double t) { return solved(stack, wanted, {.tolerance = t}); });
    // So small a tolerance that the number of nodes is what limits the error.
    c.add_each("closed form, refraction grid", "n={}", {4, 8, 12, 16, 24, 32},
               [=](int n) { return solved(stack, wanted, {.tolerance = 1e-10, .streams = n}); });
    add_classics(index, {albedo, g, depth}, ground, bare, cosines, c);
    c.add_each("Monte Carlo", "{} photons", {1000, 10000, 100000},
               [=, t = traced(stack)](int number) { return photons(t, wanted, number); });
    return c;
}

}  // namespace

std::vector<BenchCase> half_space_suite() {
    return {isotropic(),          peaked(0.5, 0.9),  peaked(0.75, 0.9),
            peaked(0.75, 0.9999), peaked(0.9, 0.99), conservative_albedo()};
}

std::vector<BenchCase> coat_suite() {
    // The coats of the paper's Table 2, logo 1: green and red.
    const std::vector<double> cosines = {0.2, 0.5, 0.9};
    return {coated(0.9, 0.46, 0.1, cosines, ""), coated(0.1, 0.54, 0.1, cosines, ""),
            coated(0.9, 0.46, 1, cosines, ""), coated(0.9, 0.46, 0.1, {0.05, 0.1}, ", grazing")};
}

std::vector<BenchCase> boundary_suite() {
    constexpr double kNoEnd = std::numeric_limits<double>::infinity();
    return {in_binder("half-space, n 1.5, albedo 0.9, g 0", 1.5, 0.9, 0, kNoEnd, {}),
            in_binder("half-space, n 1.33, albedo 0.99, g 0.875", 1.33, 0.99, 0.875, kNoEnd, {}),
            in_binder("film of depth 10 on black, n 1.5", 1.5, 0.98, 0.6, 10, 0.0),
            in_binder("film of depth 1 on white, n 1.5", 1.5, 0.98, 0.6, 1, 1.0)};
}

}  // namespace miebrdf::bench
