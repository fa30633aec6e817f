// What a finite number of sphere sizes leaves in the values at single directions.
#pragma once

#include <vector>

#include "rte/stack/layered_reflection.h"

namespace miebrdf {

/// An rms relative to the largest value at its incidence, and the direction where it is largest.
struct PhaseNoise {
    double largest = 0.0;
    double mu_in = 0.0;  ///< 0: there is no noise
    double mu_out = 0.0;
    double azimuth_deg = 0.0;
};

/// Transparent spheres ripple in size and angle: points of their averaged phase function err by a
/// few parts in a thousand (mie::PhaseTable::noise), independently of each other, and light
/// scattered once brings that into R. Moments, albedos and means over directions average it out, so
/// that it is told apart from the error estimate.
///
/// Single scattering as in rte::single_scattering with the noise for P, the layers' contributions
/// added up and nothing weakened by what lies above: an upper estimate of the rms.
///
/// @param reflection  R laid out as in rte::ReflectionTable
/// @param moments     kept by delta-M (rte::SolverReport)
PhaseNoise largest_phase_noise(const rte::Stack& stack, const rte::Directions& directions,
                               const std::vector<double>& reflection, int moments);

}  // namespace miebrdf
