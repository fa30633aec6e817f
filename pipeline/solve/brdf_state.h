// What copies of a Brdf share.
#pragma once

#include <miebrdf/brdf.h>

#include <memory>
#include <numeric>
#include <string>
#include <vector>

#include "pipeline/solve/resolved_scene.h"

namespace miebrdf {

struct Brdf::State {
    Scene scene;
    ResolvedScene resolved;
    SolverOptions solver;
    Control control;  ///< its memo is never null
};

/// Indices of all the wavelengths of a scene.
inline std::vector<std::size_t> all_wavelengths(const ResolvedScene& scene) {
    std::vector<std::size_t> indices(scene.wavelength_nm.size());
    std::iota(indices.begin(), indices.end(), std::size_t{0});
    return indices;
}

}  // namespace miebrdf
