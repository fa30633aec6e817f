// Directions drawn as a BRDF reflects them, for Monte Carlo integration.
//
//     const miebrdf::DirectionSampler sampler(table);
//     const auto to = sampler.sample(mu_in, u1, u2);          // u1, u2 uniform in [0, 1)
//     estimate += f(mu_in, to.mu_out, to.azimuth_deg) * to.mu_out / to.density;
#pragma once

#include <miebrdf/brdf_source.h>
#include <miebrdf/control.h>
#include <miebrdf/language.h>

#include <memory>
#include <vector>

#pragma GCC visibility push(default)
namespace miebrdf {

/// How fine the table of directions is.
struct SamplerOptions {
    /// Weight of each channel of the source, >= 0, not all 0; empty: all alike.
    std::vector<double> weights = {};
    int incidences = 33;  ///< tabulated angles of incidence, 2 to 1000
    int zeniths = 48;     ///< cells in mu_out^2, 1 to 1000
    int azimuths = 48;    ///< cells from 0 to 180 degrees, 1 to 1000
};

/// An outgoing direction and how likely it was.
struct SampledDirection {
    double mu_out = 1.0;       ///< in (0, 1]
    double azimuth_deg = 0.0;  ///< in [0, 360); 0 = mirror side
    double density = 0.0;      ///< per unit of solid angle, > 0
};

/// A table of f mu_out, one for each of some angles of incidence, constant in cells of
/// (mu_out^2, azimuth). A hundredth of the directions follows the cosine alone, so that every
/// direction above the horizon has a positive density: estimates are unbiased whatever the cells
/// miss. The density is exactly that of the directions drawn, also between tabulated incidences,
/// where directions are drawn from one neighbour or the other. Lobes narrower than a cell (surfaces
/// much smoother than a roughness of 0.05) are sampled too widely, which costs variance.
///
/// Copies share their table; const functions may be called from several threads.
class DirectionSampler {
  public:
    /// Evaluates the source at the centres of all cells.
    /// @throws UsageError  for weights that do not fit the channels, and numbers out of range
    /// @throws Cancelled
    explicit DirectionSampler(const BrdfSource& source, const SamplerOptions& options = {},
                              const Control& control = {});

    /// @param mu_in   in (0, 1]
    /// @param u1, u2  in [0, 1)
    /// @throws UsageError  out of range
    SampledDirection sample(double mu_in, double u1, double u2) const;

    /// Density of sample() at a direction, per unit of solid angle: its integral over the outgoing
    /// hemisphere is 1.
    /// @param mu_in, mu_out  in (0, 1]
    /// @param azimuth_deg    finite
    /// @throws UsageError  out of range
    double density(double mu_in, double mu_out, double azimuth_deg) const;

  private:
    struct Table;
    std::shared_ptr<const Table> table_;
};

}  // namespace miebrdf
#pragma GCC visibility pop
