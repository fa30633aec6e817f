// Tables over half vectors as tensor files have them: docs/formats/rgl.md.
#pragma once

#include <span>
#include <vector>

#include "pipeline/solve/vector_pairs.h"

namespace miebrdf {

/// n x n half vectors at one direction of incidence, theta = x^2 pi/2 and phi = (2y - 1) pi with x
/// and y at equal steps of [0, 1]; node = row y * n + column x. Readers interpolate linearly
/// between nodes, and ask for lit half vectors alone: those whose outgoing direction is above the
/// horizon.
class HalfVectorTable {
  public:
    /// @param in  unit vector in the x-z plane, above the horizon
    HalfVectorTable(std::size_t n, const Eigen::Vector3d& in);

    std::size_t size() const { return n_ * n_; }
    Eigen::Vector3d half_vector(std::size_t node) const;
    Eigen::Vector3d outgoing(std::size_t node) const { return mirrored(in_, half_vector(node)); }

    /// Solid angle of outgoing directions for each unit of area of the square (x, y), as readers
    /// compute it, with their lower bound.
    double jacobian(std::size_t node) const;

    /// Nodes whose value the fit reads: all but those far below the horizon.
    const std::vector<std::size_t>& needed() const { return needed_; }

    /// Values to store so that the table, interpolated, holds all the light of `values` and nothing
    /// negative.
    /// @param values  one for each node; below the horizon those of an odd continuation,
    ///                f(-cosine) = -f(cosine)
    void fit(std::span<double> values) const;

  private:
    double unit(std::size_t i) const { return double(i) / double(n_ - 1); }
    bool lit(std::size_t node) const { return cosine_[node] > 0.0; }
    void weigh_cells();
    void limit_continuation(std::span<double> values) const;
    void keep_cell_means(std::span<double> values) const;
    void settle_horizon(std::span<double> values) const;

    std::size_t n_;
    Eigen::Vector3d in_;
    std::vector<double> cosine_;  ///< outgoing, at each node
    std::vector<double> share_;   ///< lit solid angle that a node's value counts for, sr
    std::vector<std::size_t> needed_;
};

}  // namespace miebrdf
