// Importance sampling put to the test: does it draw what it says, and does it carry all the light?
#pragma once

#include <functional>

#include <miebrdf/brdf_source.h>
#include <miebrdf/formats.h>
#include "tests/support/outside/outside_file.h"

namespace miebrdf::support {

/// A file's sampling at one fixed direction, whichever reader the file was read with.
struct Sampling {
    std::function<std::optional<Vector>(double u, double v)> draw;
    std::function<double(const Vector&)> density;
    std::function<std::vector<double>(const Vector&)> brdf;
};

Sampling sampling_of(const OutsideFile& file, double mu_fixed);
Sampling sampling_of(const BrdfFile& file, double mu_fixed);

/// Mean over samples of BRDF * cosine / density in each channel: the directional albedo as a
/// renderer that samples by the file's tables finds it.
std::vector<double> sampled_albedo(const Sampling& sampling, int samples);

/// Directional albedo by 200 x 200 midpoints: within 1e-4 for smooth BRDFs at mu_in >= 0.1.
std::vector<double> integrated_albedo(const BrdfSource& source, double mu_in);

/// Pearson's chi-square of samples in 10 x 12 bins of cosine and azimuth against the density
/// integrated over each bin; bins with fewer than five expected samples are pooled.
/// @return  the probability of a value at least as large, were the density right
double chi_square_probability(const Sampling& sampling, int samples);

/// The light in the x-z plane, the viewer where Direction has it.
Vector to_light(const Direction& direction);
Vector to_viewer(const Direction& direction);

}  // namespace miebrdf::support
