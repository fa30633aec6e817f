// What a caller may choose, and what the solver says about how it went.
#pragma once

#include <cstddef>
#include <string>
#include <vector>

namespace miebrdf::rte {

/// Zenith nodes per hemisphere.
inline constexpr int fewest_nodes = 2;
inline constexpr int most_nodes = 256;

class SolvedHalfSpaces;
struct StackMemory;

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
    /// Of half-spaces that are iterated; 0: a hundredth of `tolerance`. Stacks that are to share a
    /// half-space need the same, whatever else their tolerances are.
    double half_space_tolerance = 0.0;
    /// Where stacks share half-spaces (solved_half_spaces.h); null: each solves its own. The result
    /// is the same to the last bit.
    SolvedHalfSpaces* half_spaces = nullptr;
    /// Where stacks that are solved one after the other, wavelengths for instance, share matrices,
    /// grids and Legendre tables (stack_memory.h); null: each solution has its own. Not for two
    /// threads at a time. The result is the same to the last bit.
    StackMemory* memory = nullptr;
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
    int moments = 0;              ///< Legendre moments kept
    int azimuthal_orders = 0;     ///< Fourier orders summed, m = 0 included
    int iterations = 0;           ///< most of any order, for iterative methods
    double error_estimate = 0.0;  ///< relative to the largest value at that incidence
    /// Share of the values whose own estimate meets the tolerance, and where in the result the
    /// worst one is: a peak on the horizon may be wrong where everything else has long converged.
    double share_within_tolerance = 1.0;
    std::size_t worst_value = 0;
    double worst_mu_in = 0.0;   ///< its directions; 0: none is worse than another
    double worst_mu_out = 0.0;  ///< 0 for albedos
    double worst_azimuth_deg = 0.0;
    bool converged = false;  ///< error_estimate <= tolerance
    std::string method;
};

}  // namespace miebrdf::rte
