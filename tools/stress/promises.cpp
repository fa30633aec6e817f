// What "converged" promises, over random scenes: the true error is within the tolerance. Smooth
// media against many more nodes and, some of them, against adding-doubling; scenes of spheres
// against far more sizes, partial waves and nodes.
#include <fmt/format.h>
#include <miebrdf/brdf.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <map>
#include <random>

#include "rte/stack/layered_reflection.h"
#include "tools/bench/discrete_problem.h"
#include "tools/stress/battery.h"

namespace miebrdf::stress {
namespace {

// The same draws with every standard library: distributions of <random> are not.
class Dice {
  public:
    explicit Dice(unsigned seed) : engine_(seed) {}
    double uniform(double low, double high) { return low + (high - low) * next(); }
    double logarithmic(double low, double high) {
        return std::exp(uniform(std::log(low), std::log(high)));
    }
    bool chance(double probability) { return next() < probability; }
    int integer(int low, int high) { return low + int(next() * (high - low + 1)); }

  private:
    double next() { return (double(engine_()) + 0.5) / 4294967296.0; }
    std::mt19937 engine_;
};

double random_albedo(Dice& dice) {
    switch (dice.integer(0, 4)) {
        case 0:
            return 1.0;
        case 1:
            return 1.0 - dice.logarithmic(1e-8, 1e-2);
        case 2:
            return dice.logarithmic(1e-4, 0.1);
        default:
            return dice.uniform(0.0, 1.0);
    }
}

rte::Optics random_smooth(Dice& dice) {
    const double albedo = random_albedo(dice);
    switch (dice.integer(0, 4)) {
        case 0:
            return rte::isotropic_optics(albedo);
        case 1:
            return rte::rayleigh_optics(albedo);
        default:
            return rte::henyey_greenstein_optics(albedo, dice.uniform(-0.5, 0.85));
    }
}

Directions random_directions(Dice& dice) {
    const auto cosines = [&] {
        std::vector<double> list;
        for (int i = dice.integer(1, 3); i > 0; --i)
            list.push_back(dice.chance(0.2) ? 1.0 : dice.logarithmic(0.02, 1.0));
        return list;
    };
    Directions directions{cosines(), cosines(), {}};
    if (dice.chance(0.3)) directions.mu_out = directions.mu_in;
    for (int i = dice.integer(1, 3); i > 0; --i)
        directions.azimuth_deg.push_back(dice.chance(0.5) ? 180.0 * dice.integer(0, 1)
                                                          : dice.uniform(0.0, 180.0));
    return directions;
}

/// Largest error, relative to the largest true value at that incidence.
double error_of(const std::vector<double>& values, const std::vector<double>& truth,
                std::size_t block) {
    double worst = 0;
    for (std::size_t start = 0; start < truth.size(); start += block) {
        double scale = 0;
        for (std::size_t k = start; k < start + block; ++k)
            scale = std::max(scale, std::abs(truth[k]));
        for (std::size_t k = start; k < start + block && scale > 0; ++k)
            worst = std::max(worst, std::abs(values[k] - truth[k]) / scale);
    }
    return worst;
}

struct Promises {
    int scenes = 0, converged = 0, missed = 0, missed_by_3 = 0;
    double worst = 0;  ///< error over tolerance of a converged result
    std::string worst_scene = "-";

    void take(bool is_converged, double error, double tolerance, const std::string& scene) {
        ++scenes;
        if (!is_converged) return;
        ++converged;
        const double ratio = error / tolerance;
        if (!(ratio <= 1)) ++missed;
        if (!(ratio <= 3)) ++missed_by_3;
        if (!(ratio <= worst)) {
            worst = ratio;
            worst_scene = scene;
        }
    }

