// Optics of spheres of any size from those at a lattice of sizes: fits ask for hundreds of sizes
// close to each other, and averages of Mie theory are what takes their time.
#pragma once

#include <miebrdf/control.h>

#include <memory>
#include <vector>

#include <miebrdf/ensemble.h>
#include "pipeline/solve/single_scattering.h"

namespace miebrdf {

/// Between four neighbouring radii, and four variances where they vary, optics are Lagrange's
/// polynomials in ln(radius) and ln(variance): albedos in ln(1 - albedo), efficiencies in their
/// logarithm, moments and phase functions as they are. Averages over sizes are smooth in both, as
/// far as their law is; whoever asks compares with optics of his own (docs/fitting.md).
class SizeLattice {
  public:
    /// Radii are so many widths of the law, sqrt(ln(1 + variance)), apart: polynomials of the third
    /// degree err by 1e-3 of what varies over one width.
    static constexpr double kRadiusStep = 0.5;
    static constexpr double kVarianceStep = 0.4;  ///< of ln(variance)

    /// @param fixed  sizes that stay as they are: averages of their own
    /// @param with_variance  the others' variances change, too
    /// @param cache  for the averages at the lattice, which later fits meet again; null: none
    SizeLattice(std::vector<mie::SizeDistribution> fixed, bool with_variance,
                std::shared_ptr<ResultCache> cache);

    /// Whether the species comes from the lattice: of spheres whose sizes have a width.
    bool covers(const ResolvedSpecies& species, const OpticsDemand& demand) const;
    /// @pre covers
    MediumOptics optics(const ResolvedSpecies& species, std::size_t w, const OpticsDemand& demand,
                        const Control& control, const mie::Executor& run) const;

  private:
    std::vector<mie::SizeDistribution> fixed_;
    bool with_variance_;
    std::shared_ptr<ResultCache> cache_;
};

/// A species from where it is known: from the lattice of the control's memo, where it has one that
/// covers it, else as remembered_optics.
MediumOptics species_optics(const Control& control, const ResolvedSpecies& species, std::size_t w,
                            const OpticsDemand& demand, const mie::Executor& run);

}  // namespace miebrdf
