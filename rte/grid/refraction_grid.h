// Nodes for layers of several refractive indices n. Each node is a value of q = n sin(theta), which
// refraction keeps: a smooth boundary sends light from a node into the same node, and its matrices
// are diagonal.
#pragma once

#include <Eigen/Core>
#include <vector>

#include "rte/grid/directions.h"

namespace miebrdf::rte {

/// The directions between two critical angles: low < q = n sin(theta) < high.
struct RefractionPanel {
    double low = 0.0, high = 1.0;
    Eigen::Index first = 0, count = 0;  ///< its nodes
    /// Cosine in the medium of index `high` at the Gauss node t: widest * t^2 (2 - t) if true, else
    /// widest * t.
    bool mapped = false;
    double widest = 1.0;  ///< (1 - low^2 / high^2)^(1/2)

    bool operator==(const RefractionPanel&) const = default;
};

/// Nodes in q, descending, so that the cosine ascends in every medium. One panel for each interval
/// between neighbouring indices: below each critical angle the reflectance is analytic in the
/// cosine of the medium in which the panel ends (docs/maths-boundary.md).
class RefractionGrid {
  public:
    /// The media lie below air (index 1).
    /// @param indices  of the media that scatter, in any order, each at least 1
    /// @param count    nodes of one medium and air together; more media have more, equally dense
    /// @param least    nodes that each panel has at least
    RefractionGrid(std::vector<double> indices, int count, int least = 1);

    /// The nodes with q below one of the indices: the directions that exist in this medium.
    RefractionGrid within(double index) const;

    bool operator==(const RefractionGrid& other) const;

    Eigen::Index size() const { return t_.size(); }
    const std::vector<RefractionPanel>& panels() const { return panels_; }
    /// The place t in (0, 1) of each node in its panel.
    const Eigen::VectorXd& t() const { return t_; }
    /// The number of nodes with q below an index; they are the last ones.
    Eigen::Index nodes_below(double index) const;
    /// Cosines and weights of the last nodes_below(index) nodes in the medium of this index (1:
    /// air); n^2 mu dmu is the same in all media.
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
