// Averages over sizes with widths from 1e-6 to 10 and all kinds of distributions.
#include <fmt/format.h>

#include <cmath>
#include <complex>

#include <miebrdf/ensemble.h>
#include <miebrdf/sphere.h>
#include "tools/bench/stress.h"

namespace miebrdf::bench {
namespace {

using Index = std::complex<double>;

mie::EnsembleRequest request_of(mie::SizeDistributionKind kind, double radius_um, double variance,
                                Index m) {
    mie::EnsembleRequest request;
    request.sizes = {kind, radius_um, variance};
    request.refractive_index = m;
    request.highest_moment = 16;
    request.tolerance = 1e-3;
    return request;
}

void check_physics(StressLog& log, const std::string& name, const mie::EnsembleRequest& request) {
    log.run(name, [&] {
        const auto o = mie::average_over_sizes(request);
        double wrong = 0;
        for (const double q : {o.q_ext, o.q_sca, o.q_abs}) wrong += !(std::isfinite(q) && q >= 0);
        for (const double chi : o.chi) wrong += !(std::abs(chi) <= 1 + 1e-14);
        log.at_most(name, "values negative or not finite, |chi| > 1", wrong, 0, "physics");
        // No sphere of index 1.5 to 10 reaches 10: the first resonances are near 4 to 6.
        log.at_most(name, "q_ext", o.q_ext, 10, "largest efficiency of any single sphere");
        log.at_most(name, "albedo outside [0, 1]", outside(o.single_scattering_albedo, 0, 1), 0,
                    "physics");
        log.at_most(name, "albedo + absorption - 1",
                    std::abs(o.single_scattering_albedo + o.one_minus_albedo - 1), 4e-16,
                    "two roundings");
        log.at_most(name, "chi_0 - 1", std::abs(o.chi[0] - 1), 1e-13, "sum rule of the 3j symbols");
        log.at_most(name, "error estimate of what is called converged",
                    o.converged ? o.error_estimate : 0, request.tolerance, "the tolerance");
    });
}

// Distributions that shrink to one size.
void check_narrow(StressLog& log, mie::SizeDistributionKind kind, const char* kind_name, Index m) {
    for (const double variance : {1e-6, 1e-4}) {
        const std::string name =
            fmt::format("{} of variance {:.0e}, m {}+{}i", kind_name, variance, m.real(), m.imag());
        log.run(name, [&] {
            const auto o = mie::average_over_sizes(request_of(kind, 0.1, variance, m));
            const double x = 2 * M_PI * 0.1 / 0.55;
            const auto s = mie::scatter_by_sphere(m, x);
            // Averaging moves q by v x^2 q'' / 2 + ...; d ln q / d ln x is about 4 at x = 1.
            log.at_most(name, "q_ext against the single sphere, relative",
                        relative_difference(o.q_ext, s.q_ext), 30 * variance + 1e-3,
                        "second derivative in x, tolerance of the average");
            log.at_most(name, "g against the single sphere", std::abs(o.asymmetry - s.asymmetry),
                        30 * variance + 1e-3, "second derivative in x, tolerance of the average");
        });
    }
}

}  // namespace

void stress_ensembles(const StressOptions& options, std::vector<StressCheck>& checks) {
    StressLog log("ensembles", checks);
    using Kind = mie::SizeDistributionKind;
    const std::pair<Kind, const char*> kinds[] = {{Kind::power_law, "power law"},
                                                  {Kind::gamma, "gamma"},
                                                  {Kind::log_normal, "log-normal"},
                                                  {Kind::mono, "mono"}};
    for (const auto& [kind, kind_name] : kinds) {
        for (const double radius : {1e-9, 0.1, 2.0}) {
            for (const double variance : {1e-6, 1e-4, 0.2, 10.0}) {
                if (kind == Kind::mono && variance != 0.2) continue;
                if (options.fast && radius > 1 && variance > 1) continue;
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
        check_physics(log, fmt::format("index {}+{}i", m.real(), m.imag()),
                      request_of(Kind::power_law, 0.5, 0.2, m));
    }
}

}  // namespace miebrdf::bench
