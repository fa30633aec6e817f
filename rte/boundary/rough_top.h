// A rough boundary on what lies below it, for the Fourier orders of one request after the other.
#pragma once

#include <cstddef>
#include <memory>

#include "rte/boundary/rough_boundaries.h"
#include "rte/half_space/half_space.h"

namespace miebrdf::rte {

/// Not thread-safe.
class RoughTop {
  public:
    /// @param boundaries  must outlive this
    /// @param grid        as RoughBoundary's
    /// @param requested   in air; must outlive this
    /// @param mirrored    what comes back at the nodes without being scattered; empty: nothing.
    ///                    Light that does and meets one facet on each passage is left out of
    ///                    `multiple`, as narrow as its lobe may be (MirroredLobe)
    RoughTop(RoughBoundaries& boundaries, double index, const Boundary& boundary,
             const RefractionGrid& grid, const RequestedDirections& requested,
             Eigen::VectorXd mirrored = {});

    /// Reflection of one Fourier order by `below` seen from air. Light that does not enter is left
    /// out of `multiple`; its share is in `specular`, because albedos count it.
    /// @param below   with nodes, in the cosines of the medium
    /// @param parts   `sky` stands for uniform light from everywhere
    /// @param result  overwritten
    void put_on(int fourier_order, const Reflector& below, ReflectorParts parts, Reflector& result);

    /// Of an order that `put_on` has seen: matrices of RoughBoundary and LightFromAir.
    const Eigen::MatrixXd& inside(int fourier_order) const {
        return boundary_->inside(fourier_order);
    }
    const Eigen::MatrixXd& entering(int fourier_order) const {
        return light_.entering[std::size_t(fourier_order)];
    }
    const Eigen::MatrixXd& entering_at_once(int fourier_order) const {
        return light_.entering_at_once[std::size_t(fourier_order)];
    }
    Eigen::VectorXd sky_entering() const { return boundary_->sky_entering(); }
    double index() const { return index_; }

  private:
    void need_orders(int count);

    RoughBoundaries& boundaries_;
    double index_;
    Boundary kind_;
    RefractionGrid grid_;
    const RequestedDirections& requested_;
    Eigen::VectorXd mirrored_;
    std::shared_ptr<const RoughBoundary> boundary_;
    LightFromAir light_;
};

}  // namespace miebrdf::rte
