// Parts of `check` and of the comparison after an export.
#pragma once

#include <cstdint>
#include <vector>

#include <miebrdf/brdf_source.h>
#include <miebrdf/formats.h>

namespace miebrdf {

/// Cosines and azimuth uniform, each band filled; the same numbers on every machine for a seed.
std::vector<Direction> random_directions(std::size_t count, std::uint64_t seed);

/// Both cosines within (lowest, highest); the half vector is off the normal by 0.001 to 0.5 rad,
/// evenly in its logarithm, so that lobes of any width are met.
std::vector<Direction> lobe_directions(std::size_t count, std::uint64_t seed, double lowest = 0.4,
                                       double highest = 1.0);

/// The outgoing direction is off the incident one, at mu > 0.2, by 0.001 to 0.1 rad, evenly in its
/// logarithm; of every tenth by nothing. Glories of any width are met.
std::vector<Direction> retro_directions(std::size_t count, std::uint64_t seed);

/// One of both directions is as far off the zenith; the other one is anywhere above mu = 0.2.
std::vector<Direction> zenith_directions(std::size_t count, std::uint64_t seed);

/// Random combinations of the lists; the same on every machine for a seed.
std::vector<Direction> random_listed(const ListedDirections& lists, std::size_t count,
                                     std::uint64_t seed);

/// Compares channel by channel. @param source  with as many channels as the file
/// @param peaks  compares about mirror and retro-reflection and the zenith as well
/// @throws UsageError  when their numbers differ
Deviation measure_deviation(const BrdfFile& file, const BrdfSource& source,
                            std::span<const Direction> directions, bool peaks = true);

/// Integral of BRDF times cosine over the outgoing hemisphere, one for each channel: Gauss-Legendre
/// in the cosine (32 nodes) and 64 midpoints in azimuth; good to 1e-3 for smooth BRDFs.
std::vector<double> directional_albedo(const BrdfFile& file, double mu_in);

/// Largest relative difference between directional albedos of the file and of the BRDF that it was
/// made from, over channels and mu_in = 0.1 ... 1; both integrated at the same directions. Tables
/// that no program interpolates are integrated at their own (table_albedos).
double albedo_error(const BrdfFile& file, const BrdfSource& source);

/// Directional albedo at one listed cosine of incidence, each list with one number per channel.
struct TableAlbedo {
    double mu_in = 0.0;
    std::vector<double> albedo;
    /// The change when every second direction is left out: a table of a few cosines does not say
    /// what a rainbow between two of them reflects.
    std::vector<double> error_estimate;
};

/// Integrals over the listed outgoing directions: trapezoids in azimuth (exact for as many Fourier
/// orders as there are azimuths, when they are equally spaced over half a turn or all of it), and
/// in the cosine a monotone cubic in arcsin(sqrt(mu)), in which the default cosines are equally
/// spaced. Beyond the ends of a list its last value holds.
/// @return  empty when fewer than three outgoing cosines or azimuths leave nothing to estimate from
std::vector<TableAlbedo> table_albedos(const BrdfFile& file, const ListedDirections& lists);

}  // namespace miebrdf
