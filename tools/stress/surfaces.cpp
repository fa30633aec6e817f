// Rough surfaces from nearly a mirror to very rough, at grazing light.
#include <fmt/format.h>

#include <cmath>
#include <complex>

#include <miebrdf/surface.h>
#include "rte/surface/fresnel.h"
#include "tools/stress/battery.h"

namespace miebrdf::stress {
namespace {

rte::SurfaceOptions rough(double alpha) {
    rte::SurfaceOptions options;
    options.beckmann_alpha = alpha;
    return options;
}

void check_physics(Log& log, double alpha, Index m, double mu) {
    log.run(fmt::format("alpha {}, m {}, mu {:.0e}", alpha, text_of(m), mu), [&](const Case& is) {
        const auto rho = rte::directional_reflectance(m, rough(alpha), mu);
        is.at_most("rho outside [0, 1]", outside(rho.value, 0, 1), 1e-6, "energy; its tolerance");
        const rte::SurfaceLobe lobe(m, rough(alpha));
        const double f = lobe.brdf(mu, 0.7, 30), back = lobe.brdf(0.7, mu, 30);
        is.at_most("lobe negative or not finite", !(std::isfinite(f) && f >= 0), 0, "physics");
        // D ~ exp(-tan^2 / alpha^2): a rounding of tan^2 is magnified by the exponent, at most 745.
        is.at_most("lobe reciprocal, relative", relative_difference(f, back), 1e-12,
                   "rounding, magnified by the exponent of D");
    });
}

void check_mirror_limit(Log& log, Index m, double mu) {
    log.run(fmt::format("nearly a mirror, m {}, mu {}", text_of(m), mu), [&](const Case& is) {
        const double fresnel = rte::FresnelReflectance(m, rte::FresnelKind::exact)(mu);
        is.at_most("rho against Fresnel's reflectance",
                   std::abs(rte::directional_reflectance(m, rough(1e-4), mu).value - fresnel), 2e-6,
                   "curvature of F over slopes of 1e-4; tolerance 1e-6");
    });
}

}  // namespace

void surfaces(Log& log, bool fast) {
    for (const double alpha : {1e-4, 1e-2, 0.3, 1.0, 4.0}) {
        if (fast && (alpha == 1e-2 || alpha == 1.0)) continue;
        for (const Index m :
             {Index(1.5, 0), Index(0.2, 3.4), Index(1 + 1e-9, 0), Index(1000, 1000)})
            for (const double mu : {1e-6, 1e-3, 0.1, 1.0}) check_physics(log, alpha, m, mu);
    }
    for (const Index m : {Index(1.5, 0), Index(0.2, 3.4)})
        for (const double mu : {0.3, 0.7, 1.0}) check_mirror_limit(log, m, mu);
}

}  // namespace miebrdf::stress
