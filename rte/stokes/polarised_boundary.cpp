#include "rte/stokes/coupled.h"

#include <algorithm>

namespace miebrdf::rte {
namespace {

// Rounding must not let a node through that belongs to total reflection.
std::vector<FresnelMatrix> total_reflections(double here, double beyond,
                                             const Eigen::VectorXd& mu) {
    std::vector<FresnelMatrix> all;
    for (const double cosine : mu) all.push_back(total_reflection(here, beyond, cosine));
    return all;
}

}  // namespace

FresnelReflections::FresnelReflections(double below, double over, const ZenithGrid& nodes,
                                       const ZenithGrid& above,
                                       const RequestedDirections& requested)
    : index_below(below),
      index_above(over),
      nodes_above(above.size()),
      at_nodes(fresnel_reflections(below, over, nodes.mu)),
      at_requested(fresnel_reflections(below, over, requested.mu)) {
    const Eigen::Index more_below = std::max<Eigen::Index>(0, nodes.size() - above.size());
    const auto trapped = total_reflections(below, over, nodes.mu.head(more_below));
    std::copy(trapped.begin(), trapped.end(), at_nodes.begin());
    const Eigen::Index more_above = std::max<Eigen::Index>(0, above.size() - nodes.size());
    trapped_above = total_reflections(over, below, above.mu.head(more_above));
}

std::vector<FresnelMatrix> fresnel_reflections(double here, std::complex<double> beyond,
                                               const Eigen::VectorXd& mu) {
    std::vector<FresnelMatrix> all;
    for (const double cosine : mu) all.push_back(fresnel_reflection(here, beyond, cosine));
    return all;
}

std::vector<FresnelMatrix> passing(const std::vector<FresnelMatrix>& reflections) {
    std::vector<FresnelMatrix> all;
    for (const FresnelMatrix& reflection : reflections) all.push_back(passing(reflection));
    return all;
}

Eigen::VectorXd fresnel_rows(const std::vector<FresnelMatrix>& matrices, const StokesBlock& block,
                             double sign_of_cross) {
    Eigen::VectorXd rows(Eigen::Index(matrices.size() * block.size()));
    Eigen::Index next = 0;
    for (const FresnelMatrix& matrix : matrices) {
        for (const StokesComponent component : block) {
            rows[next++] = component == StokesComponent::I   ? matrix.parallel
                           : component == StokesComponent::Q ? matrix.across
                                                             : sign_of_cross * matrix.cross.real();
        }
    }
    return rows;
}

SmoothBoundary polarised_boundary(const FresnelReflections& matrices, const StokesBlock& block) {
    SmoothBoundary boundary;
    boundary.index_below = matrices.index_below;
    boundary.index_above = matrices.index_above;
    boundary.nodes_above = Eigen::Index(block.size()) * matrices.nodes_above;
    boundary.at_nodes = fresnel_rows(matrices.at_nodes, block, -1.0);
    boundary.at_requested = fresnel_rows(matrices.at_requested, block, -1.0);
    boundary.passes_at_nodes = fresnel_rows(passing(matrices.at_nodes), block, 1.0);
    boundary.passes_at_requested = fresnel_rows(passing(matrices.at_requested), block, 1.0);
    boundary.trapped_above = fresnel_rows(matrices.trapped_above, block, -1.0);
    return boundary;
}

Eigen::VectorXd polarised_mirror(double here, std::complex<double> mirror,
                                 const Eigen::VectorXd& mu, const StokesBlock& block) {
    return fresnel_rows(fresnel_reflections(here, mirror, mu), block, -1.0);
}

}  // namespace miebrdf::rte
