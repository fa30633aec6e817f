// Albedos of many layers at once, of media that a few numbers describe: for look-up tables and fits
// that need neither names nor Mie theory. And what passes a film, direction by direction.
#pragma once

#include <cstddef>
#include <memory>
#include <span>
#include <string>
#include <vector>

#include <miebrdf/brdf.h>
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

/// Provenance::component of a FilmTransmission.
inline constexpr char kTransmitted[] = "transmitted";

/// The BTDF of a film in air (substrate none, or black without a boundary), 1/sr without the
/// cosine: light from mu_in above leaves below at mu_out, the cosine from the normal of that side;
/// azimuth 0 goes straight on. From below upwards the BTDF is the same with mu_in and mu_out
/// exchanged, as both sides are in air. Light as a number, without polarisation; made for
/// export_brdf and for loops, as BrdfTable. Copies share their data. Spheres of several wavelengths
/// send most of their light into a narrow cone about the straight beam, of which what is scattered
/// twice and more is spread too widely (delta-M): `report` has the light that is missing.
class FilmTransmission : public BrdfSource {
  public:
    /// Solves all wavelengths.
    /// @throws UsageError  with the reason where nothing passes or no direction of it is known:
    ///         half-spaces, grounds, metals, surfaces, rough boundaries
    explicit FilmTransmission(const Brdf& film, const std::string& command_line = {});

    const std::vector<std::string>& channels() const override;
    const std::vector<double>& wavelength_nm() const override;
    /// left_out tells the unscattered share, a delta that no value holds.
    const Provenance& provenance() const override;
    /// @throws UsageError  as BrdfTable
    void evaluate(std::span<const Direction> directions, std::span<double> values) const override;

    /// The share of a beam that passes without being scattered, in [0, 1]; all else that passes is
    /// the integral of BTDF times mu_out.
    /// @throws UsageError  for an index beyond its list and a cosine outside (0, 1]
    double unscattered(std::size_t wavelength, double mu_in) const;

    /// Its error estimates include the light that the directions and the unscattered share together
    /// miss of the plane transmittance along the normal, relative to that.
    const ResultReport& report() const;

  private:
    struct State;
    std::shared_ptr<const State> state_;
};

}  // namespace miebrdf
#pragma GCC visibility pop
