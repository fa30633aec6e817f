// Scenes of Henyey-Greenstein layers in the words of every method, and the methods themselves. A
// scene is a stack of the solver; what is wanted are reflections at all combinations of directions,
// or (no mu_out) plane albedos at mu_in.
#pragma once

#include <vector>

#include "rte/stack/layered_reflection.h"
#include "tools/bench/approximations.h"
#include "tools/bench/discrete_problem.h"
#include "tools/bench/measurement.h"
#include "tools/bench/photon_tracer.h"

namespace miebrdf::bench {

/// Henyey-Greenstein's phase function; asymmetry 0 is isotropic scattering.
rte::Optics scatterers(double albedo, double asymmetry);

SimpleStack simple(const rte::Stack& stack);
MomentStack moments_of(const rte::Stack& stack);
/// For a half-space or a Lambertian ground under coats of one index.
TracedStack traced(const rte::Stack& stack);
std::vector<Detector> detectors(const rte::Directions& wanted);

/// Calls visit(mu_in, mu_out, azimuth_deg) in the order of reflection tables.
template <typename Visit>
void for_each_direction(const rte::Directions& d, const Visit& visit) {
    for (const double in : d.mu_in)
        for (const double out : d.mu_out)
            for (const double azimuth : d.azimuth_deg) visit(in, out, azimuth);
}

/// The answer of the library.
std::vector<double> solved(const rte::Stack& stack, const rte::Directions& wanted,
                           const rte::SolverOptions& options);
Answer photons(const TracedStack& stack, const rte::Directions& wanted, int number);

/// The library as its users call it (knob: tolerance), its methods on given nodes, and the
/// iteration of the paper on the paper's grid without delta-M (knobs: nodes, tolerance).
void add_library_methods(const rte::Stack& stack, const rte::Directions& wanted, BenchCase& c);

/// The paper's eq. (2) in one and more steps, with and without its single-scattering patch, and the
/// exponential integrator of the same cost; on 32 nodes of the library's grid. Needs a coat.
void add_stepwise_coats(const rte::Stack& stack, const rte::Directions& wanted, BenchCase& c);

/// Adding-doubling, discrete ordinates, photons, and the closed-form short cuts.
void add_outside_methods(const rte::Stack& stack, const rte::Directions& wanted, BenchCase& c);

}  // namespace miebrdf::bench
