// How a stack is scaled for the discrete equations, and the nodes of each medium.
#pragma once

#include <optional>
#include <vector>

#include <miebrdf/optics.h>
#include <miebrdf/solver.h>
#include "rte/grid/refraction_grid.h"
#include "rte/phase/stack_of_media.h"

namespace miebrdf::rte {

/// delta-M for every medium; layers without depth are left out, but for those between media of
/// other indices below a boundary, and so is everything below a coat of infinite depth.
/// @param moments  as of scale_optics
ScaledStack scale_stack(const Stack& stack, int moments, bool delta_m);
/// @param scaled  overwritten; its memory is used again
void scale_stack(const Stack& stack, int moments, bool delta_m, ScaledStack& scaled);

/// The kind of base below the layers that are left, as scale_stack finds it.
BaseKind lowest_kind(const Stack& stack);

/// Nodes of all media of a stack: one grid, or one for each index (refraction_grid.h).
class StackGrids {
  public:
    /// One for all.
    StackGrids(ZenithGrid grid);
    StackGrids(const ScaledStack& stack, GridKind kind, int count);

    /// They are what these arguments give.
    bool fit(const ScaledStack& stack, GridKind kind, int count) const;

    /// The nodes of light that enters and leaves.
    const ZenithGrid& top() const { return grids_.front(); }
    const ZenithGrid& of(double index) const;
    /// Index 1 first, where there are several.
    const std::vector<double>& indices() const { return indices_; }
    const RefractionGrid& refraction() const { return *refraction_; }

  private:
    GridKind kind_ = GridKind::automatic;
    int count_ = 0;
    std::vector<double> scattering_;  ///< indices of media and ground; empty where nothing refracts
    std::vector<double> indices_;
    std::vector<ZenithGrid> grids_;
    std::optional<RefractionGrid> refraction_;
};

/// Finds narrow features of all degrees (ScaledMedium::narrow), which scale_stack leaves empty, and
/// which of them these nodes resolve.
void split_by_resolution(ScaledStack& stack, const StackGrids& grids);

}  // namespace miebrdf::rte
