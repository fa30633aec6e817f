// How the error of a spectral result is put together from that of its wavelengths.
#pragma once

#include <algorithm>

#include "pipeline/layers.h"

namespace miebrdf {

/// What every slice says about how it came about.
template <typename Slice>
void set_report(Slice& slice, const LayerSlice& layers, double wavelength_nm) {
    slice.wavelength_nm = wavelength_nm;
    slice.report = layers.report;
    slice.mie_error_estimate = layers.mie_error_estimate;
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
    }
}

}  // namespace miebrdf
