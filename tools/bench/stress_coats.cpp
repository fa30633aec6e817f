// Coats from 1e-12 to 1e12 optical depths, alike and unlike what they lie on.
#include <fmt/format.h>

#include <cmath>

#include "rte/stack/layered_reflection.h"
#include "tools/bench/reference_data.h"
#include "tools/bench/stress.h"

namespace miebrdf::bench {
namespace {

const std::vector<double> kCosines = {0.05, 0.3, 1.0};
// The tolerance decides how many azimuthal orders are summed: here none may be missing.
const rte::SolverOptions kSolver{.tolerance = 1e-13, .streams = 16};

rte::Optics optics(double albedo, double g) {
    return g == 0 ? rte::isotropic_optics(albedo) : rte::henyey_greenstein_optics(albedo, g);
}

rte::Stack on(const rte::Optics& base, const rte::Optics& coat, double depth) {
    rte::Stack stack;
    stack.base = base;
    if (depth > 0) stack.coats.push_back({coat, depth});
    return stack;
}

double largest_difference(const std::vector<double>& a, const std::vector<double>& b) {
    double worst = 0;
    for (std::size_t i = 0; i < a.size(); ++i) {
        const double d = relative_difference(a[i], b[i]);
        if (!(d <= worst)) worst = d;
    }
    return worst;
}

std::vector<double> reflection(const rte::Stack& stack) {
    return rte::reflect(stack, {kCosines, kCosines, {0, 180}}, kSolver).reflection;
}

constexpr double kDepths[] = {1e-12, 1e-8, 1e-4, 1e-2, 1, 10, 1e3, 1e6, 1e12};

void check_same_material(StressLog& log) {
    for (const double albedo : {0.5, 0.99, 1.0}) {
        const auto medium = optics(albedo, 0.6);
        const auto bare = reflection(on(medium, medium, 0));
        for (const double depth : kDepths) {
            const std::string name =
                fmt::format("coat of the base's material, albedo {}, depth {:.0e}", albedo, depth);
            log.run(name, [&] {
                log.at_most(name, "R against the bare base, relative",
                            largest_difference(reflection(on(medium, medium, depth)), bare), 1e-9,
                            "the same half-space; rounding of the impedances, 6e-12 as measured by "
                            "its authors");
            });
        }
    }
}

void check_black_coat(StressLog& log) {
    const auto base = optics(0.95, 0.7);
    const auto bare = reflection(on(base, base, 0));
    for (const double depth : kDepths) {
        const std::string name = fmt::format("black coat of depth {:.0e}", depth);
        log.run(name, [&] {
            const auto coated = reflection(on(base, optics(0, 0), depth));
            double worst = 0, scale = 0;
            std::size_t at = 0;
            for (const double i : kCosines) {
                for (const double o : kCosines) {
                    for (int a = 0; a < 2; ++a, ++at) {
                        const double truth = bare[at] * std::exp(-depth * (1 / i + 1 / o));
                        worst = std::max(worst, std::abs(coated[at] - truth));
                        scale = std::max(scale, truth);
                    }
                }
            }
            log.at_most(name, "R against Beer's law, over the largest",
                        scale > 1e-290 ? worst / scale : worst, 1e-10,
                        "closed form exp(-tau (1/mu_in + 1/mu_out)); rounding");
        });
    }
}

void check_limits(StressLog& log) {
    const auto base = optics(0.95, 0.7), coat = optics(0.5, 0.3);
    const auto bare = reflection(on(base, base, 0)), thick = reflection(on(coat, coat, 0));
    for (const double depth : {1e-12, 1e-10, 1e-8, 1e-6}) {
        const std::string name = fmt::format("thin coat of depth {:.0e}", depth);
        log.run(name, [&] {
            // First order in the depth: (1/mu + 1/mu') and the peak of P over R at most.
            log.at_most(name, "R against the bare base, relative",
                        largest_difference(reflection(on(base, coat, depth)), bare),
                        3e3 * depth + 1e-10, "first order in the depth over mu; rounding");
        });
    }
    for (const double depth : {1e2, 1e4, 1e8, 1e12, double(INFINITY)}) {
        const std::string name = fmt::format("thick coat of depth {:.0e}", depth);
        log.run(name, [&] {
            log.at_most(name, "R against a half-space of it, relative",
                        largest_difference(reflection(on(base, coat, depth)), thick), 1e-10,
                        "the base is dimmed by exp(-2 k tau) < 1e-60; rounding");
        });
    }
}

void check_energy(StressLog& log) {
    for (const double g : {-0.9, 0.0, 0.9}) {
        for (const double depth : kDepths) {
            const std::string name = fmt::format("white on white, g {}, depth {:.0e}", g, depth);
            log.run(name, [&] {
                const auto a =
                    rte::albedo(on(optics(1, 0.5), optics(1, g), depth), kCosines, kSolver);
                double worst = 0;
                for (const double plane : a.plane_albedo)
                    worst = std::max(worst, std::abs(plane - 1));
                log.at_most(name, "1 - plane albedo", worst, 1e-9,
                            "energy; quadrature between 16 mapped nodes");
                log.at_most(name, "1 - spherical albedo", std::abs(a.spherical_albedo - 1), 1e-10,
                            "energy; rounding");
            });
        }
    }
    for (const double depth : kDepths) {
        const std::string name = fmt::format("dark on white, depth {:.0e}", depth);
        log.run(name, [&] {
            const auto a =
                rte::albedo(on(optics(1, 0.5), optics(0.1, 0.5), depth), kCosines, kSolver);
            double worst = 0;
            for (const double plane : a.plane_albedo) worst = std::max(worst, outside(plane, 0, 1));
            log.at_most(name, "plane albedo outside [0, 1]", worst, 1e-12, "energy; rounding");
        });
    }
}

void check_continuity(StressLog& log) {
    const auto base = optics(0.95, 0.7), coat = optics(0.9, 0.46);
    for (const double depth : {1e-8, 1e-3, 0.1, 1.0, 5.0, 20.0, 100.0}) {
        const std::string name = fmt::format("step of 1e-9 at depth {:.0e}", depth);
        log.run(name, [&] {
            const auto a = reflection(on(base, coat, depth)),
                       b = reflection(on(base, coat, depth * (1 + 1e-9)));
            // d ln R / d ln tau is at most tau (1/mu + 1/mu') where light still comes through,
            // and 1.
            log.at_most(name, "R, relative change", largest_difference(a, b), 1e-7,
                        "slope below 40 times a step of 1e-9; rounding");
        });
    }
    for (const double difference : {1e-15, 1e-12, 1e-9}) {
        const std::string name = fmt::format("layers that differ by {:.0e} in albedo", difference);
        log.run(name, [&] {
            const auto a = reflection(on(optics(0.9, 0.5), optics(0.9, 0.5), 1)),
                       b = reflection(on(optics(0.9, 0.5), optics(0.9 - difference, 0.5), 1));
            log.at_most(name, "R, relative change", largest_difference(a, b),
                        20 * difference + 1e-10, "d ln R / d albedo below 20; rounding");
        });
    }
}

void check_reference(StressLog& log) {
    const ReferenceData table("rte/R_stress_grazing_thin_conservative.csv");
    for (std::size_t row = 0; row < table.size(); ++row) {
        if (table.text(row, "mu_o") == "plane_albedo") continue;
        const double depth = table.number(row, "coat_tau");
        const double in = table.number(row, "mu_i"), out = table.number(row, "mu_o");
        const std::string name = fmt::format("{}, {} {} {}", table.text(row, "case"), in, out,
                                             table.text(row, "phi_deg"));
        log.run(name, [&] {
            auto stack =
                on(optics(table.number(row, "base_alpha"), table.number(row, "base_g")),
                   optics(table.number(row, "coat_alpha"), table.number(row, "coat_g")), depth);
            // The column has too few digits for this one; the name says it.
            if (table.text(row, "case") == "iso_1-1e-9") {
                stack.base = optics(1 - 1e-9, 0);
                stack.base.one_minus_albedo = 1e-9;
            }
            const auto r = rte::reflect(stack, {{in}, {out}, {table.number(row, "phi_deg")}},
                                        {.tolerance = 1e-9, .streams = 64});
            log.at_most(name, "R against the table, relative",
                        relative_difference(r.reflection[0], table.number(row, "R")),
                        1e-8 + 2 * table.number(row, "dev_quad"),
                        "64 nodes at grazing; digits of the table");
        });
    }
}

}  // namespace

void stress_coats(const StressOptions& options, std::vector<StressCheck>& checks) {
    StressLog log("coats", checks);
    check_same_material(log);
    check_black_coat(log);
    check_limits(log);
    check_energy(log);
    check_continuity(log);
    if (!options.fast) check_reference(log);
}

}  // namespace miebrdf::bench
