#include "tools/bench/photon_tracer.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <stdexcept>

namespace miebrdf::bench {
namespace {

// Below this weight a photon survives with probability 1/10, with ten times its weight: fewer
// collisions are traced for light that hardly matters.
constexpr double kRouletteBelow = 0.05;
constexpr double kSurvival = 0.1;

void require(bool good, const char* what, double value, const char* allowed) {
    if (!good) throw std::invalid_argument(fmt::format("{} {} is not in {}", what, value, allowed));
}

void check(const TracedLayer& layer, bool is_coat) {
    const double a = layer.single_scattering_albedo;
    require(a >= 0 && a <= 1, "albedo", a, "[0, 1]");
    if (is_coat)
        require(layer.optical_depth >= 0, "optical depth", layer.optical_depth, "[0, inf)");
}

// Turns a direction by the scattering angle, at a uniform angle around it.
RayDirection scattered(const RayDirection& d, double cos_theta, double around) {
    const double sin_theta = std::sqrt(std::max(0.0, (1 - cos_theta) * (1 + cos_theta)));
    const double c = sin_theta * std::cos(around), s = sin_theta * std::sin(around);
    const double across = std::sqrt(d.x * d.x + d.y * d.y);
    if (across < 1e-10) return {c, s, d.z > 0 ? cos_theta : -cos_theta};
    return {d.x * cos_theta + (d.x * d.z * c - d.y * s) / across,
            d.y * cos_theta + (d.y * d.z * c + d.x * s) / across, d.z * cos_theta - across * c};
}

// Layers from the top, each with the optical depth at which it ends.
struct Medium {
    double end;
    const TracedLayer* layer;
};

std::vector<Medium> from_the_top(const TracedStack& stack) {
    std::vector<Medium> media;
    double depth = 0;
    for (auto coat = stack.coats.rbegin(); coat != stack.coats.rend(); ++coat) {
        check(*coat, true);
        depth += coat->optical_depth;
        media.push_back({depth, &*coat});
    }
    if (stack.ground_albedo) return media;
    check(stack.base, false);
    media.push_back({std::numeric_limits<double>::infinity(), &stack.base});
    return media;
}

struct Sums {
    double first = 0, second = 0;
    void add(double x) {
        first += x;
        second += x * x;
    }
    Estimate estimate(double count, double unfinished) const {
        const double mean = first / count;
        const double variance = std::max(0.0, second / count - mean * mean);
        return {mean, std::sqrt(variance / std::max(1.0, count - 1)), unfinished};
    }
};

class Tracer {
  public:
    Tracer(const TracedStack& stack, double mu_in, const std::vector<Detector>& detectors,
           const TracerOptions& options)
        : media_(from_the_top(stack)),
          boundary_(stack.boundary),
          ground_albedo_(stack.ground_albedo),
          bottom_(stack.ground_albedo && media_.empty() ? 0 : media_.back().end),
          options_(options),
          mu_in_(mu_in) {
        require(boundary_.index >= 1, "index", boundary_.index, "[1, inf)");
        if (boundary_.roughness > 0 && !detectors.empty())
            throw std::invalid_argument("a rough boundary has no detectors");
        for (const Detector& d : detectors) {
            require(d.mu_out > 0 && d.mu_out <= 1, "mu_out", d.mu_out, "(0, 1]");
            const double across = std::sqrt((1 - d.mu_out) * (1 + d.mu_out));
            const double azimuth = d.azimuth_deg * M_PI / 180;
            const FresnelRay ray = fresnel(boundary_.index, d.mu_out);
            const double n = boundary_.index;
            eyes_.push_back({across / n * std::cos(azimuth), across / n * std::sin(azimuth),
                             -ray.cosine_behind});
            seen_through_.push_back((1 - ray.reflectance) / (n * n));
        }
        seen_.resize(detectors.size());
    }

    TracedReflection trace() {
        Sums left;
        std::vector<Sums> sums(eyes_.size());
        double given_up = 0;
        for (int i = 0; i < options_.photons; ++i) {
            std::fill(seen_.begin(), seen_.end(), 0.0);
            RandomStream random(options_.seed, static_cast<std::uint64_t>(i));
            const auto [out, inside] = follow(random);
            left.add(out);
            given_up += inside;
            for (std::size_t d = 0; d < sums.size(); ++d) sums[d].add(seen_[d]);
        }
        const double n = options_.photons;
        TracedReflection result;
        result.plane_albedo = left.estimate(n, given_up / n);
        // Photons that are given up are deep inside; from there light leaves with a radiance of at
        // most 1.3 times its mean (the escape function at the zenith, van de Hulst 1980, table 12).
        for (const Sums& s : sums) result.reflection.push_back(s.estimate(n, 1.3 * given_up / n));
        return result;
    }

  private:
    struct Fate {
        double out;     // weight that left through the top
        double inside;  // weight given up
    };

