// Albedos of many layers at once, of media that a few numbers describe: for look-up tables and fits
// that need neither names nor Mie theory.
#pragma once

#include <cstddef>
#include <span>
#include <vector>

#include <miebrdf/control.h>
#include <miebrdf/language.h>
#include <miebrdf/solver.h>

#pragma GCC visibility push(default)
namespace miebrdf {

/// Homogeneous layers of Henyey-Greenstein media, each on a Lambertian ground. Every list but mu_in
/// has one value for each layer, or one value for all of them.
struct LayerBatch {
    std::span<const double> single_scattering_albedo;  ///< in [0, 1]
    std::span<const double> asymmetry;                 ///< g in (-1, 1); 0: isotropic
    std::span<const double> optical_depth;             ///< >= 0; infinite: no ground shows
    std::span<const double> host_index;     ///< in [1, 3], below a smooth boundary; 1: no boundary
    std::span<const double> ground_albedo;  ///< in [0, 1]
    std::span<const double> mu_in;          ///< in (0, 1], of all layers; may be empty
};

/// Results of each layer, in their order.
struct LayerAlbedos {
    std::vector<double> plane_albedo;      ///< [layer * mu_in.size() + i], with the mirror's part
    std::vector<double> spherical_albedo;  ///< in [0, 1]
    /// Net flux into the ground, as plane_albedo; 0 below a layer of infinite depth.
    std::vector<double> plane_transmittance;
    std::vector<double> error_estimate;    ///< relative to the largest value at that incidence
    std::vector<unsigned char> converged;  ///< 1: within the tolerance
};

/// Solves all layers; threads share them. Results are those of solving each alone, to the last bit.
/// Neighbours of the same asymmetry share their moments: put it on the slowest axis of a table.
/// @throws UsageError  for lists of different lengths, and for a value out of range with its place
/// @throws Cancelled   when control.is_cancelled said so
LayerAlbedos layer_albedos(const LayerBatch& layers, const rte::SolverOptions& options = {},
                           const Control& control = {});

/// The colour of a half-space of Henyey-Greenstein scatterers, as renderers name it: of uniform
/// light that enters, the share that comes out again, in [0, 1]: (A - r) / (1 - r), A the spherical
/// albedo and r what a smooth boundary reflects (0 without one). docs/subsurface.md.
/// @param single_scattering_albedo, asymmetry, host_index  as of LayerBatch
/// @return one value for each medium
/// @throws UsageError, Cancelled  as layer_albedos
std::vector<double> subsurface_colour(std::span<const double> single_scattering_albedo,
                                      std::span<const double> asymmetry,
                                      std::span<const double> host_index,
                                      const rte::SolverOptions& options = {},
                                      const Control& control = {});

/// The single-scattering albedo that gives such a colour: the inverse of subsurface_colour, found
/// to a hundredth of options.tolerance in the colour.
/// @param colour  in [0, 1]
/// @throws UsageError, Cancelled  as layer_albedos
std::vector<double> subsurface_albedo(std::span<const double> colour,
                                      std::span<const double> asymmetry,
                                      std::span<const double> host_index,
                                      const rte::SolverOptions& options = {},
                                      const Control& control = {});

}  // namespace miebrdf
#pragma GCC visibility pop
