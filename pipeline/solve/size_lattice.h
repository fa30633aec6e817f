// Optics of spheres of any size from those at a lattice of sizes: fits ask for hundreds of sizes
// close to each other, and averages of Mie theory are what takes their time.
#pragma once

#include <miebrdf/control.h>

#include <memory>
#include <vector>

#include <miebrdf/ensemble.h>
#include "pipeline/solve/single_scattering.h"

namespace miebrdf {

/// Whether sizes have a width, over which averages are smooth.
bool has_width(const mie::SizeDistribution& sizes);

/// Between four neighbouring radii, and four variances where they vary, optics are Lagrange's
/// polynomials in ln(radius) and ln(variance): albedos in ln(1 - albedo), efficiencies in their
/// logarithm, moments and phase functions as they are. Averages over sizes are smooth in both, as
/// far as their law is; whoever asks compares with optics of his own (docs/fitting.md).
class SizeLattice {
  public:
    /// Radii are so many widths of the law, sqrt(ln(1 + variance)), apart: polynomials of the third
    /// degree err by 1e-3 of what varies over one width with the fine step, and by 16 times that
    /// with the coarse one, whose nodes are half of the others'.
    static constexpr double kFineStep = 0.5, kCoarseStep = 1.0;
    static constexpr double kVarianceStep = 0.4;  ///< of ln(variance)

    /// @param radius_step  in widths of the law
    /// @param fixed  sizes of spheres that stay as they are: averages of their own
    /// @param with_variance  the others' variances change, too
    /// @param cache  for the averages at the lattice and those of fixed sizes; null: none
    SizeLattice(double radius_step, std::vector<mie::SizeDistribution> fixed, bool with_variance,
                std::shared_ptr<ResultCache> cache);

    /// Whether the species comes from the lattice: of spheres whose sizes have a width.
    bool covers(const ResolvedSpecies& species, const OpticsDemand& demand) const;
    /// The cache where the species is of fixed sizes; else null.
    std::shared_ptr<ResultCache> cache_of(const ResolvedSpecies& species) const;
    /// @pre covers
    MediumOptics optics(const ResolvedSpecies& species, std::size_t w, const OpticsDemand& demand,
                        const Control& control, const mie::Executor& run) const;

  private:
    bool is_fixed(const mie::SizeDistribution& sizes) const;

    double radius_step_;
    std::vector<mie::SizeDistribution> fixed_;
    bool with_variance_;
    std::shared_ptr<ResultCache> cache_;
};

/// The lattice of the control's memo, where it has one that covers the species; else null.
const SizeLattice* lattice_of(const Control& control, const ResolvedSpecies& species,
                              const OpticsDemand& demand);

/// A species of particles from where it is known: from lattice_of, else as remembered_optics; with
/// a smooth phase function from averaged_particles that are known so.
MediumOptics species_optics(const Control& control, const ResolvedSpecies& species, std::size_t w,
                            const OpticsDemand& demand, const mie::Executor& run);

}  // namespace miebrdf
