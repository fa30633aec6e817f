// The cost of polarisation and the error of leaving it out: the scalar solver, three and four
// Stokes components on the same media.
#include <fmt/format.h>

#include "tools/bench/scenes.h"
#include "tools/bench/siewert_problem.h"
#include "tools/bench/suites.h"
#include "tools/bench/truth.h"

namespace miebrdf::bench {
namespace {

/// The number of nodes is given: what is timed is one solution and the two coarser ones that its
/// error is judged by.
/// @param pick  takes the wanted values from a reflection table
template <typename Pick>
void add(BenchCase& c, int components, const rte::Stack& stack, const rte::Directions& directions,
         const Pick& pick) {
    c.add_each(
        components == 1 ? "scalar" : fmt::format("{} components", components), "n={}",
        {4, 6, 8, 12, 16, 24, 32}, [=](int n) {
            const rte::SolverOptions options{.tolerance = 1e-6, .streams = n};
            return pick(
                components == 1
                    ? rte::reflect(stack, directions, options).reflection
                    : rte::reflect_polarised(stack, directions, components, options).reflection);
        });
}

/// R11 of a Rayleigh half-space, where polarisation matters most.
BenchCase half_space_case() {
    const ReferenceData table("rte/stokes_rayleigh_half_space.csv");
    const rte::Stack stack{.base = rte::rayleigh_optics(table.number(0, "albedo"))};
    const rte::Directions directions{{0.8, 0.2}, {1.0, 0.5, 0.1}, {0.0, 90.0, 180.0}};
    BenchCase c{"stokes", "rayleigh-half-space",
                "R11 of a Rayleigh half-space of albedo 0.9 at 18 directions.",
                "An independent closed form, 8 decimals."};
    for_each_direction(directions, [&](double mu_in, double mu_out, double azimuth_deg) {
        c.true_values.push_back(table.number(
            "r11", {{"mu_in", mu_in}, {"mu_out", mu_out}, {"azimuth_deg", azimuth_deg}}));
    });
    for (const int components : {1, 3, 4}) {
        add(c, components, stack, directions, [=](const std::vector<double>& R) {
            std::vector<double> R11;
            for (std::size_t k = 0; k < R.size(); k += std::size_t(components * components))
                R11.push_back(R[k]);
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
    BenchCase c{"stokes",
                "siewert-layer",
                "I, Q, U of light reflected by a layer of optical depth 1 at one direction.",
                "Siewert 2000, problem IIA, six digits.",
                {0.124626, 0.00512123, 0.00804140}};
    const double mu_in = 0.6;
    for (const std::size_t row : {3, 4}) {
        add(c, int(row), stack, {{mu_in}, {0.5}, {90.0}}, [=](const std::vector<double>& R) {
            return std::vector<double>{mu_in * R[0], mu_in * R[row], mu_in * R[2 * row]};
        });
    }
    return c;
}

}  // namespace

std::vector<BenchCase> stokes_suite() { return {half_space_case(), layer_case()}; }

}  // namespace miebrdf::bench
