// Single spheres from vanishing to huge, and averages over sizes from narrow to broad.
#include <fmt/format.h>

#include <cmath>
#include <complex>

#include <miebrdf/ensemble.h>
#include <miebrdf/sphere.h>
#include "tools/bench/truth.h"
#include "tools/stress/battery.h"

namespace miebrdf::stress {
namespace {

using bench::ReferenceData;

void check_physics(Log& log, Index m, double x) {
    log.run(fmt::format("m {}, x {:.3g}", text_of(m), x), [&](const Case& is) {
        const auto s = mie::scatter_by_sphere(m, x);
        double wrong = 0;
        for (const double q : {s.q_ext, s.q_sca, s.q_abs, s.q_back})
            wrong += !(std::isfinite(q) && q >= 0);
        wrong += !(std::abs(s.asymmetry) <= 1);
        is.at_most("efficiencies negative or not finite, |g| > 1", wrong, 0, "physics");
        is.at_most("q_ext - q_sca - q_abs, relative",
                   relative_difference(s.q_ext, s.q_sca + s.q_abs), 1e-15,
                   "one rounding: extinction is their sum");
        if (m.imag() == 0) is.at_most("q_abs at k = 0", s.q_abs, 0, "nothing absorbs");
    });
}

void check_limits(Log& log) {
    for (const Index m :
         {Index(1.5, 0), Index(1.5, 0.1), Index(0.05, 0), Index(3, 4), Index(1 + 1e-7, 0)}) {
        for (const double x : {1e-8, 1e-6, 1e-4, 1e-3}) {
            log.run(
                fmt::format("small sphere, m {}, x {:.0e}", text_of(m), x), [&](const Case& is) {
                    const auto s = mie::scatter_by_sphere(m, x);
                    const Index k = (m * m - 1.0) / (m * m + 2.0);
                    const double rayleigh = 8.0 / 3 * std::pow(x, 4) * std::norm(k);
                    // Next order in x is O((|m| x)^2); m near 1 keeps as many digits as m - 1 has.
                    const double size = 2 * std::norm(m) * x * x + 2 * x * x;
                    const double digits = 4e-16 / std::abs(m - 1.0);
                    is.at_most("q_sca against Rayleigh, relative", std::abs(s.q_sca / rayleigh - 1),
                               size + digits + 1e-13, "next order of the series, digits of m - 1");
                    is.at_most("g", std::abs(s.asymmetry), size + 1e-13,
                               "g is of second order in x");
                });
        }
    }
    for (const Index m : {Index(1.5, 0.1), Index(3, 4), Index(1.33, 0.01)}) {
        for (const double x : {1e4, 1e5, 1e6}) {
            log.run(fmt::format("large sphere, m {}, x {:.0e}", text_of(m), x),
                    [&](const Case& is) {
                        // Edge contributions, Nussenzveig & Wiscombe 1980: 1.99 x^(-2/3) and
                        // smaller.
                        is.at_most("q_ext - 2", std::abs(mie::scatter_by_sphere(m, x).q_ext - 2),
                                   3 * std::pow(x, -2.0 / 3), "edge term 1.99 x^(-2/3)");
                    });
        }
    }
}

void check_reference(Log& log) {
    const ReferenceData table("mie/single_sphere.csv");
    for (std::size_t row = 0; row < table.size(); ++row) {
        const Index m(table.number(row, "nr"), table.number(row, "k"));
        const double x = table.number(row, "x");
        log.run(fmt::format("table, m {}, x {}", text_of(m), x), [&](const Case& is) {
            const auto s = mie::scatter_by_sphere(m, x);
            // A resonance of width w turns a relative rounding of x into 1e-16 x / w; digits of m -
            // 1 limit spheres that hardly differ from their surroundings.
            const double bound = 1e-12 + 4e-16 / std::abs(m - 1.0);
            is.at_most("q_ext, relative", relative_difference(s.q_ext, table.number(row, "Qext")),
                       bound, "1e-12 as documented; digits of m - 1");
            is.at_most("q_sca, relative", relative_difference(s.q_sca, table.number(row, "Qsca")),
                       bound, "1e-12 as documented; digits of m - 1");
            is.at_most("g, difference", std::abs(s.asymmetry - table.number(row, "g")), bound,
                       "1e-12 as documented; digits of m - 1");
        });
    }
}

// No jump where one recurrence takes over from another.
void check_continuity(Log& log) {
    for (const Index m : {Index(1.5, 0), Index(2.6, 1e-3), Index(1.5, 1), Index(0.2, 3.4)}) {
        for (const double x : {0.01, 0.1, 1.0, 4.0, 20.0, 100.0}) {
            log.run(fmt::format("step of 1e-9 at m {}, x {}", text_of(m), x), [&](const Case& is) {
                const auto a = mie::scatter_by_sphere(m, x),
                           b = mie::scatter_by_sphere(m, x * (1 + 1e-9));
                // The slope d ln q / d ln x is 4 for small spheres and at most some hundred in
                // ripple.
                is.at_most("q_sca, relative change", relative_difference(a.q_sca, b.q_sca), 5e-7,
                           "slope below 500 times a step of 1e-9");
            });
        }
    }
}

}  // namespace

void spheres(Log& log, bool fast) {
    const std::vector<Index> indices = {{1.5, 0},      {2.6, 0},     {0.05, 0}, {0.75, 0},
                                        {1 + 1e-7, 0}, {1.33, 1e-5}, {1.5, 1},  {0.2, 3.4},
                                        {10, 10},      {1, 1000},    {100, 1},  {3.3, 0.02}};
    for (const Index m : indices) {
        for (const double x : {1e-8, 1e-3, 1.0, 57.3, 1e3, 1e6}) {
            // |m| x partial waves inside: a sphere of index 1000 and x = 1e6 has none that help.
            if (fast && x > 1e5) continue;
            if (std::abs(m) * x > 2e7) continue;
            check_physics(log, m, x);
        }
    }
    check_limits(log);
    check_reference(log);
    check_continuity(log);
}

namespace {

mie::EnsembleRequest request_of(mie::SizeDistributionKind kind, double radius_um, double variance,
                                Index m) {
    mie::EnsembleRequest request;
    request.sizes = {kind, radius_um, variance};
    request.refractive_index = m;
    request.highest_moment = 16;
    request.tolerance = 1e-3;
    return request;
}

void check_physics(Log& log, const std::string& name, const mie::EnsembleRequest& request) {
    log.run(name, [&](const Case& is) {
        const auto o = mie::average_over_sizes(request);
        double wrong = 0;
        for (const double q : {o.q_ext, o.q_sca, o.q_abs}) wrong += !(std::isfinite(q) && q >= 0);
        for (const double chi : o.chi) wrong += !(std::abs(chi) <= 1 + 1e-14);
        is.at_most("values negative or not finite, |chi| > 1", wrong, 0, "physics");
        // No sphere of index 1.5 to 10 reaches 10: the first resonances are near 4 to 6.
        is.at_most("q_ext", o.q_ext, 10, "largest efficiency of any single sphere");
        is.at_most("albedo outside [0, 1]", outside(o.single_scattering_albedo, 0, 1), 0,
                   "physics");
        is.at_most("albedo + absorption - 1",
                   std::abs(o.single_scattering_albedo + o.one_minus_albedo - 1), 4e-16,
                   "two roundings");
        is.at_most("chi_0 - 1", std::abs(o.chi[0] - 1), 1e-13, "sum rule of the 3j symbols");
        is.at_most("error estimate of what is called converged", o.converged ? o.error_estimate : 0,
                   request.tolerance, "the tolerance");
    });
}

// Distributions that shrink to one size.
void check_narrow(Log& log, mie::SizeDistributionKind kind, const char* kind_name, Index m) {
    for (const double variance : {1e-6, 1e-4}) {
        log.run(fmt::format("{} of variance {:.0e}, m {}", kind_name, variance, text_of(m)),
                [&](const Case& is) {
                    const auto o = mie::average_over_sizes(request_of(kind, 0.1, variance, m));
                    const double x = 2 * M_PI * 0.1 / 0.55;
                    const auto s = mie::scatter_by_sphere(m, x);
                    // Averaging moves q by v x^2 q'' / 2 + ...; d ln q / d ln x is about 4 at x
                    // = 1.
                    is.at_most("q_ext against the single sphere, relative",
                               relative_difference(o.q_ext, s.q_ext), 30 * variance + 1e-3,
                               "second derivative in x, tolerance of the average");
                    is.at_most("g against the single sphere", std::abs(o.asymmetry - s.asymmetry),
                               30 * variance + 1e-3,
                               "second derivative in x, tolerance of the average");
                });
    }
}

}  // namespace

void ensembles(Log& log, bool fast) {
    using Kind = mie::SizeDistributionKind;
    const std::pair<Kind, const char*> kinds[] = {{Kind::power_law, "power law"},
                                                  {Kind::gamma, "gamma"},
                                                  {Kind::log_normal, "log-normal"},
                                                  {Kind::mono, "mono"}};
    for (const auto& [kind, kind_name] : kinds) {
        for (const double radius : {1e-9, 0.1, 2.0}) {
            for (const double variance : {1e-6, 1e-4, 0.2, 10.0}) {
                if (kind == Kind::mono && variance != 0.2) continue;
                if (fast && radius > 1 && variance > 1) continue;
                for (const Index m : {Index(1.5, 0), Index(1.5, 0.1)}) {
                    check_physics(log,
                                  fmt::format("{} {} um, variance {}, k {}", kind_name, radius,
                                              variance, m.imag()),
                                  request_of(kind, radius, variance, m));
                }
            }
        }
        if (kind != Kind::mono) {
            check_narrow(log, kind, kind_name, {1.5, 0});
            check_narrow(log, kind, kind_name, {1.5, 0.1});
        }
    }
    for (const Index m : {Index(1 + 1e-6, 0), Index(0.05, 0), Index(10, 10), Index(1.5, 1e-12)}) {
        check_physics(log, fmt::format("index {}", text_of(m)),
                      request_of(Kind::power_law, 0.5, 0.2, m));
    }
}

}  // namespace miebrdf::stress
