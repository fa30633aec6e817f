#include "rte/stokes/coupled.h"

#include <Eigen/LU>
#include <algorithm>

namespace miebrdf::rte {
namespace {

using Eigen::MatrixXd;

// Reflection between i_up and D4 i_down: rows of U and V have -c.
TwistedRows reflecting(const std::vector<FresnelMatrix>& matrices, const StokesBlock& block) {
    TwistedRows rows{fresnel_rows(matrices, block, -1.0), {}};
    const auto c = Eigen::Index(block.size());
    rows.twist.setZero(rows.diagonal.size());
    for (std::size_t k = 0; k < matrices.size(); ++k) {
        rows.twist[Eigen::Index(k) * c + c - 2] = -matrices[k].cross.imag();
        rows.twist[Eigen::Index(k) * c + c - 1] = matrices[k].cross.imag();
    }
    return rows;
}

// t / (1 - r s) for each cosine: all returns between a boundary and a mirror below it. Of U and V,
// diagonal and twist of the first of both rows are the parts of a complex number.
TwistedRows after_returns(const Eigen::VectorXd& t, const Eigen::VectorXd& r, const TwistedRows& s,
                          int rows_per_node) {
    TwistedRows result{t.array() / (1.0 - r.array() * s.diagonal.array()),
                       Eigen::VectorXd::Zero(t.size())};
    for (Eigen::Index u = rows_per_node - 2; u < t.size(); u += rows_per_node) {
        const std::complex<double> z =
            t[u] / (1.0 - r[u] * std::complex<double>(s.diagonal[u], s.twist[u]));
        result.diagonal[u] = result.diagonal[u + 1] = z.real();
        result.twist[u] = z.imag();
        result.twist[u + 1] = -z.imag();
    }
    return result;
}

}  // namespace

void coupled_mirror(double here, std::complex<double> mirror, const ZenithGrid& nodes,
                    const RequestedDirections& cosines, const RequestedDirections& requested,
                    const StokesBlock& block, Reflector& result) {
    const int c = int(block.size());
    const TwistedRows at_nodes = reflecting(fresnel_reflections(here, mirror, nodes.mu), block);
    const TwistedRows at_requested =
        reflecting(fresnel_reflections(here, mirror, cosines.mu), block);
    mirror_ground(at_nodes.diagonal, at_requested.diagonal, requested, result);
    result.nodes =
        at_nodes.times(MatrixXd::Identity(at_nodes.diagonal.size(), at_nodes.diagonal.size()), c);
    result.specular_twist = at_requested.twist;
}

void put_boundary_on_coupled(const FresnelReflections& matrices, const StokesBlock& block,
                             const RequestedDirections& requested, ReflectorParts parts,
                             const Reflector& below, Reflector& result) {
    const int c = int(block.size());
    const MatrixXd& X = below.nodes;
    const MatrixXd identity = MatrixXd::Identity(X.rows(), X.rows());
    const TwistedRows gamma = reflecting(matrices.at_nodes, block);
    // (I - Gamma X)^-1.
    const MatrixXd returns = (identity - gamma.times(X, c)).partialPivLu().inverse();
    result.iterations = below.iterations;
    result.residual = below.residual;
    result.converged = below.converged;
    result.physical = returns.allFinite();
    if (!result.physical) return;

    const double n = matrices.index_above / matrices.index_below;
    // No beam from air is totally reflected: r and t are diagonal.
    const Eigen::VectorXd r = fresnel_rows(matrices.at_requested, block, -1.0);
    const Eigen::VectorXd t = fresnel_rows(passing(matrices.at_requested), block, 1.0);
    const TwistedRows mirror = specular_of(below, r.size());
    const TwistedRows passed = after_returns(t, r, mirror, c);
    const TwistedRows mirrored = passed.following(mirror, c);
    result.specular = r + t.cwiseProduct(mirrored.diagonal);
    result.specular_twist = t.cwiseProduct(mirrored.twist);

    const MatrixXd seen = passed.times(below.rows, c);
    const MatrixXd G = returns * gamma.times(identity, c);
    const MatrixXd pairs = 0.5 * seen * G * arriving(seen, requested.in, c);
    result.multiple.resize(below.multiple.rows(), below.multiple.cols());
    for (Eigen::Index i = 0; i < result.multiple.cols(); i += c) {
        const MatrixXd in = passed.of_node(requested.in[std::size_t(i)] / c, c);
        for (Eigen::Index o = 0; o < result.multiple.rows(); o += c) {
            const int out = requested.out[std::size_t(o)];
            result.multiple.block(o, i, c, c) =
                n * n *
                (passed.of_node(out / c, c) * below.multiple.block(o, i, c, c) * in +
                 pairs.block(out, i, c, c));
        }
    }
    result.has_transmittance = false;
    if (parts != ReflectorParts::nodes) return;

    const TwistedRows trapped = reflecting(matrices.trapped_above, block);
    const Eigen::Index more_above = trapped.diagonal.size();
    const Eigen::Index above = matrices.nodes_above * c, common = above - more_above;
    const Eigen::VectorXd enters =
        fresnel_rows(passing(matrices.at_nodes), block, 1.0).tail(common);
    result.rows.setZero(below.rows.rows(), above);
    result.rows.rightCols(common) = n * seen * returns.rightCols(common) * enters.asDiagonal();
    result.nodes.setZero(above, above);
    result.nodes.topLeftCorner(more_above, more_above) =
        trapped.times(MatrixXd::Identity(more_above, more_above), c);
    result.nodes.bottomRightCorner(common, common) =
        enters.asDiagonal() * (X * returns).bottomRightCorner(common, common) * enters.asDiagonal();
    result.nodes.diagonal().tail(common) += gamma.diagonal.tail(common);
}

}  // namespace miebrdf::rte