    Fate follow(RandomStream& random) {
        RayDirection d{std::sqrt((1 - mu_in_) * (1 + mu_in_)), 0, mu_in_};
        Fate fate{0, 0};
        double depth = 0, weight = 1;
        if (boundary_.is_there() && !enter(d, weight, fate, random)) return fate;
        for (int collision = 0; collision < options_.most_collisions; ++collision) {
            depth -= d.z * std::log(random.uniform());
            if (depth <= 0) {
                if (leaves(d, random)) {
                    fate.out += weight;
                    return fate;
                }
                depth = 0;
                continue;
            }
            const TracedLayer* layer = nullptr;  // or the ground
            if (ground_albedo_ && depth >= bottom_) {
                depth = bottom_;
                weight *= *ground_albedo_;
                look_at_ground(weight);
            } else {
                layer = &layer_at(depth);
                weight *= layer->single_scattering_albedo;
                look(layer->law, d, depth, weight);
            }
            if (weight == 0) return fate;
            if (weight < kRouletteBelow) {
                if (random.uniform() > kSurvival) return fate;
                weight /= kSurvival;
            }
            d = layer == nullptr ? diffusely_up(random) : turned(d, layer->law, random);
        }
        fate.inside = weight;
        return fate;
    }

    /// Through the boundary from air. What a smooth one reflects is known without chance.
    bool enter(RayDirection& d, double& weight, Fate& fate, RandomStream& random) const {
        if (boundary_.roughness > 0) {
            const BoundaryExit exit = meet_boundary(boundary_, true, d, random);
            if (!exit.into_medium) fate.out = weight;
            d = exit.direction;
            return exit.into_medium;
        }
        const FresnelRay ray = fresnel(boundary_.index, mu_in_);
        fate.out = ray.reflectance;
        weight = 1 - ray.reflectance;
        d = {d.x / boundary_.index, d.y / boundary_.index, ray.cosine_behind};
        return true;
    }

    /// Whether a ray that comes back to the top leaves; if not, it goes down again.
    bool leaves(RayDirection& d, RandomStream& random) const {
        if (!boundary_.is_there()) return true;
        const BoundaryExit exit = meet_boundary(boundary_, false, d, random);
        d = exit.direction;
        return !exit.into_medium;
    }

    static RayDirection turned(RayDirection d, const ScatteringLaw& law, RandomStream& random) {
        const double cos_theta = law.sample(random.uniform());
        d = scattered(d, cos_theta, 2 * M_PI * random.uniform());
        const double norm = 1 / std::sqrt(d.x * d.x + d.y * d.y + d.z * d.z);
        return {d.x * norm, d.y * norm, d.z * norm};
    }

    static RayDirection diffusely_up(RandomStream& random) {
        const double mu2 = random.uniform(), azimuth = 2 * M_PI * random.uniform();
        const double across = std::sqrt(1 - mu2);
        return {across * std::cos(azimuth), across * std::sin(azimuth), -std::sqrt(mu2)};
    }

    const TracedLayer& layer_at(double depth) const {
        std::size_t i = 0;
        while (depth > media_[i].end) ++i;
        return *media_[i].layer;
    }

    void look(const ScatteringLaw& law, const RayDirection& d, double depth, double weight) {
        for (std::size_t i = 0; i < eyes_.size(); ++i) {
            const RayDirection& eye = eyes_[i];
            const double cos_theta = std::clamp(d.x * eye.x + d.y * eye.y + d.z * eye.z, -1.0, 1.0);
            const double mu = -eye.z;
            seen_[i] +=
                weight * seen_through_[i] * law.value(cos_theta) * std::exp(-depth / mu) / (4 * mu);
        }
    }

    void look_at_ground(double weight) {
        for (std::size_t i = 0; i < eyes_.size(); ++i)
            seen_[i] += weight * seen_through_[i] * std::exp(bottom_ / eyes_[i].z);
    }

    std::vector<Medium> media_;
    TracedBoundary boundary_;
    std::optional<double> ground_albedo_;
    double bottom_;
    TracerOptions options_;
    double mu_in_;
    std::vector<RayDirection> eyes_;    // where detectors are, from inside
    std::vector<double> seen_through_;  // of the radiance inside
    std::vector<double> seen_;
};

}  // namespace

bool Estimate::agrees_with(double truth, double sigmas, double allowance) const {
    const double missing = truth - value;
    const double noise = sigmas * standard_error + allowance;
    return missing >= -noise && missing <= noise + unfinished;
}

TracedReflection trace_photons(const TracedStack& stack, double mu_in,
                               const std::vector<Detector>& detectors,
                               const TracerOptions& options) {
    require(mu_in > 0 && mu_in <= 1, "mu_in", mu_in, "(0, 1]");
    require(options.photons >= 2, "number of photons", options.photons, "[2, inf)");
    require(options.most_collisions >= 1, "most collisions", options.most_collisions, "[1, inf)");
    return Tracer(stack, mu_in, detectors, options).trace();
}

}  // namespace miebrdf::bench
