// No jump where radiative transfer changes its discretisation, and no false claim where the search
// for more nodes is given up.
#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include <miebrdf/brdf.h>
#include "pipeline/solve/scene_optics.h"
#include "rte/grid/discretisation.h"
#include "rte/phase/scaled_medium.h"
#include "rte/stack/hidden_layers.h"
#include "rte/stack/layered_reflection.h"
#include "tools/bench/truth.h"
#include "tools/stress/battery.h"

namespace miebrdf::stress {
namespace {

using bench::ReferenceData;

const rte::Directions kDirections{{0.3}, {0.1, 0.5, 1.0}, {0, 60, 180}};

rte::Stack medium(double g) { return {rte::henyey_greenstein_optics(0.95, g)}; }

void compare(Log& log, const std::string& name, const SwitchPoint& g,
             const rte::SolverOptions& options) {
    log.run(name, [&](const Case& is) {
        const auto a = rte::reflect(medium(g.below), kDirections, options),
                   b = rte::reflect(medium(g.above), kDirections, options);
        is.at_most("jump of R over the largest", largest_jump(a.reflection, b.reflection),
                   a.report.error_estimate + b.report.error_estimate,
                   "two discretisations of one medium, each as good as its own estimate");
    });
}

// The cutoff of delta-M softens moment by moment as the peak grows (peak_strength), and fewer
// moments are kept.
void check_soft_cutoff(Log& log, bool fast) {
    for (const int n : {8, 16, 32}) {
        if (fast && n > 16) continue;
        const rte::SolverOptions solver{.streams = n};
        const auto cutoff = [&](double g) {
            const auto stack = medium(g);
            const int moments = rte::choose_discretisation(stack, solver, n).moments;
            return 1000L * moments + rte::scale_optics(stack.base, moments, true).first_cutoff;
        };
        for (const auto& g : find_switches(0.3, 0.99, 200, cutoff)) {
            compare(log, fmt::format("soft cutoff, {} nodes, g {:.6f}", n, g.below), g, solver);
        }
    }
}

void check_automatic_nodes(Log& log) {
    for (const double tolerance : {1e-2, 1e-3, 1e-5}) {
        const rte::SolverOptions solver{.tolerance = tolerance};
        const auto nodes = [&](double g) {
            const auto report = rte::reflect(medium(g), kDirections, solver).report;
            return 2L * report.streams + report.converged;
        };
        for (const auto& g : find_switches(0.3, 0.97, 15, nodes)) {
            compare(log, fmt::format("other nodes, tolerance {:.0e}, g {:.6f}", tolerance, g.below),
                    g, solver);
        }
    }
}

// Along the horizon a forward peak cannot be resolved and the ladder of nodes is left: what is
// returned must say so.
void check_stalls(Log& log) {
    const ReferenceData table("rte/R_halfspace_HG.csv");
    for (std::size_t row = 0; row < table.size(); ++row) {
        const double in = table.number(row, "mu_i"), azimuth = table.number(row, "phi_deg");
        const double g = table.number(row, "g"), albedo = table.number(row, "alpha");
        const double out = table.number(row, "mu_o");
        if (!(g == 0.9 && in == 0.05 && out < 0.6 && azimuth <= 30)) continue;
        log.run(
            fmt::format("grazing, g {}, albedo {}, {} {} {}", g, albedo, in, out, azimuth),
            [&](const Case& is) {
                rte::Stack stack{rte::henyey_greenstein_optics(albedo, g)};
                const auto r = rte::reflect(stack, {{in}, {out}, {azimuth}}, {.tolerance = 1e-5});
                const double error = relative_difference(r.reflection[0], table.number(row, "R"));
                is.at_most("error", error, r.report.converged ? 1e-5 : 2 * r.report.error_estimate,
                           r.report.converged
                               ? "the tolerance that was asked for"
                               : "flagged; the step from 2n/3 to n nodes is at least "
                                 "half of what an error that falls like 1/n has left");
            });
    }
}

// A coat that hides its base: the base is left out from some depth on.
void check_hidden_base(Log& log) {
    for (const char* paint : {"hg:0.5,0.5", "hg:0.9,0.8", "isotropic:0.99"}) {
        for (const double tolerance : {1e-2, 1e-4}) {
            log.run(
                fmt::format("base hidden by {}, tolerance {:.0e}", paint, tolerance),
                [&](const Case& is) {
                    const rte::SolverOptions solver{.tolerance = tolerance, .streams = 16};
                    const auto coated = [&](double depth) {
                        Scene scene;
                        scene.base = miebrdf::medium("isotropic:1");
                        scene.layers = {layer(fmt::format("{}@{:.17g}", paint, depth))};
                        return scene;
                    };
                    const auto coat = compute_optics(resolve(coated(1), {550}), 1, 0,
                                                     demand_of(solver, 0.0, PhaseDemand::whole))
                                          .optics;
                    const auto hidden = [&](double depth) {
                        return long(rte::hides_what_is_below(coat, depth, kDirections, tolerance));
                    };
                    const auto found = find_switches(0.1, 1e3, 30, hidden);
                    is.at_most("depths from which the base is left out, minus 1",
                               std::abs(double(found.size()) - 1), 0, "deeper coats hide more");
                    for (const SwitchPoint& depth : found) {
                        const auto at = [&](double d) {
                            return solve(coated(d), {550}, solver, {.threads = 1})
                                .evaluate(kDirections)
                                .slices.at(0)
                                .total;
                        };
                        is.at_most("jump of the BRDF over the largest",
                                   largest_jump(at(depth.below), at(depth.above)), 0.1 * tolerance,
                                   "what lies below shows by a tenth of the tolerance at most");
                    }
                });
        }
    }
}

// At the zenith order 0 is all there is; beside it the others are summed.
void check_zenith(Log& log) {
    for (const double g : {0.0, 0.5, 0.9}) {
        log.run(fmt::format("orders begin beside the zenith, g {}", g), [&](const Case& is) {
            const rte::SolverOptions solver{.tolerance = 1e-6, .streams = 16};
            const rte::Directions at{{1}, {0.3, 0.7}, {0, 180}},
                beside{{std::nextafter(1.0, 0)}, {0.3, 0.7}, {0, 180}};
            is.at_most("jump of R over the largest",
                       largest_jump(rte::reflect(medium(g), at, solver).reflection,
                                    rte::reflect(medium(g), beside, solver).reflection),
                       1e-7 + 3e-8 / (1 - g), "an angle of 1.5e-8 times the slope of P and R");
        });
    }
}

}  // namespace

void transfer_switches(Log& log, bool fast) {
    check_soft_cutoff(log, fast);
    check_hidden_base(log);
    check_zenith(log);
    if (fast) return;
    check_automatic_nodes(log);
    check_stalls(log);
}

}  // namespace miebrdf::stress
