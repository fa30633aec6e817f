// Small scenes, directions and counters of work, for tests of the pipeline and of its consumers.
#pragma once

#include <miebrdf/brdf.h>

#include <cstddef>
#include <map>
#include <random>
#include <string>
#include <vector>

namespace miebrdf::support {

/// Layers on a base, in the words of medium() and layer(). Spheres have the default sizes unless
/// the words say otherwise: write "index:1.5,0.01,radius=1" where Mie theory should be quick.
inline Scene scene_of(const std::string& base, const std::vector<std::string>& layers = {}) {
    Scene scene;
    scene.base = medium(base);
    for (const std::string& words : layers) scene.layers.push_back(layer(words));
    return scene;
}

/// Puts a scene under a rough surface.
inline Scene under_surface(Scene scene, double beckmann_alpha = 0.3,
                           std::optional<std::complex<double>> index = {}) {
    scene.surface = rte::SurfaceOptions{.beckmann_alpha = beckmann_alpha};
    scene.surface_index = index;
    return scene;
}

/// Steep, slanted and grazing ones; 2 x 2 x 3.
inline Directions few_directions() { return {{0.3, 1.0}, {0.2, 0.9}, {0.0, 70.0, 180.0}}; }

/// Cosines evenly spread over (lowest, 1), azimuths over (0, 180); the same in every run.
inline std::vector<Direction> random_directions(std::size_t count, double lowest_cosine,
                                                unsigned seed = 5) {
    std::mt19937_64 engine(seed);
    const auto uniform = [&](double from, double to) {
        return from + (to - from) * (static_cast<double>(engine() >> 12) + 0.5) * 0x1p-52;
    };
    std::vector<Direction> directions;
    for (std::size_t i = 0; i < count; ++i) {
        const double mu_in = uniform(lowest_cosine, 1.0), mu_out = uniform(lowest_cosine, 1.0);
        directions.push_back({mu_in, mu_out, uniform(0.0, 180.0)});
    }
    return directions;
}

/// The total at one direction, solved for it alone.
inline double value_at(const Brdf& brdf, const Direction& d, std::size_t wavelength = 0) {
    return brdf.evaluate({{d.mu_in}, {d.mu_out}, {d.azimuth_deg}}).at(wavelength, 0, 0, 0);
}

/// The values of a table at one direction, one for each wavelength.
inline std::vector<double> values_at(const BrdfSource& source, const Direction& direction) {
    std::vector<double> values(source.channels().size());
    source.evaluate({&direction, 1}, values);
    return values;
}

/// Stages that a computation went through, with the number of jobs of each stage's last run. Must
/// outlive its control().
struct Stages {
    std::map<std::string, std::size_t> jobs;

    Control control(int threads = 1) {
        return {.threads = threads,
                .progress = [this](const std::string& stage, std::size_t, std::size_t total) {
                    jobs[stage] = total;
                }};
    }
};

}  // namespace miebrdf::support
