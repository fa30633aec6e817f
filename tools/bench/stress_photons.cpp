// The solver against photons: the outside check of everything, within its confidence interval.
#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "tools/bench/bench_scene.h"
#include "tools/bench/stress.h"

namespace miebrdf::bench {
namespace {

// Some hundred comparisons: 4.5 standard errors are passed by chance less than once in a thousand
// runs of the whole suite, and the seeds are fixed.
constexpr double kSigmas = 4.5;

void compare(StressLog& log, const std::string& name, const BenchScene& scene, int photons) {
    const std::vector<double> cosines = {0.1, 0.5, 0.9}, azimuths = {0, 90, 180};
    log.run(name, [&] {
        std::vector<Detector> detectors;
        for (const double mu : cosines) {
            for (const double azimuth : azimuths) detectors.push_back({mu, azimuth});
        }
        const rte::SolverOptions options{.tolerance = 1e-4};
        const auto solved = run_solver(scene, {cosines, cosines, azimuths}, options);
        const auto albedos = run_solver(scene, {cosines, {}, {}}, options);
        for (std::size_t i = 0; i < cosines.size(); ++i) {
            const auto traced =
                trace_photons(scene.for_photons(), cosines[i], detectors, {.photons = photons});
            const auto sigmas = [](const Estimate& e, double truth) {
                // What was given up can only have made the estimate too small.
                const double missing = truth - e.value;
                return std::max(-missing, missing - e.unfinished) / e.standard_error;
            };
            const std::string where = fmt::format("{}, mu_in {}", name, cosines[i]);
            log.at_most(where, "plane albedo off the photons', standard errors",
                        sigmas(traced.plane_albedo, albedos[i]), kSigmas, "noise of the photons");
            double worst = 0;
            for (std::size_t d = 0; d < detectors.size(); ++d) {
                const double off = sigmas(traced.reflection[d], solved[i * detectors.size() + d]);
                if (!(off <= worst)) worst = off;
            }
            log.at_most(where, "largest R off the photons', standard errors", worst, kSigmas,
                        "noise of the photons");
        }
    });
}

}  // namespace

void stress_photons(const StressOptions& options, std::vector<StressCheck>& checks) {
    StressLog log("photons", checks);
    const int photons = options.fast ? 1000 : 20000;
    compare(log, "isotropic 0.9", {{0.9, 0, 0}, {}}, photons);
    compare(log, "g -0.5, albedo 0.8", {{0.8, -0.5, 0}, {}}, photons);
    compare(log, "g 0.75, albedo 0.95", {{0.95, 0.75, 0}, {}}, photons);
    compare(log, "bright coat of depth 0.1", {{0.95, 0.7, 0}, SimpleLayer{0.9, 0.46, 0.1}},
            photons);
    compare(log, "dark coat of depth 1", {{0.95, 0.7, 0}, SimpleLayer{0.1, 0.54, 1}}, photons);
    compare(log, "forward coat of depth 3 on a black base",
            {{0.0, 0, 0}, SimpleLayer{0.99, 0.8, 3}}, photons);
}

}  // namespace miebrdf::bench
