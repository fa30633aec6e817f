// A stack of media as the discrete equations see it, and the nodes of each medium.
#pragma once

#include <complex>
#include <optional>
#include <vector>

#include <miebrdf/optics.h>
#include <miebrdf/solver.h>
#include "rte/grid/refraction_grid.h"
#include "rte/phase/scaled_medium.h"

namespace miebrdf::rte {

struct ScaledStack {
    std::vector<ScaledMedium> media;  ///< from the bottom up; media[0] is the half-space, if any
    BaseKind base = BaseKind::half_space;
    double ground_albedo = 0.0;
    std::complex<double> mirror_index = 1.0;
    /// The indices of what lies on the ground or mirror, and of the topmost medium, as far as
    /// boundaries see them: without a boundary the topmost is 1, media have their neighbours'
    /// index.
    double ground_index = 1.0, top_index = 1.0;
    std::optional<Boundary> boundary = {};  ///< empty too where the topmost medium is as air
    int moments = 1;                        ///< Legendre moments of the medium that has most
    /// The flux into what lies below is wanted (Reflector::transmittance_at_requested): nothing is
    /// left out.
    bool transmits = false;
    /// Lower bound of the largest reflection at every incidence (least_brightness): below a deep
    /// coat is left out what does not show beside that. 0: nothing is.
    double brightness = 0.0;

    /// Any index but one: nodes and requested cosines differ from medium to medium.
    bool refracts() const;
    /// Beams come back from mirrors or boundaries below a medium.
    bool has_mirrors() const;
};

enum class NarrowPart { split, ignored };

/// delta-M for every medium; layers without depth are left out, but for those between media of
/// other indices below a boundary, and so is everything below a coat of infinite depth.
/// @param moments  as of scale_optics
/// @param narrow   ignored: ScaledMedium::narrow is left empty, for those who want no light
///        scattered once
ScaledStack scale_stack(const Stack& stack, int moments, bool delta_m,
                        NarrowPart narrow = NarrowPart::split);
/// @param scaled  overwritten; its memory is used again
void scale_stack(const Stack& stack, int moments, bool delta_m, NarrowPart narrow,
                 ScaledStack& scaled);

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

/// Narrow features of all degrees (ScaledMedium::narrow), and which of them these nodes resolve.
void split_by_resolution(ScaledStack& stack, const StackGrids& grids);

}  // namespace miebrdf::rte
