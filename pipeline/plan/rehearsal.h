// A request done in small, for `plan`: a few of its wavelengths, with as much of the work as tens
// of milliseconds allow, tell how many nodes and sizes the rest will take, and how fast this
// machine is.
#pragma once

#include <cstddef>
#include <vector>

#include "pipeline/plan/cost_model.h"
#include "pipeline/solve/layers.h"

namespace miebrdf {

/// What a wavelength will take, on one thread; of several wavelengths the mean.
struct Rehearsal {
    bool took_place = false;
    /// Single scattering, measured over estimated (mie_seconds). Media whose scattering matrices
    /// are taken have no other: those do not count here.
    double mie_factor = 1.0;
    double matrices_s = 0.0;  ///< scattering matrices
    double transfer_s = 0.0;
    double single_angles_s = 0.0;  ///< phase functions anew, where they are too noisy
    double polarised = 0.0;        ///< share of the wavelengths that take several components
    int streams = 0;               ///< most that a wavelength will end with
    int orders = 0;                ///< with those
};

/// @param wavelengths  that are to be solved
/// @param lowest       index of the lowest medium that shows
Rehearsal rehearse(const LayerRequest& request, const std::vector<std::size_t>& wavelengths,
                   std::size_t lowest);

/// Single scattering of the media that show at one wavelength, each different species once.
double mie_seconds(const LayerRequest& request, std::size_t wavelength, std::size_t lowest,
                   double tolerance, bool whole_phase);

}  // namespace miebrdf
