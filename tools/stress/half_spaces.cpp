// Half-spaces from black to white, backward to sharply forward, at grazing cosines.
#include <fmt/format.h>

#include <cmath>

#include "rte/stack/layered_reflection.h"
#include "tools/bench/truth.h"
#include "tools/stress/battery.h"

namespace miebrdf::stress {
namespace {

using bench::ReferenceData;

const std::vector<double> kCosines = {1e-6, 1e-3, 0.1, 0.5, 1.0};

/// Absorption as its own number: 1 - 1e-15 is not lost in rounding.
rte::Stack medium(double one_minus_albedo, double g) {
    rte::Stack stack;
    stack.base = rte::henyey_greenstein_optics(1 - one_minus_albedo, g);
    stack.base.one_minus_albedo = one_minus_albedo;
    return stack;
}

void check_albedo(Log& log, double absorption, double g) {
    const std::string name = fmt::format("1 - albedo {:.0e}, g {}", absorption, g);
    log.run(name, [&] {
        const auto a = rte::albedo(medium(absorption, g), kCosines, {.streams = 16});
        for (std::size_t i = 0; i < kCosines.size(); ++i) {
            log.at_most(fmt::format("{}, mu {:.0e}", name, kCosines[i]),
                        "plane albedo outside [0, 1]", outside(a.plane_albedo[i], 0, 1), 1e-12,
                        "energy; rounding of 16 nodes");
        }
        if (absorption == 0) {
            for (std::size_t i = 2; i < kCosines.size(); ++i) {
                log.at_most(fmt::format("{}, mu {}", name, kCosines[i]),
                            "1 - plane albedo without absorption", std::abs(1 - a.plane_albedo[i]),
                            1e-11, "energy; rounding, amplified by 1 / (1 - g)");
            }
        }
    });
}

void check_reflection(Log& log, double absorption, double g) {
    const std::string name = fmt::format("R, 1 - albedo {:.0e}, g {}", absorption, g);
    log.run(name, [&] {
        const rte::Directions directions{kCosines, kCosines, {0, 90, 180}};
        const auto table = rte::reflect(medium(absorption, g), directions, {.streams = 16});
        const std::size_t n = kCosines.size();
        double negative = 0, unequal = 0;
        for (std::size_t i = 0; i < n; ++i) {
            for (std::size_t o = 0; o < n; ++o) {
                for (std::size_t a = 0; a < 3; ++a) {
                    const double r = table.reflection[(i * n + o) * 3 + a];
                    const double back = table.reflection[(o * n + i) * 3 + a];
                    negative += !(std::isfinite(r) && r >= 0);
                    unequal = std::max(unequal, relative_difference(r, back));
                }
            }
        }
        // Truncating the phase function may leave negative ripple where nothing is reflected: then
        // the report has to say that the tolerance was not met.
        log.at_most(name, "values negative or not finite without a warning",
                    table.report.converged ? negative : 0, 0,
                    "physics; or flagged as not converged");
        log.at_most(name, "R(i, o) - R(o, i), relative", unequal, 1e-9,
                    "symmetric by construction; sums of azimuths");
    });
}

// As absorption vanishes 1 - A falls as its square root, through every switch of methods.
void check_square_root_law(Log& log, double g) {
    double before = 0;
    for (int decade = 3; decade <= 15; ++decade) {
        const double absorption = std::pow(10.0, -decade);
        const std::string name =
            fmt::format("1 - albedo 1e-{} to 1e-{}, g {}", decade - 1, decade, g);
        log.run(name, [&] {
            const double lost =
                1 - rte::albedo(medium(absorption, g), {0.5}, {.streams = 16}).plane_albedo[0];
            if (before > 0) {
                // Next term of the expansion in sqrt(absorption / (1 - g)); rounding of 1 - A.
                const double bound = 8 * std::sqrt(10 * absorption / (1 - g)) + 1e-12 / lost;
                log.at_most(name, "(1 - A) ratio over sqrt(10), minus 1",
                            std::abs(before / lost / std::sqrt(10.0) - 1), bound,
                            "van de Hulst's expansion; rounding of 1 - A");
            }
            before = lost;
        });
    }
}

void check_nodes(Log& log, const Options& options) {
    for (const int n : {2, 3, 4, 5, 8, 16, 32, 64, 128, 256}) {
        if (options.fast && n > 64) continue;
        for (const auto grid :
             {rte::GridKind::gauss, rte::GridKind::mapped_gauss, rte::GridKind::paper}) {
            const std::string name = fmt::format("{} nodes, grid {}", n, static_cast<int>(grid));
            log.run(name, [&] {
                rte::SolverOptions solver{.streams = n};
                solver.grid = grid;
                const auto a = rte::albedo(medium(0, 0.5), {0.1, 0.5, 1.0}, solver);
                double worst = 0;
                for (const double plane : a.plane_albedo)
                    worst = std::max(worst, std::abs(plane - 1));
                log.at_most(name, "1 - spherical albedo without absorption",
                            std::abs(a.spherical_albedo - 1), 1e-12 * n,
                            "energy; rounding of n nodes");
                // Plane albedo between the nodes is a quadrature of few nodes: only judged from 8
                // on.
                if (n >= 8) {
                    log.at_most(
                        name, "1 - plane albedo without absorption", worst,
                        grid == rte::GridKind::gauss ? 1e-12 * n : 1e-6 / n,
                        "Gauss conserves energy to rounding, mapped rules to their quadrature");
                }
            });
        }
    }
}

void check_weak_scattering(Log& log) {
    for (const double albedo : {1e-12, 1e-9, 1e-6, 1e-4}) {
        for (const double g : {-0.9, 0.0, 0.5, 0.9}) {
            const std::string name = fmt::format("albedo {:.0e}, g {}", albedo, g);
            log.run(name, [&] {
                rte::Stack stack;
                stack.base = rte::henyey_greenstein_optics(albedo, g);
                const auto r = rte::reflect(stack, {{0.3}, {0.7}, {60}}, {}).reflection[0];
                const double x = -0.21 + std::sqrt(0.91 * 0.51) * 0.5;
                const double phase = (1 - g * g) / std::pow(1 + g * g - 2 * g * x, 1.5);
                // Two scatterings bring albedo^2 times at most P(0) / P(Theta).
                const double peak = (1 + std::abs(g)) / std::pow(1 - std::abs(g), 2);
                log.at_most(name, "R against single scattering, relative",
                            std::abs(r / (albedo * phase / 4) - 1),
                            4 * albedo * peak / phase + 1e-13,
                            "second order of scattering; rounding");
            });
        }
    }
    log.run("albedo 0", [&] {
        log.at_most("albedo 0", "R",
                    rte::reflect(medium(1, 0.5), {{0.3}, {0.7}, {60}}, {}).reflection[0], 0,
                    "black");
        log.at_most("albedo 0", "plane albedo",
                    rte::albedo(medium(1, 0.5), {0.3}, {}).plane_albedo[0], 0, "black");
    });
}

// Whatever is called converged must be as good as it says.
void check_honesty(Log& log) {
    const ReferenceData table("rte/R_halfspace_HG.csv");
    for (const double tolerance : {1e-2, 1e-4, 1e-6}) {
        for (std::size_t row = 0; row < table.size(); row += 29) {
            const double g = table.number(row, "g"), albedo = table.number(row, "alpha");
            const double in = table.number(row, "mu_i"), out = table.number(row, "mu_o");
            const double azimuth = table.number(row, "phi_deg");
            if (in < 0.1) continue;
            const std::string name = fmt::format("tolerance {:.0e}, g {}, albedo {}, {} {} {}",
                                                 tolerance, g, albedo, in, out, azimuth);
            log.run(name, [&] {
                rte::Stack stack;
                stack.base = rte::henyey_greenstein_optics(albedo, g);
                const auto r = rte::reflect(stack, {{in}, {out, 0.5}, {azimuth, 0, 180}},
                                            {.tolerance = tolerance});
                double largest = 0;
                for (const double v : r.reflection) largest = std::max(largest, std::abs(v));
                const double error = std::abs(r.reflection[0] - table.number(row, "R")) / largest;
                log.at_most(name, "error over the largest value, if called converged",
                            r.report.converged ? error : 0, tolerance,
                            "the tolerance that was asked for");
            });
        }
    }
}

}  // namespace

void half_spaces(const Options& options, std::vector<Check>& checks) {
    Log log("half-spaces", checks);
    for (const double g : {-0.99, -0.5, 0.0, 0.5, 0.9, 0.99, 0.9999}) {
        for (const double absorption : {1.0, 1 - 1e-12, 0.5, 1e-6, 1e-15, 0.0}) {
            check_albedo(log, absorption, g);
            if (options.fast && std::abs(g) > 0.95) continue;
            check_reflection(log, absorption, g);
        }
    }
    for (const double g : {0.0, 0.5, 0.9}) check_square_root_law(log, g);
    check_nodes(log, options);
    check_weak_scattering(log);
    if (!options.fast) check_honesty(log);
}

}  // namespace miebrdf::stress