    void judge(Log& log, const std::string& kind) const {
        const std::string name = fmt::format("{}: {} scenes, {} converged, worst {:.2g} times: {}",
                                             kind, scenes, converged, worst, worst_scene);
        log.at_most(name, "converged results beyond the tolerance", missed,
                    std::max(2.0, 0.01 * converged), "one in a hundred: estimates are statistics");
        log.at_most(name, "converged results beyond three times the tolerance", missed_by_3, 1,
                    "one in all, thin conservative coats at 1e-6 and glories under a coat at 1e-4 "
                    "(docs/accuracy.md)");
    }
};

std::string text_of(const rte::Optics& o) {
    return fmt::format("{}:{},{}",
                       o.chi.size() > 3    ? "hg"
                       : o.chi.size() == 3 ? "rayleigh"
                                           : "iso",
                       o.single_scattering_albedo, o.chi.size() > 1 ? o.chi[1] : 0.0);
}

std::string text_of(const Directions& d) {
    std::string text;
    for (const auto* list : {&d.mu_in, &d.mu_out, &d.azimuth_deg}) {
        text += " [";
        for (const double x : *list) text += fmt::format("{} ", x);
        text.back() = ']';
    }
    return text;
}

bench::MomentStack moments_of(const rte::Stack& stack) {
    bench::MomentStack layers;
    const auto add = [&](const rte::Optics& o, double depth) {
        auto phase = o.phase;
        if (!phase) {
            const double second = o.chi.size() > 2 ? o.chi[2] : 0.0;
            phase = [second](double x) { return 1 + 5 * second * (1.5 * x * x - 0.5); };
        }
        layers.push_back({o.single_scattering_albedo, o.chi, phase, depth});
    };
    for (auto coat = stack.coats.rbegin(); coat != stack.coats.rend(); ++coat)
        add(coat->optics, coat->optical_depth);
    add(stack.base, std::numeric_limits<double>::infinity());
    return layers;
}

void smooth(const Options& options, Log& log, bool coated) {
    Dice dice(coated ? 20 : 10);
    const int scenes = options.fast ? 60 : 400;
    std::map<double, Promises> promises;
    double reference_error = 0;
    for (int s = 0; s < scenes; ++s) {
        rte::Stack stack{.base = random_smooth(dice)};
        std::string text = text_of(stack.base);
        for (int c = coated ? dice.integer(1, 2) : 0; c > 0; --c) {
            stack.coats.push_back({random_smooth(dice), dice.logarithmic(1e-3, 20.0)});
            text += fmt::format(" + {}@{}", text_of(stack.coats.back().optics),
                                stack.coats.back().optical_depth);
        }
        const Directions directions = random_directions(dice);
        text += text_of(directions);
        const std::size_t block = directions.mu_out.size() * directions.azimuth_deg.size();
        const auto truth =
            rte::reflect(stack, directions, {.tolerance = 1e-12, .streams = 110}).reflection;
        for (const double tolerance : {1e-2, 1e-3, 1e-5, 1e-6}) {
            const auto table = rte::reflect(stack, directions, {.tolerance = tolerance});
            promises[tolerance].take(table.report.converged,
                                     error_of(table.reflection, truth, block), tolerance, text);
        }
        const auto least = [](const std::vector<double>& list) {
            return *std::min_element(list.begin(), list.end());
        };
        // Where Gauss nodes and 64 moments are enough; the first doubled layer loses 1e-8 or so.
        if (s % 20 == 0 && least(directions.mu_in) > 0.1 && least(directions.mu_out) > 0.1) {
            const auto other = bench::sum_orders(
                moments_of(stack), 32, directions.mu_in, directions.mu_out, directions.azimuth_deg,
                [](const bench::Order& o) { return bench::adding_doubling(o); });
            reference_error = std::max(reference_error, error_of(other, truth, block));
        }
    }
    for (const auto& [tolerance, promise] : promises) {
        promise.judge(
            log, fmt::format("smooth {} at {:.0e}", coated ? "coats" : "half-spaces", tolerance));
    }
    log.at_most(coated ? "smooth coats" : "smooth half-spaces",
                "the truth against adding-doubling on 32 Gauss nodes", reference_error, 1e-4,
                "these nodes at g up to 0.85 (docs/accuracy.md)");
}

std::string random_spheres(Dice& dice) {
    const double n = dice.uniform(1.05, 3.0);
    const double k = dice.chance(0.35) ? 0.0 : dice.logarithmic(1e-4, 1.0);
    return fmt::format("index:{:.4f},{:.5f},radius={:.3f},variance={:.2f},distribution={}", n, k,
                       dice.logarithmic(0.05, 4.0), dice.uniform(0.05, 0.3),
                       dice.chance(0.5) ? "power-law" : "gamma");
}

void spheres_in_layers(const Options& options, Log& log) {
    Dice dice(30);
    const int scenes = options.fast ? 12 : 120;
    std::map<double, Promises> promises;
    for (int s = 0; s < scenes; ++s) {
        const bool spheres_below = dice.chance(0.7);
        std::string base =
            spheres_below ? random_spheres(dice)
                          : fmt::format("hg:{},{}", random_albedo(dice), dice.uniform(-0.3, 0.8));
        Scene scene;
        scene.base = medium(base);
        if (!spheres_below || dice.chance(0.4)) {
            const double depth = dice.logarithmic(0.01, 10.0);
            const std::string coat = random_spheres(dice);
            scene.layers.push_back({medium(coat), depth});
            base += fmt::format(" + {}@{}", coat, depth);
        }
        const Directions directions = random_directions(dice);
        base += text_of(directions);
        const std::size_t block = directions.mu_out.size() * directions.azimuth_deg.size();
        Scene finest = scene;
        finest.particles.tolerance = 2e-6;
        const auto truth = solve(finest, {550}, {.tolerance = 1e-5, .streams = 160})
                               .evaluate(directions)
                               .slices[0]
                               .subsurface;
        for (const double tolerance : {1e-2, 1e-3, 1e-4}) {
            const BrdfValues values =
                solve(scene, {550}, {.tolerance = tolerance}).evaluate(directions);
            promises[tolerance].take(values.converged(),
                                     error_of(values.slices[0].subsurface, truth, block), tolerance,
                                     base);
        }
    }
    for (const auto& [tolerance, promise] : promises)
        promise.judge(log, fmt::format("spheres at {:.0e}", tolerance));
}

}  // namespace

void promises(const Options& options, std::vector<Check>& checks) {
    Log log("promises", checks);
    log.run("smooth half-spaces", [&] { smooth(options, log, false); });
    log.run("smooth coats", [&] { smooth(options, log, true); });
    log.run("spheres", [&] { spheres_in_layers(options, log); });
}

}  // namespace miebrdf::stress
