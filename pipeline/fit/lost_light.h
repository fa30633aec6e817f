// Light that leaves a sample beside the ports of integrating spheres.
#pragma once

#include <miebrdf/fit.h>

#include <span>
#include <vector>

namespace miebrdf::fitting {

class Model;

/// A layer of a sample; what scatters follows Henyey and Greenstein.
struct Plate {
    double index = 1.0, thickness_mm = 0.0;
    double scattering_per_mm = 0.0, absorption_per_mm = 0.0, asymmetry = 0.0;
};

/// A sample, and diameters in mm of concentric circles: lit by the beam and by diffuse light, and
/// the ports above and below.
struct LitSample {
    std::vector<Plate> plates = {};  ///< from above
    double mu_in = 1.0;
    double beam_mm = 0.0, diffuse_mm = 0.0, port_above_mm = 0.0, port_below_mm = 0.0;
    double index_below = 1.0;
};

/// Traces photons, the same ones each time: the result is smooth in the plates' numbers. The
/// standard error of a share p is at most sqrt(p / 50000).
LostLight trace_lost_light(const LitSample& sample);

/// Sets FitData::lost of those that ask for it, for the scenes at these numbers.
/// @param problem  the model's own
/// @return the largest change of a share
/// @throws UsageError  for layers without a thickness
double update_lost_light(FitProblem& problem, const Model& model, std::span<const double> numbers);

}  // namespace miebrdf::fitting
