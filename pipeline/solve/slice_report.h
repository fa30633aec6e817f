// What the spectral results have in common: one layer job and one slice for each wavelength, and
// how their errors add up to that of the whole.
#pragma once

#include <algorithm>
#include <functional>

#include "pipeline/solve/layers.h"
#include "pipeline/solve/parallel.h"

namespace miebrdf {

/// What every slice says about how it came about.
template <typename Slice>
void set_report(Slice& slice, const LayerSlice& layers, double wavelength_nm) {
    slice.wavelength_nm = wavelength_nm;
    slice.report = layers.report;
    slice.mie_error_estimate = layers.mie_error_estimate;
    slice.phase_noise = layers.phase_noise;
    slice.error_estimate = layers.error_estimate;
    slice.converged = layers.converged;
}

/// The whole is as good as its worst wavelength.
template <typename Result>
void summarise(Result& result) {
    result.converged = true;
    for (const auto& slice : result.slices) {
        result.converged = result.converged && slice.converged;
        result.error_estimate = std::max(result.error_estimate, slice.error_estimate);
        if (!(slice.phase_noise.largest > result.phase_noise.largest)) continue;
        result.phase_noise = slice.phase_noise;
        result.phase_noise_wavelength_nm = slice.wavelength_nm;
    }
}

/// Turns the layers of each wavelength into a slice of the result.
/// @param finish  (slice, layers): adds the surface; called in parallel
template <typename Result, typename Finish>
Result assemble(std::vector<LayerSlice> layers, const Request& request, const SceneMedia& media,
                const RunControl& control, const Finish& finish) {
    Result result;
    result.sources = media.sources();
    result.slices.resize(layers.size());
    run_parallel("surface", layers.size(), control, [&](std::size_t w) {
        set_report(result.slices[w], layers[w], request.wavelength_nm[w]);
        finish(result.slices[w], std::move(layers[w]));
    });
    summarise(result);
    return result;
}

}  // namespace miebrdf
