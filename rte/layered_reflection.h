// Reflection by coats on a base: the whole radiative transfer of one wavelength behind two
// functions. Symbols, signs and normalisation: docs/conventions.md.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "rte/optics.h"

namespace miebrdf::rte {

/// A homogeneous layer of finite optical depth.
struct Coat {
    Optics optics;
    double optical_depth = 0.0;  ///< of extinction, vertical, >= 0
};

/// A semi-infinite base and its coats in painting order: the last one is on top.
struct Stack {
    Optics base;
    std::vector<Coat> coats;
};

enum class GridKind { automatic, gauss, mapped_gauss, paper };
enum class HalfSpaceMethod { automatic, fixed_point, doubling };
enum class CoatMethod { automatic, first_order, first_order_patched, exponential };

struct SolverOptions {
    double tolerance = 1e-3;  ///< relative to the largest value at that incidence
    GridKind grid = GridKind::automatic;
    int streams = 0;  ///< zenith nodes per hemisphere, 2 to 256; 0: from the tolerance
    HalfSpaceMethod half_space_method = HalfSpaceMethod::automatic;
    CoatMethod coat_method = CoatMethod::automatic;
    int coat_substeps = 1;  ///< for the stepwise coat methods
    bool delta_m = true;
    bool single_scattering_correction = true;
};

/// Every combination of the three lists is wanted.
struct Directions {
    std::vector<double> mu_in;        ///< in (0, 1]
    std::vector<double> mu_out;       ///< in (0, 1]
    std::vector<double> azimuth_deg;  ///< 0 = forward side, 180 = back towards the source
};

/// How a result came about; numbers to read, not exceptions.
struct SolverReport {
    int streams = 0;
    int moments = 0;           ///< Legendre moments kept
    int azimuthal_orders = 0;  ///< Fourier orders summed, m = 0 included
    int iterations = 0;        ///< most of any order, for iterative methods
    double error_estimate = 0.0;  ///< relative to the largest value at that incidence
    bool converged = false;       ///< error_estimate <= tolerance
    std::string method;
};

/// reflection[(i * mu_out.size() + o) * azimuth_deg.size() + a] = R(mu_in[i], mu_out[o],
/// azimuth_deg[a]); BRDF = R / pi.
struct ReflectionTable {
    std::vector<double> reflection;
    SolverReport report;
};

struct AlbedoTable {
    std::vector<double> plane_albedo;  ///< one for each mu_in
    double spherical_albedo = 0.0;
    SolverReport report;
};

/// R at the directions asked for, by the equations themselves: nothing is interpolated.
/// @throws std::invalid_argument  for optics, optical depths, cosines, azimuths or options out of
///         range, with the value and what is allowed. Not converging is an outcome.
ReflectionTable reflect(const Stack& stack, const Directions& directions,
                        const SolverOptions& options = {});

/// Plane albedo at each mu_in and spherical albedo: azimuthal order 0 alone.
AlbedoTable albedo(const Stack& stack, const std::vector<double>& mu_in,
                   const SolverOptions& options = {});

}  // namespace miebrdf::rte
