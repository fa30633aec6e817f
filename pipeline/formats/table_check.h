// Tables over lists of directions, judged at those directions and nowhere else.
#pragma once

#include "pipeline/formats/readers/brdf_file.h"

namespace miebrdf::exports {

/// Directional albedo at one listed cosine of incidence, each list with one number per channel.
struct TableAlbedo {
    double mu_in = 0.0;
    std::vector<double> albedo;
    /// What taking every second direction changes: a table of a few cosines does not say what a
    /// rainbow between two of them reflects.
    std::vector<double> error_estimate;
};

/// Integrals over the listed outgoing directions: trapezoids in azimuth (exact for as many Fourier
/// orders as there are azimuths, when they are equally spaced over half a turn or all of it), and
/// in the cosine a monotone cubic in arcsin(sqrt(mu)), in which the default cosines are equally
/// spaced. Beyond the ends of a list its last value holds.
/// @return  empty when fewer than three outgoing cosines or azimuths leave nothing to estimate from
std::vector<TableAlbedo> table_albedos(const BrdfFile& file, const ListedDirections& lists);

/// Whether the list holds the cosine, to rounding.
bool holds(const std::vector<double>& cosines, double mu);

/// Random combinations of the lists; the same on every machine for a seed.
std::vector<Direction> random_listed(const ListedDirections& lists, std::size_t count,
                                     std::uint64_t seed);

}  // namespace miebrdf::exports
