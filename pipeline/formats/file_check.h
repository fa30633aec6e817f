// Physics of a BRDF file, as the program that reads it will see it.
#pragma once

#include <optional>

#include "pipeline/formats/deviation.h"

namespace miebrdf::exports {

struct FileCheck {
    /// Root mean square of |f(i, o) - f(o, i)| / mean of both, directions with both cosines > 0.2;
    /// empty when a table lists no pair of directions both ways.
    std::optional<double> reciprocity_rms;
    /// Directional, of all channels and angles of incidence; empty when a table has too few
    /// directions to integrate over.
    std::optional<double> largest_albedo;
    /// Estimate of what integrating over a table's directions may err by, there; the albedo shown
    /// is the one that is largest without it.
    double largest_albedo_error = 0.0;
    double largest_albedo_mu = 0.0;
    std::string largest_albedo_channel;
    double least_value = 0.0;    ///< of the BRDF, 1/sr
    std::size_t missing = 0;     ///< directions without a value
    std::size_t directions = 0;  ///< looked at for the above
    /// Largest relative difference of the albedo found by importance sampling from the integrated
    /// one; empty without sampling tables.
    std::optional<double> sampled_albedo_error;
};

/// Looks at `directions` random directions, and integrates at six angles of incidence, mu 0.1 to 1.
/// Of tables it looks at what they list: random combinations, and all angles of incidence.
FileCheck check_file(const BrdfFile& file, std::size_t directions = 4000);

/// Integral of BRDF times cosine over the outgoing hemisphere, one for each channel: Gauss-Legendre
/// in the cosine (32 nodes) and 64 midpoints in azimuth; good to 1e-3 for smooth BRDFs.
std::vector<double> directional_albedo(const BrdfFile& file, double mu_in);

/// Largest relative difference between directional albedos of the file and of the BRDF that it was
/// made from, over channels and mu_in = 0.1 ... 1; both integrated at the same directions. Tables
/// that no program interpolates are integrated at their own (table_check.h).
double albedo_error(const BrdfFile& file, const BrdfSource& source);

}  // namespace miebrdf::exports
