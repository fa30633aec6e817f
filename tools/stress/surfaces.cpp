// Rough surfaces from nearly a mirror to very rough, at grazing light.
#include <fmt/format.h>

#include <cmath>
#include <complex>

#include <miebrdf/surface.h>
#include "rte/surface/fresnel.h"
#include "tools/stress/battery.h"

namespace miebrdf::stress {
namespace {

using Index = std::complex<double>;

void check_physics(Log& log, double alpha, Index m) {
    rte::SurfaceOptions options;
    options.beckmann_alpha = alpha;
    for (const double mu : {1e-6, 1e-3, 0.1, 1.0}) {
        const std::string name =
            fmt::format("alpha {}, m {}+{}i, mu {:.0e}", alpha, m.real(), m.imag(), mu);
        log.run(name, [&] {
            const auto rho = rte::directional_reflectance(m, options, mu);
            log.at_most(name, "rho outside [0, 1]", outside(rho.value, 0, 1), 1e-6,
                        "energy; its tolerance");
            const rte::SurfaceLobe lobe(m, options);
            const double f = lobe.brdf(mu, 0.7, 30), back = lobe.brdf(0.7, mu, 30);
            log.at_most(name, "lobe negative or not finite", !(std::isfinite(f) && f >= 0), 0,
                        "physics");
            // D ~ exp(-tan^2 / alpha^2): a rounding of tan^2 is magnified by the exponent, at most
            // 745.
            log.at_most(name, "lobe reciprocal, relative", relative_difference(f, back), 1e-12,
                        "rounding, magnified by the exponent of D");
        });
    }
}

void check_mirror_limit(Log& log) {
    for (const Index m : {Index(1.5, 0), Index(0.2, 3.4)}) {
        for (const double mu : {0.3, 0.7, 1.0}) {
            const std::string name =
                fmt::format("nearly a mirror, m {}+{}i, mu {}", m.real(), m.imag(), mu);
            log.run(name, [&] {
                rte::SurfaceOptions options;
                options.beckmann_alpha = 1e-4;
                const double fresnel = rte::FresnelReflectance(m, rte::FresnelKind::exact)(mu);
                log.at_most(name, "rho against Fresnel's reflectance",
                            std::abs(rte::directional_reflectance(m, options, mu).value - fresnel),
                            2e-6, "curvature of F over slopes of 1e-4; tolerance 1e-6");
            });
        }
    }
}

}  // namespace

void surfaces(const Options& options, std::vector<Check>& checks) {
    Log log("surfaces", checks);
    for (const double alpha : {1e-4, 1e-2, 0.3, 1.0, 4.0}) {
        for (const Index m :
             {Index(1.5, 0), Index(0.2, 3.4), Index(1 + 1e-9, 0), Index(1000, 1000)}) {
            if (options.fast && (alpha == 1e-2 || alpha == 1.0)) continue;
            check_physics(log, alpha, m);
        }
    }
    check_mirror_limit(log);
}

}  // namespace miebrdf::stress
