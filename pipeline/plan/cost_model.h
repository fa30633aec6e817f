// Rough run times, for `plan`, by size and tolerance alone: of a request, and of what it would cost
// not to leave something out. Right within a factor of 3 for about nine of ten requests.
#pragma once

#include <complex>
#include <cstddef>

#include <miebrdf/solver.h>
#include "pipeline/solve/resolved_scene.h"

namespace miebrdf {

/// A size average of Mie theory.
struct MieWork {
    mie::SizeDistribution sizes;
    std::complex<double> relative_index;
    double host_index = 1.0;
    double wavelength_nm = 550.0;
    double tolerance = 2e-4;   ///< of the average
    bool whole_phase = false;  ///< the phase function at every angle and all its moments
    std::size_t coatings = 0;
    double t_matrix_seconds = 0.0;  ///< of spheroids
};

/// The average that a species asks for at a wavelength. @pre it goes through Mie theory
MieWork mie_work(const ResolvedSpecies& species, std::size_t w, double tolerance, bool whole_phase);

/// Mie theory for one medium at one wavelength.
double mie_seconds(const MieWork& work);
/// Memory of the results that are kept.
double mie_bytes(const MieWork& work);
/// Memory that it takes while it is computed, beside the program.
double mie_working_bytes(const MieWork& work);

/// The program by itself, and each value at one wavelength: once until it is written, more often
/// while its wavelength is solved.
inline constexpr double kProgramBytes = 13e6;
inline constexpr double kValueBytes = 8.0;
inline constexpr double kValueSolverBytes = 48.0;

/// How fine radiative transfer will probably have to be.
struct TransferSize {
    int streams = 8;
    int orders = 1;          ///< Fourier orders, of directions at any azimuth
    bool particles = false;  ///< phase functions with 4 moments for each stream
};

/// The streams that `auto` ends at, by the narrowest phase function that shows; streams that are
/// asked for as they are. @param lowest index of the lowest medium that shows
TransferSize expected_size(const ResolvedScene& scene, std::size_t lowest,
                           const rte::SolverOptions& solver, const rte::Directions& directions);

/// One Fourier order of a half-space and its coats, on all the numbers of nodes that are tried.
double order_seconds(const TransferSize& size, std::size_t layers, std::size_t cosines);

/// Exact first order and sum over orders, for one pair of directions and azimuth.
double value_seconds(int orders);

/// Surface lobe at one pair of directions and azimuth, and rho at one cosine.
double lobe_seconds();
double rho_seconds();

}  // namespace miebrdf
