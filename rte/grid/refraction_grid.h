// Nodes for layers of several refractive indices: every node is one value of n sin(theta), which
// Snell's law keeps, so that a smooth boundary between two indices is diagonal.
#pragma once

#include <Eigen/Core>
#include <vector>

#include "rte/grid/directions.h"

namespace miebrdf::rte {

/// The directions between two critical angles: low < q = n sin(theta) < high.
struct RefractionPanel {
    double low = 0.0, high = 1.0;
    Eigen::Index first = 0, count = 0;  ///< its nodes
    /// The cosine in the medium of index `high` is c = widest * t^2 (2 - t) if true, else
    /// widest * t; t are Gauss nodes on (0, 1).
    bool mapped = false;
    double widest = 1.0;  ///< (1 - low^2 / high^2)^(1/2)

    bool operator==(const RefractionPanel&) const = default;
};

/// Nodes in q, descending, so that the cosine ascends in every medium. One panel for each interval
/// between neighbouring indices: below each critical angle the reflectance is analytic in the
/// cosine of the medium in which the panel ends (docs/maths-boundary.md).
class RefractionGrid {
  public:
    /// @param indices  of the media that scatter, in any order, each at least 1
    /// @param count    nodes of one medium and air together; those of more media are as close
    /// @param least    nodes of a panel
    /// Air (index 1) is above them.
    RefractionGrid(std::vector<double> indices, int count, int least = 1);

    /// The part with n sin(theta) below one of the indices: what light of that medium has.
    RefractionGrid within(double index) const;

    bool operator==(const RefractionGrid& other) const;

    Eigen::Index size() const { return t_.size(); }
    const std::vector<RefractionPanel>& panels() const { return panels_; }
    /// The Gauss node of each node in its panel.
    const Eigen::VectorXd& t() const { return t_; }
    /// Nodes with q below an index: the last ones.
    Eigen::Index nodes_below(double index) const;
    /// Cosines and weights in a medium of one of the indices, or in air: the nodes_below() it.
    /// n^2 mu dmu is the same in all.
    ZenithGrid in_medium(double index) const;

  private:
    std::vector<RefractionPanel> panels_;
    Eigen::VectorXd t_, weight_;  ///< of the Gauss rules
};

/// The cosine in a medium of index n >= 1 behind a smooth boundary: n^2 (1 - mu^2) = 1 - mu_air^2.
double refracted_cosine(double index, double mu_air);
/// Directions in air as they are in a medium.
Directions refracted(const Directions& in_air, double index);
/// The cosines of a request as they are in a medium.
RequestedDirections refracted(const RequestedDirections& in_air, double index);
/// @param inside  overwritten; its memory is used again
void refract(const RequestedDirections& in_air, double index, RequestedDirections& inside);

}  // namespace miebrdf::rte
