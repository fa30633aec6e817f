// Layers against photons: the outside check of everything, within its confidence interval.
#include "tools/stress/battery.h"

#include <fmt/format.h>

#include <algorithm>

namespace miebrdf::stress {
namespace {

// Some hundred comparisons: 4.5 standard errors are passed by chance less than once in a thousand
// runs of the whole suite, and the seeds are fixed.
constexpr double kSigmas = 4.5;

}  // namespace

void compare_with_photons(const Case& is, const rte::Stack& stack,
                          const rte::Directions& directions, int photons) {
    const bool is_rough = stack.boundary && stack.boundary->is_rough();
    const auto detectors = is_rough ? std::vector<bench::Detector>{} : bench::detectors(directions);
    const auto found = bench::trace_photons(bench::traced(stack), directions.mu_in[0], detectors,
                                            {.photons = photons});
    const auto sigmas = [](const bench::Estimate& e, double truth, double allowance = 0) {
        // Giving something up can only have made the estimate too small.
        const double missing = truth - e.value;
        return (std::max(-missing, missing - e.unfinished) - allowance) / e.standard_error;
    };
    const rte::SolverOptions options{.tolerance = 1e-4};
    const double albedo = rte::albedo(stack, directions.mu_in, options).plane_albedo[0];
    // A rough boundary itself follows the walk to 2e-3 of the light.
    is.at_most("plane albedo off the photons', standard errors",
               sigmas(found.plane_albedo, albedo, is_rough ? 2e-3 : 0), kSigmas,
               "noise of the photons");
    if (is_rough) return;
    const std::vector<double> R = rte::reflect(stack, directions, options).reflection;
    auto truth = R.begin();
    is.at_most(
        "largest R off the photons', standard errors",
        worst(found.reflection, [&](const bench::Estimate& e) { return sigmas(e, *truth++); }),
        kSigmas, "noise of the photons");
}

void photons(Log& log, bool fast) {
    const auto compare = [&](const std::string& name, const rte::Stack& stack) {
        for (const double mu_in : {0.1, 0.5, 0.9}) {
            log.run(fmt::format("{}, mu_in {}", name, mu_in), [&](const Case& is) {
                compare_with_photons(is, stack, {{mu_in}, {0.1, 0.5, 0.9}, {0, 90, 180}},
                                     fast ? 1000 : 20000);
            });
        }
    };
    const auto coated = [](const rte::Optics& base, const rte::Optics& coat, double depth) {
        return rte::Stack{.base = base, .coats = {{coat, depth}}};
    };
    using bench::scatterers;
    const rte::Optics base = scatterers(0.95, 0.7);
    compare("isotropic 0.9", {scatterers(0.9, 0)});
    compare("g -0.5, albedo 0.8", {scatterers(0.8, -0.5)});
    compare("g 0.75, albedo 0.95", {scatterers(0.95, 0.75)});
    compare("bright coat of depth 0.1", coated(base, scatterers(0.9, 0.46), 0.1));
    compare("dark coat of depth 1", coated(base, scatterers(0.1, 0.54), 1));
    compare("forward coat of depth 3 on a black base",
            coated(scatterers(0, 0), scatterers(0.99, 0.8), 3));
}

}  // namespace miebrdf::stress
