#include "tools/miebrdf/media_options.h"

#include <algorithm>
#include <numeric>

namespace miebrdf::program {

void MediaArguments::add_to(CLI::App& command, Shell& shell,
                            const std::string& default_wavelengths) {
    scene_.add_to(command, shell, words_of_media(), default_wavelengths);
}

MediaSpectra MediaArguments::look_up(const std::vector<std::string>& media,
                                     OpticsDemand demand) const {
    Request request = scene_.parse();
    Scene& scene = request.scene;
    scene.base = medium(media.front());
    // They lie side by side, not in layers; a depth only says that they are there.
    for (std::size_t m = 1; m < media.size(); ++m) scene.layers.push_back({medium(media[m]), 1.0});
    validate(scene);
    if (scene.particles.tolerance > 0.0) demand.tolerance = scene.particles.tolerance;
    return {resolve(scene, request.wavelength_nm), std::move(demand),
            describe_particles(scene.base, scene.particles)};
}

void MediaSpectra::compute(const Control& control) {
    const auto all = [](std::size_t count) {
        std::vector<std::size_t> indices(count);
        std::iota(indices.begin(), indices.end(), std::size_t{0});
        return indices;
    };
    optics =
        optics_of(scene, all(scene.media.size()), all(scene.wavelength_nm.size()), demand, control);
}

bool MediaSpectra::converged() const {
    return std::all_of(optics.begin(), optics.end(), [](const auto& media) {
        return std::all_of(media.begin(), media.end(),
                           [](const MediumOptics& o) { return o.converged; });
    });
}

}  // namespace miebrdf::program
