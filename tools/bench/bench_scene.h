// A scene of Henyey-Greenstein layers in the words of every method, and the methods themselves.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "rte/stack/layered_reflection.h"
#include "tools/bench/approximations.h"
#include "tools/bench/discrete_problem.h"
#include "tools/bench/measurement.h"
#include "tools/bench/photon_tracer.h"

namespace miebrdf::bench {

/// Base and at most one coat; asymmetry 0 is isotropic scattering.
struct BenchScene {
    SimpleLayer base;
    std::optional<SimpleLayer> coat;

    rte::Stack for_solver() const;
    MomentStack for_textbooks() const;
    TracedStack for_photons() const;
    SimpleStack for_approximations() const { return {base, coat}; }
};

/// Directions: R is wanted at every combination, or (no mu_out) the plane albedo at mu_in.
struct Wanted {
    std::vector<double> mu_in, mu_out, azimuth_deg;
    bool is_albedo() const { return mu_out.empty(); }
};

/// One run of the library with these options.
std::vector<double> run_solver(const BenchScene& scene, const Wanted& wanted,
                               const rte::SolverOptions& options);

/// The library as its users call it (knob: tolerance), its methods on given nodes, and the
/// iteration of the paper on the paper's grid without delta-M (knobs: nodes, tolerance).
std::vector<Contender> library_methods(const BenchScene& scene, const Wanted& wanted);

/// The paper's eq. (2) in one and more steps, with and without its single-scattering patch, and the
/// exponential integrator of the same cost; on 32 nodes of the library's grid. Needs a coat.
std::vector<Contender> stepwise_coats(const BenchScene& scene, const Wanted& wanted);

/// Adding-doubling, discrete ordinates, photons, and the closed-form short cuts.
std::vector<Contender> outside_methods(const BenchScene& scene, const Wanted& wanted);

/// The library's methods, then those outside of it.
std::vector<Contender> all_methods(const BenchScene& scene, const Wanted& wanted);

}  // namespace miebrdf::bench
