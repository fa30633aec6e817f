// Makes a ScaledStack (rte/phase/stack_of_media.h) from a Stack: media scaled by delta-M, layers
// that do nothing left out; and the nodes of each medium.
#pragma once

#include <optional>
#include <vector>

#include <miebrdf/optics.h>
#include <miebrdf/solver.h>
#include "rte/grid/refraction_grid.h"
#include "rte/phase/stack_of_media.h"

namespace miebrdf::rte {

/// Scales every medium by delta-M. Leaves out all layers below a coat of infinite depth, and layers
/// of depth 0 (but not those below a boundary whose index differs from both neighbours').
/// @param moments  L of scale_optics
ScaledStack scale_stack(const Stack& stack, int moments, bool delta_m);
/// @param scaled  overwritten; its memory is used again
void scale_stack(const Stack& stack, int moments, bool delta_m, ScaledStack& scaled);

/// ScaledStack::base, without scaling: a coat of infinite depth is the half-space.
BaseKind lowest_kind(const Stack& stack);

/// Nodes of the media of a stack: one grid for all media, or one for each index
/// (refraction_grid.h).
class StackGrids {
  public:
    StackGrids(const ScaledStack& stack, GridKind kind, int count);

    /// Whether the constructor would make the same grids of these arguments.
    bool fit(const ScaledStack& stack, GridKind kind, int count) const;

    /// The nodes in air, where light enters and leaves.
    const ZenithGrid& top() const { return grids_.front(); }
    const ZenithGrid& of(double index) const;
    /// Ascending, from 1 on.
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

/// Splits off the narrow features of each medium (ScaledMedium::narrow, empty after scale_stack),
/// and finds the shares of them that the nodes do not resolve.
void split_by_resolution(ScaledStack& stack, const StackGrids& grids);

}  // namespace miebrdf::rte
