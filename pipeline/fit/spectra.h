// Measured spectra from fewer solved wavelengths: interpolation, an axis that is off, bands.
#pragma once

#include <cstddef>
#include <functional>
#include <vector>

#include "pipeline/fit/job.h"

namespace miebrdf::fitting {

/// One solved number's part of a measured value.
struct SolvedShare {
    std::size_t use = 0;  ///< index in Job::uses
    double weight = 0.0;
    double slope = 0.0;  ///< of the weight by the shift of the axis, 1/nm
};

/// The parts of a measured value: sums of solved numbers, cubic between the wavelengths, by a
/// Gaussian band around the wavelength that is meant.
/// @param shift_nm  of the axis, where it is free
std::vector<SolvedShare> parts_of(const Job& job, const Job::Reading& reading, double shift_nm);

/// Makes a job interpolate where a data set has a band or an axis that is off, or where there are
/// more wavelengths than a smooth spectrum needs. Then wavelength_nm are the first to be solved.
void interpolate_spectra(Job& job);

/// Solves the spectra of a job at wavelengths: all values of the first spectrum, then the next.
using SolveAt = std::function<std::vector<double>(const std::vector<double>& nm)>;

/// Those of finest_nm, wavelength_nm among them, between which spectra are interpolated with no
/// more than the error: wherever a solution halfway between two says otherwise, more.
std::vector<double> chosen_wavelengths(const Job& job, double relative_error, const SolveAt& solve);

}  // namespace miebrdf::fitting
