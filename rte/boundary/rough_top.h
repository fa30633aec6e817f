// A rough boundary on what lies below it, for the Fourier orders of one request after the other.
#pragma once

#include <memory>

#include "rte/boundary/rough_boundary.h"
#include "rte/half_space/half_space.h"

namespace miebrdf::rte {

/// Boundaries that were made before in this process, with at least that many orders; the most
/// recently used ones are kept (some MB). Thread-safe.
/// @param grid  as RoughBoundary's
std::shared_ptr<const RoughBoundary> shared_rough_boundary(double index, const Boundary& boundary,
                                                           const RefractionGrid& grid, int orders);

/// OuterLobeScale of a boundary at any cosines.
Eigen::VectorXd outer_lobe_scale(double index, const Boundary& boundary,
                                 const Eigen::VectorXd& mu_air);

/// LightFromAir::compensation of a boundary at any cosines.
Eigen::VectorXd facet_compensation(double index, const Boundary& boundary,
                                   const Eigen::VectorXd& mu_air);

/// Not thread-safe.
class RoughTop {
  public:
    /// @param grid       as RoughBoundary's
    /// @param requested  in air; must outlive this
    /// @param mirrored   what comes back at the nodes without being scattered; empty: nothing.
    /// Light
    ///                   that does and meets one facet on each passage is left out of `multiple`,
    ///                   as narrow as its lobe may be (MirroredLobe)
    RoughTop(double index, const Boundary& boundary, const RefractionGrid& grid,
             const RequestedDirections& requested, Eigen::VectorXd mirrored = {});

    /// Reflection of one Fourier order by `below` seen from air. Light that does not enter is left
    /// out of `multiple`; its share is in `specular`, because albedos count it.
    /// @param below   with nodes, in the cosines of the medium
    /// @param parts   `sky` stands for uniform light from everywhere
    /// @param result  overwritten
    void put_on(int fourier_order, const Reflector& below, ReflectorParts parts, Reflector& result);

  private:
    void need_orders(int count);

    double index_;
    Boundary kind_;
    RefractionGrid grid_;
    const RequestedDirections& requested_;
    Eigen::VectorXd mirrored_;
    std::shared_ptr<const RoughBoundary> boundary_;
    LightFromAir light_;
};

}  // namespace miebrdf::rte
