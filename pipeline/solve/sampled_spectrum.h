// Spheres at many wavelengths: averages of Mie theory at some of them, cubic between.
#pragma once

#include "pipeline/solve/single_scattering.h"

namespace miebrdf {

/// Spectra of more wavelengths, and more than averages would be taken of, are sampled: averages at
/// some, as many as keep the misfit of cubic interpolation in the middle of every gap within the
/// tolerance of the averages. The error of what lies between is that of its averages, and the
/// largest misfit: halving a gap divides the error of a smooth function by 16, and by nothing what
/// is noise of the averages.
///
/// The coordinate s is the way that spheres take in the space of what their optics depend on:
///     ds^2 = (|d ln x|^2 + |dm|^2 / |m - 1|^2) / w^2 + (d ln(1 + K / .03))^2,
/// w = sqrt(ln(1 + variance)) the width of their law, over which averages are smooth, x their size
/// parameter, m their relative index, K = 4 pi k (4/3 r) / lambda what a mean chord absorbs.
/// 1 - albedo is taken relative to 1 - exp(-K), which has the bands of k.
inline constexpr std::size_t kMostAveraged = 100;

/// Whether a species is one whose spectra may be sampled: spheres whose sizes have a width.
bool can_be_sampled(const ResolvedSpecies& species);

/// What its spectrum was set from. @param all  the species at wavelengths of any order
std::shared_ptr<const ParticleSpectrum> spectrum_of(const ResolvedSpecies& all);

/// Whether so much of a species comes from its spectrum.
bool is_sampled(const Control& control, const ResolvedSpecies& species, const OpticsDemand& demand);

/// About which share of the wavelengths of its spectrum is computed, for plans; 1 without one.
double computed_share(const ResolvedSpecies& species);

/// A species from where it is known (remembered_optics); from its spectrum, where
/// it is_sampled: at the first wavelength all of it is computed, for the memo.
MediumOptics averaged_optics(const Control& control, const ResolvedSpecies& species, std::size_t w,
                             const OpticsDemand& demand, const mie::Executor& run);

}  // namespace miebrdf
