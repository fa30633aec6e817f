// Options of a caller, and the solver's report on how it went.
#pragma once

#include <cstddef>
#include <string>
#include <vector>

#pragma GCC visibility push(default)
namespace miebrdf::rte {

/// Zenith nodes per hemisphere.
inline constexpr int kFewestNodes = 2;
inline constexpr int kMostNodes = 256;

enum class GridKind { automatic, gauss, mapped_gauss, paper };
enum class HalfSpaceMethod { automatic, fixed_point, doubling };
enum class CoatMethod { automatic, first_order, first_order_patched, exponential };

/// How the equations are solved; `automatic` meets the tolerance.
struct SolverOptions {
    double tolerance = 1e-3;  ///< in (0, 1), relative to the largest value at that incidence
    GridKind grid = GridKind::automatic;  ///< of the zenith nodes
    int streams = 0;  ///< zenith nodes per hemisphere, 2 to 256; 0: from the tolerance
    HalfSpaceMethod half_space_method = HalfSpaceMethod::automatic;  ///< of the base
    CoatMethod coat_method = CoatMethod::automatic;                  ///< of the coats
    int coat_substeps = 1;                     ///< of the stepwise coat methods, 1 to 1000000
    bool delta_m = true;                       ///< truncates the forward peak
    bool single_scattering_correction = true;  ///< light scattered once is exact
    /// Components of light: 1 (the intensity I alone), 3 (I, Q, U) or 4 (with V); 0: 3 where
    /// polarisation shows in the intensity (docs/polarisation.md), else 1. Brdf looks at it, the
    /// solvers of rte do not.
    int stokes = 0;
};

/// Every combination of the three lists is wanted.
struct Directions {
    std::vector<double> mu_in;        ///< in (0, 1]
    std::vector<double> mu_out;       ///< in (0, 1]
    std::vector<double> azimuth_deg;  ///< 0 = forward side, 180 = back towards the source
};

/// How a result came about; numbers to read, not exceptions.
struct SolverReport {
    int streams = 0;              ///< nodes of a hemisphere
    int moments = 0;              ///< Legendre moments kept
    int fourier_orders = 0;       ///< summed, m = 0 included
    int iterations = 0;           ///< most of any order, for iterative methods
    double error_estimate = 0.0;  ///< relative to the largest value at that incidence
    /// Share of the values whose own estimate meets the tolerance, and the index of the worst one:
    /// a peak on the horizon may be wrong where everything else has long converged.
    double share_within_tolerance = 1.0;
    std::size_t worst_value = 0;     ///< place in the values
    double worst_mu_in = 0.0;        ///< its directions; 0: none is worse than another
    double worst_mu_out = 0.0;       ///< 0 for albedos
    double worst_azimuth_deg = 0.0;  ///< degrees
    bool converged = false;          ///< error_estimate <= tolerance, and so has every step
    std::string method;              ///< in words
};

}  // namespace miebrdf::rte
#pragma GCC visibility pop
