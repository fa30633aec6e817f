// Monte Carlo transport of photons through coats on a half-space: the check from outside.
// It shares no code and no equation with rte/: photons move, scatter and leave.
#pragma once

#include <cstdint>
#include <vector>

#include "tools/bench/scattering_law.h"

namespace miebrdf::bench {

/// One homogeneous layer for the tracer.
struct TracedLayer {
    double single_scattering_albedo = 0.0;
    ScatteringLaw law = ScatteringLaw::isotropic();
    double optical_depth = 0.0;  ///< ignored for the base, which has no end
};

struct TracedStack {
    TracedLayer base;
    std::vector<TracedLayer> coats;  ///< in painting order: the last one is on top
};

/// A direction in which reflected light is looked at; conventions of docs/conventions.md.
struct Detector {
    double mu_out = 1.0;
    double azimuth_deg = 0.0;
};

struct TracerOptions {
    int photons = 100000;
    std::uint64_t seed = 1;
    /// Photons that are still inside after so many collisions are given up and counted in
    /// `Estimate::unfinished`: without absorption some of them never come back.
    int most_collisions = 20000;
};

/// Mean of what the photons say, and how sure it is.
struct Estimate {
    double value = 0.0;
    double standard_error = 0.0;  ///< of the mean, from the spread over photons
    /// Largest amount by which photons given up may have made `value` too small.
    double unfinished = 0.0;

    /// Whether a truth is inside `sigmas` standard errors (and what was given up).
    bool agrees_with(double truth, double sigmas, double allowance = 0.0) const;
};

struct TracedReflection {
    Estimate plane_albedo;
    std::vector<Estimate> reflection;  ///< R = pi * BRDF at each detector
};

/// Traces photons that arrive at mu_in.
///
/// Free paths are exponential in optical depth; absorption is a weight, ended by Russian roulette.
/// The plane albedo is the weight that leaves. R at a detector is the sum over collisions of
/// w P(Theta) exp(-t / mu_out) / (4 mu_out), t the optical depth below the top (next-event or local
/// estimate; Marchuk et al. 1980, "The Monte Carlo Methods in Atmospheric Optics", ch. 2).
/// Photon i uses random stream i of the seed, so results are reproducible bit by bit.
///
/// @param mu_in  in (0, 1]
/// @throws std::invalid_argument  for a cosine, albedo, optical depth or count out of range
TracedReflection trace_photons(const TracedStack& stack, double mu_in,
                               const std::vector<Detector>& detectors,
                               const TracerOptions& options = {});

}  // namespace miebrdf::bench
