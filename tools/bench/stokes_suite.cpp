// The cost of polarisation and the error of leaving it out: the scalar solver, three and four
// Stokes components on the same media.
#include <fmt/format.h>

#include "rte/stack/layered_reflection.h"
#include "tools/bench/siewert_problem.h"
#include "tools/bench/suites.h"
#include "tools/bench/truth.h"

namespace miebrdf::bench {
namespace {

constexpr int kNodes[] = {4, 6, 8, 12, 16, 24, 32};

// The number of nodes is given: what is timed is one solution and the two coarser ones that its
// error is judged by.
rte::SolverOptions options_of(int nodes) { return {.tolerance = 1e-6, .streams = nodes}; }

void add(BenchCase& c, const std::string& method, const std::function<Answer(int nodes)>& run) {
    for (const int n : kNodes)
        c.contenders.push_back({method, fmt::format("n={}", n), [=] { return run(n); }});
}

/// R11 of a Rayleigh half-space, where polarisation matters most.
BenchCase half_space_case() {
    const ReferenceData table("rte/stokes_rayleigh_half_space.csv");
    const rte::Stack stack{.base = rte::rayleigh_optics(table.number(0, "albedo"))};
    const rte::Directions directions{{0.8, 0.2}, {1.0, 0.5, 0.1}, {0.0, 90.0, 180.0}};
    BenchCase c;
    c.suite = "stokes";
    c.name = "rayleigh-half-space";
    c.quantity = "R11 of a Rayleigh half-space of albedo 0.9 at 18 directions.";
    c.truth = "An independent closed form, 8 decimals.";
    for (const double mu_in : directions.mu_in)
        for (const double mu_out : directions.mu_out)
            for (const double azimuth_deg : directions.azimuth_deg)
                for (std::size_t row = 0; row < table.size(); ++row)
                    if (table.number(row, "mu_in") == mu_in &&
                        table.number(row, "mu_out") == mu_out &&
                        table.number(row, "azimuth_deg") == azimuth_deg)
                        c.true_values.push_back(table.number(row, "r11"));
    add(c, "scalar",
        [=](int n) { return rte::reflect(stack, directions, options_of(n)).reflection; });
    for (const int components : {3, 4}) {
        add(c, fmt::format("{} components", components), [=](int n) {
            const auto result =
                rte::reflect_polarised(stack, directions, components, options_of(n));
            const auto elements = std::size_t(components * components);
            std::vector<double> R11;
            for (std::size_t k = 0; k < result.reflection.size(); k += elements)
                R11.push_back(result.reflection[k]);
            return R11;
        });
    }
    return c;
}

/// A layer whose b2 couples V to U: four components take other equations there.
BenchCase layer_case() {
    rte::Stack stack{
        .coats = {{siewert_optics(ReferenceData("rte/stokes_siewert_2000.csv"), true), 1.0}}};
    stack.base_kind = rte::BaseKind::none;
    const double mu_in = 0.6;
    const rte::Directions one{{mu_in}, {0.5}, {90.0}};
    BenchCase c;
    c.suite = "stokes";
    c.name = "siewert-layer";
    c.quantity = "I, Q, U of light reflected by a layer of optical depth 1 at one direction.";
    c.truth = "Siewert 2000, problem IIA, six digits.";
    c.true_values = {0.124626, 0.00512123, 0.00804140};
    for (const int components : {3, 4}) {
        add(c, fmt::format("{} components", components), [=](int n) {
            const auto R = rte::reflect_polarised(stack, one, components, options_of(n)).reflection;
            const auto row = std::size_t(components);
            return std::vector<double>{mu_in * R[0], mu_in * R[row], mu_in * R[2 * row]};
        });
    }
    return c;
}

}  // namespace

std::vector<BenchCase> stokes_suite() { return {half_space_case(), layer_case()}; }

}  // namespace miebrdf::bench
