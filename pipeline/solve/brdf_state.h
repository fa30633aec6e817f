// The state that copies of a Brdf share.
#pragma once

#include <miebrdf/brdf.h>

#include <memory>
#include <numeric>
#include <utility>
#include <vector>

#include "pipeline/solve/resolved_scene.h"

namespace miebrdf {

struct BrdfState {
    static const BrdfState& of(const Brdf& brdf) { return *brdf.state_; }
    static Brdf brdf_with(BrdfState state) {
        return Brdf(std::make_shared<const BrdfState>(std::move(state)));
    }

    Scene scene;
    ResolvedScene resolved;
    SolverOptions solver;
    Control control;  ///< its memo is never null
    /// Above 0: tables are solved once, with so many nodes, without an estimate of their error and
    /// without glories: previews.
    int unchecked_nodes = 0;
};

/// Indices of all the wavelengths of a scene.
inline std::vector<std::size_t> all_wavelengths(const ResolvedScene& scene) {
    std::vector<std::size_t> indices(scene.wavelength_nm.size());
    std::iota(indices.begin(), indices.end(), std::size_t{0});
    return indices;
}

}  // namespace miebrdf
