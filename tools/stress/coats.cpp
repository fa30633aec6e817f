// Coats from 1e-12 to 1e12 optical depths, alike and unlike what they lie on.
#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "tools/bench/scenes.h"
#include "tools/bench/truth.h"
#include "tools/stress/battery.h"

namespace miebrdf::stress {
namespace {

using bench::scatterers;

const rte::Directions kDirections{{0.05, 0.3, 1.0}, {0.05, 0.3, 1.0}, {0, 180}};
// The tolerance decides how many azimuthal orders are summed: here none may be missing.
const rte::SolverOptions kSolver{.tolerance = 1e-13, .streams = 16};
constexpr double kDepths[] = {1e-12, 1e-8, 1e-4, 1e-2, 1, 10, 1e3, 1e6, 1e12};

rte::Stack on(const rte::Optics& base, const rte::Optics& coat, double depth) {
    rte::Stack stack{base};
    if (depth > 0) stack.coats.push_back({coat, depth});
    return stack;
}

std::vector<double> reflection(const rte::Stack& stack) {
    return rte::reflect(stack, kDirections, kSolver).reflection;
}

/// R must be that of other layers.
void compare(Log& log, const std::string& name, const char* quantity, const rte::Stack& stack,
             const std::vector<double>& truth, double bound, const char* cause) {
    log.run(name, [&](const Case& is) {
        is.at_most(quantity, largest_difference(reflection(stack), truth), bound, cause);
    });
}

void check_same_material(Log& log) {
    for (const double albedo : {0.5, 0.99, 1.0}) {
        const auto medium = scatterers(albedo, 0.6);
        const auto bare = reflection({medium});
        for (const double depth : kDepths) {
            compare(
                log,
                fmt::format("coat of the base's material, albedo {}, depth {:.0e}", albedo, depth),
                "R against the bare base, relative", on(medium, medium, depth), bare, 1e-9,
                "the same half-space; rounding of the impedances, 6e-12 as measured by its "
                "authors");
        }
    }
}

void check_black_coat(Log& log) {
    const auto base = scatterers(0.95, 0.7);
    const auto bare = reflection({base});
    for (const double depth : kDepths) {
        log.run(fmt::format("black coat of depth {:.0e}", depth), [&](const Case& is) {
            const auto coated = reflection(on(base, scatterers(0, 0), depth));
            double worst = 0, scale = 0;
            std::size_t at = 0;
            bench::for_each_direction(kDirections, [&](double i, double o, double) {
                const double truth = bare[at] * std::exp(-depth * (1 / i + 1 / o));
                worst = std::max(worst, std::abs(coated[at++] - truth));
                scale = std::max(scale, truth);
            });
            is.at_most("R against Beer's law, over the largest",
                       scale > 1e-290 ? worst / scale : worst, 1e-10,
                       "closed form exp(-tau (1/mu_in + 1/mu_out)); rounding");
        });
    }
}

void check_limits(Log& log) {
    const auto base = scatterers(0.95, 0.7), coat = scatterers(0.5, 0.3);
    const auto bare = reflection({base}), thick = reflection({coat});
    // First order in the depth: (1/mu + 1/mu') and the peak of P over R at most.
    for (const double depth : {1e-12, 1e-10, 1e-8, 1e-6})
        compare(log, fmt::format("thin coat of depth {:.0e}", depth),
                "R against the bare base, relative", on(base, coat, depth), bare,
                3e3 * depth + 1e-10, "first order in the depth over mu; rounding");
    for (const double depth : {1e2, 1e4, 1e8, 1e12, double(INFINITY)})
        compare(log, fmt::format("thick coat of depth {:.0e}", depth),
                "R against a half-space of it, relative", on(base, coat, depth), thick, 1e-10,
                "the base is dimmed by exp(-2 k tau) < 1e-60; rounding");
}

void check_energy(Log& log) {
    const auto albedos = [](const rte::Stack& stack) {
        return rte::albedo(stack, kDirections.mu_in, kSolver);
    };
    for (const double g : {-0.9, 0.0, 0.9}) {
        for (const double depth : kDepths) {
            log.run(fmt::format("white on white, g {}, depth {:.0e}", g, depth),
                    [&](const Case& is) {
                        const auto a = albedos(on(scatterers(1, 0.5), scatterers(1, g), depth));
                        is.at_most("1 - plane albedo",
                                   worst(a.plane_albedo, [](double A) { return std::abs(A - 1); }),
                                   1e-9, "energy; quadrature between 16 mapped nodes");
                        is.at_most("1 - spherical albedo", std::abs(a.spherical_albedo - 1), 1e-10,
                                   "energy; rounding");
                    });
        }
    }
    for (const double depth : kDepths) {
        log.run(fmt::format("dark on white, depth {:.0e}", depth), [&](const Case& is) {
            const auto a = albedos(on(scatterers(1, 0.5), scatterers(0.1, 0.5), depth));
            is.at_most("plane albedo outside [0, 1]",
                       worst(a.plane_albedo, [](double A) { return outside(A, 0, 1); }), 1e-12,
                       "energy; rounding");
        });
    }
}

void check_continuity(Log& log) {
    const auto base = scatterers(0.95, 0.7), coat = scatterers(0.9, 0.46);
    // d ln R / d ln tau is at most tau (1/mu + 1/mu') where light still comes through, and 1.
    for (const double depth : {1e-8, 1e-3, 0.1, 1.0, 5.0, 20.0, 100.0})
        compare(log, fmt::format("step of 1e-9 at depth {:.0e}", depth), "R, relative change",
                on(base, coat, depth), reflection(on(base, coat, depth * (1 + 1e-9))), 1e-7,
                "slope below 40 times a step of 1e-9; rounding");
    const auto medium = scatterers(0.9, 0.5);
    for (const double difference : {1e-15, 1e-12, 1e-9})
        compare(log, fmt::format("layers that differ by {:.0e} in albedo", difference),
                "R, relative change", on(medium, medium, 1),
                reflection(on(medium, scatterers(0.9 - difference, 0.5), 1)),
                20 * difference + 1e-10, "d ln R / d albedo below 20; rounding");
}

void check_reference(Log& log) {
    const bench::ReferenceData table("rte/R_stress_grazing_thin_conservative.csv");
    for (std::size_t row = 0; row < table.size(); ++row) {
        if (table.text(row, "mu_o") == "plane_albedo") continue;
        const auto number = [&](const char* column) { return table.number(row, column); };
        const double in = number("mu_i"), out = number("mu_o");
        log.run(fmt::format("{}, {} {} {}", table.text(row, "case"), in, out,
                            table.text(row, "phi_deg")),
                [&](const Case& is) {
                    auto stack =
                        on(scatterers(number("base_alpha"), number("base_g")),
                           scatterers(number("coat_alpha"), number("coat_g")), number("coat_tau"));
                    // The column has too few digits for this one; the name says it.
                    if (table.text(row, "case") == "iso_1-1e-9") {
                        stack.base = scatterers(1 - 1e-9, 0);
                        stack.base.one_minus_albedo = 1e-9;
                    }
                    const auto r = rte::reflect(stack, {{in}, {out}, {number("phi_deg")}},
                                                {.tolerance = 1e-9, .streams = 64});
                    is.at_most("R against the table, relative",
                               relative_difference(r.reflection[0], number("R")),
                               1e-8 + 2 * number("dev_quad"),
                               "64 nodes at grazing; digits of the table");
                });
    }
}

}  // namespace

void coats(Log& log, bool fast) {
    check_same_material(log);
    check_black_coat(log);
    check_limits(log);
    check_energy(log);
    check_continuity(log);
    if (!fast) check_reference(log);
}

}  // namespace miebrdf::stress
