// Half-spaces from black to white, backward to sharply forward, at grazing cosines.
#include <fmt/format.h>

#include <cmath>

#include "tools/bench/scenes.h"
#include "tools/bench/truth.h"
#include "tools/stress/battery.h"

namespace miebrdf::stress {
namespace {

using bench::ReferenceData;

const std::vector<double> kCosines = {1e-6, 1e-3, 0.1, 0.5, 1.0};

/// Absorption as its own number: 1 - 1e-15 is not lost in rounding.
rte::Stack medium(double one_minus_albedo, double g) {
    rte::Stack stack{rte::henyey_greenstein_optics(1 - one_minus_albedo, g)};
    stack.base.one_minus_albedo = one_minus_albedo;
    return stack;
}

void check_albedo(Log& log, double absorption, double g) {
    const std::string name = fmt::format("1 - albedo {:.0e}, g {}", absorption, g);
    log.run(name, [&](const Case&) {
        const auto a = rte::albedo(medium(absorption, g), kCosines, {.streams = 16});
        for (std::size_t i = 0; i < kCosines.size(); ++i) {
            log.run(fmt::format("{}, mu {:.0e}", name, kCosines[i]), [&](const Case& is) {
                is.at_most("plane albedo outside [0, 1]", outside(a.plane_albedo[i], 0, 1), 1e-12,
                           "energy; rounding of 16 nodes");
            });
            if (absorption > 0 || i < 2) continue;
            log.run(fmt::format("{}, mu {}", name, kCosines[i]), [&](const Case& is) {
                is.at_most("1 - plane albedo without absorption", std::abs(1 - a.plane_albedo[i]),
                           1e-11, "energy; rounding, amplified by 1 / (1 - g)");
            });
        }
    });
}

void check_reflection(Log& log, double absorption, double g) {
    log.run(fmt::format("R, 1 - albedo {:.0e}, g {}", absorption, g), [&](const Case& is) {
        const auto table = rte::reflect(medium(absorption, g), {kCosines, kCosines, {0, 90, 180}},
                                        {.streams = 16});
        double negative = 0, unequal = 0;
        see_reciprocal(table.reflection, kCosines.size(), 3, [&](double r, double back) {
            negative += !(std::isfinite(r) && r >= 0);
            unequal = std::max(unequal, relative_difference(r, back));
        });
        // Truncating the phase function may leave negative ripple where nothing is reflected: then
        // the report has to say that the tolerance was not met.
        is.at_most("values negative or not finite without a warning",
                   table.report.converged ? negative : 0, 0,
                   "physics; or flagged as not converged");
        is.at_most("R(i, o) - R(o, i), relative", unequal, 1e-9,
                   "symmetric by construction; sums of azimuths");
    });
}

// As absorption vanishes 1 - A falls as its square root, through every switch of methods.
void check_square_root_law(Log& log, double g) {
    double before = 0;
    for (int decade = 3; decade <= 15; ++decade) {
        log.run(fmt::format("1 - albedo 1e-{} to 1e-{}, g {}", decade - 1, decade, g),
                [&](const Case& is) {
                    const double absorption = std::pow(10.0, -decade);
                    const auto a = rte::albedo(medium(absorption, g), {0.5}, {.streams = 16});
                    const double lost = 1 - a.plane_albedo[0];
                    if (before > 0) {
                        // Next term of the expansion in sqrt(absorption / (1 - g)); rounding of
                        // 1 - A.
                        is.at_most("(1 - A) ratio over sqrt(10), minus 1",
                                   std::abs(before / lost / std::sqrt(10.0) - 1),
                                   8 * std::sqrt(10 * absorption / (1 - g)) + 1e-12 / lost,
                                   "van de Hulst's expansion; rounding of 1 - A");
                    }
                    before = lost;
                });
    }
}

void check_nodes(Log& log, int n, rte::GridKind grid) {
    log.run(fmt::format("{} nodes, grid {}", n, static_cast<int>(grid)), [&](const Case& is) {
        const auto a = rte::albedo(medium(0, 0.5), {0.1, 0.5, 1.0}, {.grid = grid, .streams = n});
        is.at_most("1 - spherical albedo without absorption", std::abs(a.spherical_albedo - 1),
                   1e-12 * n, "energy; rounding of n nodes");
        // Plane albedo between the nodes is a quadrature of few nodes: only judged from 8 on.
        if (n < 8) return;
        is.at_most("1 - plane albedo without absorption",
                   worst(a.plane_albedo, [](double plane) { return std::abs(plane - 1); }),
                   grid == rte::GridKind::gauss ? 1e-12 * n : 1e-6 / n,
                   "Gauss conserves energy to rounding, mapped rules to their quadrature");
    });
}

void check_weak_scattering(Log& log, double albedo, double g) {
    log.run(fmt::format("albedo {:.0e}, g {}", albedo, g), [&](const Case& is) {
        const rte::Stack stack{rte::henyey_greenstein_optics(albedo, g)};
        const double r = rte::reflect(stack, {{0.3}, {0.7}, {60}}, {}).reflection[0];
        const double x = -0.21 + std::sqrt(0.91 * 0.51) * 0.5;
        const double phase = (1 - g * g) / std::pow(1 + g * g - 2 * g * x, 1.5);
        // Two scatterings bring albedo^2 times at most P(0) / P(Theta).
        const double peak = (1 + std::abs(g)) / std::pow(1 - std::abs(g), 2);
        is.at_most("R against single scattering, relative", std::abs(r / (albedo * phase / 4) - 1),
                   4 * albedo * peak / phase + 1e-13, "second order of scattering; rounding");
    });
}

// Whatever is called converged must be as good as it says.
void check_honesty(Log& log, double tolerance) {
    const ReferenceData table("rte/R_halfspace_HG.csv");
    for (std::size_t row = 0; row < table.size(); row += 29) {
        const double g = table.number(row, "g"), albedo = table.number(row, "alpha");
        const double in = table.number(row, "mu_i"), out = table.number(row, "mu_o");
        const double azimuth = table.number(row, "phi_deg");
        if (in < 0.1) continue;
        log.run(fmt::format("tolerance {:.0e}, g {}, albedo {}, {} {} {}", tolerance, g, albedo, in,
                            out, azimuth),
                [&](const Case& is) {
                    const rte::Stack stack{rte::henyey_greenstein_optics(albedo, g)};
                    const auto r = rte::reflect(stack, {{in}, {out, 0.5}, {azimuth, 0, 180}},
                                                {.tolerance = tolerance});
                    const double largest =
                        worst(r.reflection, [](double v) { return std::abs(v); });
                    const double error = std::abs(r.reflection[0] - table.number(row, "R"));
                    is.at_most("error over the largest value, if called converged",
                               r.report.converged ? error / largest : 0, tolerance,
                               "the tolerance that was asked for");
                });
    }
}

}  // namespace

void half_spaces(Log& log, bool fast) {
    for (const double g : {-0.99, -0.5, 0.0, 0.5, 0.9, 0.99, 0.9999}) {
        for (const double absorption : {1.0, 1 - 1e-12, 0.5, 1e-6, 1e-15, 0.0}) {
            check_albedo(log, absorption, g);
            if (!fast || std::abs(g) <= 0.95) check_reflection(log, absorption, g);
        }
    }
    for (const double g : {0.0, 0.5, 0.9}) check_square_root_law(log, g);
    for (const int n : {2, 3, 4, 5, 8, 16, 32, 64, 128, 256}) {
        if (fast && n > 64) continue;
        for (const auto grid :
             {rte::GridKind::gauss, rte::GridKind::mapped_gauss, rte::GridKind::paper})
            check_nodes(log, n, grid);
    }
    for (const double albedo : {1e-12, 1e-9, 1e-6, 1e-4})
        for (const double g : {-0.9, 0.0, 0.5, 0.9}) check_weak_scattering(log, albedo, g);
    log.run("albedo 0", [&](const Case& is) {
        is.at_most("R", rte::reflect(medium(1, 0.5), {{0.3}, {0.7}, {60}}, {}).reflection[0], 0,
                   "black");
        is.at_most("plane albedo", rte::albedo(medium(1, 0.5), {0.3}, {}).plane_albedo[0], 0,
                   "black");
    });
    if (fast) return;
    for (const double tolerance : {1e-2, 1e-4, 1e-6}) check_honesty(log, tolerance);
}

}  // namespace miebrdf::stress
