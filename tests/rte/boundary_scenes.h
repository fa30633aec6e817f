// Random scenes below boundaries, solved as anyone would ask for them and compared with solutions
// of many more nodes.
#pragma once

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <random>
#include <vector>

#include <miebrdf/optics.h>
#include <miebrdf/solver.h>
#include <miebrdf/surface.h>
#include "rte/stack/layered_reflection.h"

namespace miebrdf::support {

struct BoundaryScene {
    rte::Stack stack;
    rte::Directions directions;
    bool wants_albedo = false;
};

/// Makes one scene for each number, on every machine.
class BoundarySceneMaker {
  public:
    /// @param rough  below a rough boundary always, in place of 15 of 100 times
    explicit BoundarySceneMaker(std::uint32_t number, bool rough = false)
        : rough_(rough), random_(number) {}

    BoundaryScene make() {
        BoundaryScene scene;
        rte::Stack& stack = scene.stack;
        double index = any_index();
        stack.base_index = index;
        const double kind = uniform();
        if (kind < 0.4) {
            stack.base = any_optics();
        } else if (kind < 0.5) {
            stack.base_kind = rte::BaseKind::none;
        } else if (kind < 0.65) {
            stack.base_kind = rte::BaseKind::lambertian;
            stack.ground_albedo = uniform();
        } else {
            stack.base_kind = rte::BaseKind::mirror;
            if (kind < 0.85) stack.mirror_index = {log_between(0.05, 3.0), log_between(0.5, 8.0)};
        }
        const bool is_half_space = stack.base_kind == rte::BaseKind::half_space;
        const int coats = int(uniform() * 4.0) + (is_half_space ? 0 : 1);
        for (int c = 0; c < coats; ++c) {
            if (uniform() < 0.6) index = any_index();
            stack.coats.push_back({any_optics(), log_between(1e-4, 30.0), index});
        }
        stack.boundary = rte::Boundary{};
        constexpr double kLeastRoughIndex = 1.05;
        if (rough_ && index < kLeastRoughIndex) {
            index = between(kLeastRoughIndex, 2.6);
            (stack.coats.empty() ? stack.base_index : stack.coats.back().index) = index;
        }
        if (index >= kLeastRoughIndex && (uniform() < 0.15 || rough_)) {
            stack.boundary->roughness = log_between(0.03, 0.6);
            stack.boundary->distribution = uniform() < 0.5 ? rte::MicrofacetDistribution::ggx
                                                           : rte::MicrofacetDistribution::beckmann;
        }
        scene.wants_albedo = uniform() < 0.4;
        scene.directions.mu_in = {between(0.05, 1.0)};
        if (scene.wants_albedo) return scene;
        const int outgoing = 1 + int(uniform() * 4.0);
        for (int o = 0; o < outgoing; ++o) scene.directions.mu_out.push_back(between(0.05, 1.0));
        scene.directions.azimuth_deg = {180.0 * double(int(uniform() * 3.0)) / 2.0};
        if (uniform() < 0.5) scene.directions.azimuth_deg.push_back(between(0.0, 180.0));
        return scene;
    }

  private:
    double uniform() { return double(random_()) / 4294967296.0; }
    double between(double low, double high) { return low + (high - low) * uniform(); }
    double log_between(double low, double high) { return low * std::pow(high / low, uniform()); }
    double any_index() {
        const double kind = uniform();
        if (kind < 0.1) return 1.0;
        return kind < 0.25 ? 1.0 + log_between(2e-3, 0.05) : between(1.05, 2.6);
    }
    rte::Optics any_optics() {
        const double albedo = uniform() < 0.5 ? uniform() : 1.0 - log_between(1e-7, 0.3);
        const double kind = uniform();
        if (kind < 0.3) return rte::isotropic_optics(albedo);
        if (kind < 0.4) return rte::rayleigh_optics(albedo);
        return rte::henyey_greenstein_optics(albedo, between(-0.5, 0.85));
    }

    bool rough_;
    std::mt19937 random_;
};

struct SceneSolution {
    std::vector<double> values;
    std::vector<double> scales;  ///< that errors are relative to
    bool converged = false;
    double estimate = 0.0;
    int streams = 0;
};

inline SceneSolution solution_of(const BoundaryScene& scene, const rte::SolverOptions& options) {
    SceneSolution solution;
    if (scene.wants_albedo) {
        const rte::AlbedoTable table = rte::albedo(scene.stack, scene.directions.mu_in, options);
        solution.values = table.plane_albedo;
        solution.values.push_back(table.spherical_albedo);
        solution.values.insert(solution.values.end(), table.transmittance.begin(),
                               table.transmittance.end());
        for (const double value : solution.values)
            solution.scales.push_back(std::max(std::abs(value), 1e-6));
        solution.converged = table.report.converged;
        solution.estimate = table.report.error_estimate;
        solution.streams = table.report.streams;
        return solution;
    }
    const rte::ReflectionTable table = rte::reflect(scene.stack, scene.directions, options);
    solution.values = table.reflection;
    double largest = 0.0;
    for (const double value : solution.values) largest = std::max(largest, std::abs(value));
    solution.scales.assign(solution.values.size(), largest);
    solution.converged = table.report.converged;
    solution.estimate = table.report.error_estimate;
    solution.streams = table.report.streams;
    return solution;
}

/// The largest error relative to its scale.
inline double error_of(const SceneSolution& found, const SceneSolution& truth) {
    double worst = 0.0;
    for (std::size_t k = 0; k < truth.values.size(); ++k) {
        const double error = std::abs(found.values[k] - truth.values[k]) / truth.scales[k];
        if (!(error <= worst)) worst = error;
    }
    return worst;
}

}  // namespace miebrdf::support
