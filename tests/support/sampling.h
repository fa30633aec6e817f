// Importance sampling put to the test: does it draw what it says, and does it carry all the light?
#pragma once

#include "pipeline/exports/readers/brdf_file.h"

namespace miebrdf::support {

/// Mean over samples of BRDF * cosine / density in each channel: the directional albedo as a
/// renderer that samples by the file's tables finds it.
/// @param mu_fixed  the cosine that sampling starts from
std::vector<double> sampled_albedo(const exports::BrdfFile& file, double mu_fixed, int samples);

/// Directional albedo by 200 x 200 midpoints: within 1e-4 for smooth BRDFs at mu_in >= 0.1.
std::vector<double> integrated_albedo(const exports::BrdfSource& source, double mu_in);

/// Pearson's chi-square of samples in 10 x 12 bins of cosine and azimuth against the density
/// integrated over each bin; bins with fewer than five expected samples are pooled.
/// @return  the probability of a value at least as large, were the density right
double chi_square_probability(const exports::BrdfFile& file, double mu_fixed, int samples);

}  // namespace miebrdf::support
