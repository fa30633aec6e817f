// Rough boundaries that were made before, for the stacks of one caller: their matrices take much
// longer than all the rest of a solution.
#pragma once

#include <Eigen/Core>
#include <cstddef>
#include <list>
#include <memory>
#include <mutex>

#include "rte/boundary/facet_lobes.h"
#include "rte/boundary/rough_boundary.h"

namespace miebrdf::rte {

/// The most recently used ones are kept (some MB). Thread-safe.
class RoughBoundaries {
  public:
    /// With at least that many orders, which is made where it is not there.
    /// @param grid  as RoughBoundary's
    std::shared_ptr<const RoughBoundary> find(double index, const Boundary& kind,
                                              const RefractionGrid& grid, int orders);

    /// OuterLobeScale of a boundary at any cosines.
    Eigen::VectorXd outer_lobe_scale(double index, const Boundary& kind,
                                     const Eigen::VectorXd& mu_air);
    /// LightFromAir::compensation of a boundary at any cosines.
    Eigen::VectorXd facet_compensation(double index, const Boundary& kind,
                                       const Eigen::VectorXd& mu_air);

  private:
    struct Kept {
        Boundary kind;
        std::shared_ptr<const RoughBoundary> boundary;
        std::shared_ptr<const OuterLobeScale> lobe_scale = {};  ///< null: not asked for yet
    };

    /// Null: not there. Others may have it for as long as they like.
    std::shared_ptr<const RoughBoundary> known(double index, const Boundary& kind,
                                               const RefractionGrid& grid, int orders);
    std::shared_ptr<const RoughBoundary> between_steps(double index, Boundary kind, int streams,
                                                       int orders);
    std::shared_ptr<const RoughBoundary> of_lobes(double index, const Boundary& kind);

    std::mutex mutex_;
    std::list<Kept> kept_;  ///< the last used first
};

}  // namespace miebrdf::rte
