// How the error of a spectral result is put together from that of its steps.
#pragma once

#include <algorithm>

#include "pipeline/scene_optics.h"
#include "rte/layered_reflection.h"

namespace miebrdf {

/// What every slice says about how it came about.
template <typename Slice>
void set_report(Slice& slice, const SceneOptics& optics, const rte::SolverReport& report) {
    slice.report = report;
    slice.mie_error_estimate = optics.mie_error_estimate;
    slice.error_estimate = report.error_estimate + optics.mie_error_estimate;
    slice.converged = report.converged && optics.converged;
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
