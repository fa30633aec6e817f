#include "rte/boundary/smooth_boundary.h"

#include <algorithm>
#include <cmath>

#include "rte/fourier/eigenmodes.h"
#include "rte/fourier/fourier_mode.h"
#include "rte/math/matrices.h"
#include "rte/surface/fresnel.h"

namespace miebrdf::rte {
namespace {

// From the side of the smaller index, where every angle is refracted.
double dielectric_reflectance(double here, double beyond, double mu) {
    if (here <= beyond) return fresnel_reflectance(beyond / here, mu);
    const double ratio = here / beyond;
    const double mu2 = 1.0 - ratio * ratio * (1.0 - mu) * (1.0 + mu);
    return mu2 > 0.0 ? fresnel_reflectance(ratio, std::sqrt(mu2)) : 1.0;
}

// G = Gamma^(1/2) (I - Gamma^(1/2) X Gamma^(1/2))^-1 Gamma^(1/2). False if it has no physical
// solution.
bool find_returns(const Eigen::VectorXd& at_nodes, const Eigen::MatrixXd& X, FourierWork& work,
                  Eigen::MatrixXd& returns) {
    Eigen::VectorXd& reflectance = work.far;
    reflectance = at_nodes;
    leave_out_unreachable(X, reflectance);
    if (reflectance.size() > 0 && reflectance.minCoeff() < 0.0) {
        work.square = -(reflectance.asDiagonal() * X);
        work.square.diagonal().array() += 1.0;
        work.bounces.compute(work.square);
        work.other_square = reflectance.asDiagonal();
        work.square = work.bounces.solve(work.other_square);
        returns = 0.5 * (work.square + work.square.transpose());
        return returns.allFinite();
    }
    Eigen::VectorXd& root = work.between;
    root = reflectance.cwiseSqrt();
    work.square = -(root.asDiagonal() * X * root.asDiagonal());
    work.square.diagonal().array() += 1.0;
    if (!math::invert_positive_definite(work.square, returns)) return false;
    returns = root.asDiagonal() * returns * root.asDiagonal();
    return true;
}

}  // namespace

void leave_out_unreachable(const Eigen::MatrixXd& X, Eigen::VectorXd& reflectance) {
    for (Eigen::Index p = 0; p < reflectance.size(); ++p) {
        if (reflectance[p] * X(p, p) >= 1.0) reflectance[p] = 0.0;
    }
}

double boundary_reflectance(double here, std::complex<double> beyond, double mu) {
    return beyond.imag() == 0.0 ? dielectric_reflectance(here, beyond.real(), mu)
                                : fresnel_reflectance(beyond / here, mu);
}

Eigen::VectorXd boundary_reflectance(double here, std::complex<double> beyond,
                                     const Eigen::VectorXd& mu) {
    return mu.unaryExpr([=](double cosine) { return boundary_reflectance(here, beyond, cosine); });
}

SmoothBoundary::SmoothBoundary(double below, double above, const RefractionGrid& grid,
                               const RequestedDirections& requested)
    : index_below(below),
      index_above(above),
      at_requested(boundary_reflectance(below, above, requested.mu)),
      nodes_above(grid.nodes_below(above)) {
    at_nodes = boundary_reflectance(below, above, grid.in_medium(below).mu);
    // Rounding must not let a node through that belongs to total reflection.
    const Eigen::Index trapped = at_nodes.size() - nodes_above;
    if (trapped > 0) at_nodes.head(trapped).setOnes();
    passes_at_nodes = 1.0 - at_nodes.array();
    passes_at_requested = 1.0 - at_requested.array();
    trapped_above.setOnes(std::max<Eigen::Index>(0, -trapped));
}

void put_boundary_on(const SmoothBoundary& boundary, const Reflector& below,
                     const RequestedDirections& requested, ReflectorParts parts,
                     const Eigen::VectorXd& sky, FourierWork& work, Reflector& result) {
    const Eigen::MatrixXd& X = below.nodes;
    result.iterations = below.iterations;
    result.residual = below.residual;
    result.converged = below.converged;
    Eigen::MatrixXd& G = work.joint;
    result.physical = find_returns(boundary.at_nodes, X, work, G);
    if (!result.physical) return;

    const double n = boundary.index_above / boundary.index_below;
    // A beam that a mirror below sends back is reflected down again and again.
    const auto r = boundary.at_requested.array();
    const auto t = boundary.passes_at_requested.array();
    Eigen::VectorXd &mirror = work.near, &passed = work.far;
    if (below.specular.size() > 0) {
        mirror = below.specular;
    } else {
        mirror.setZero(r.size());
    }
    passed = t / (1.0 - r * mirror.array());
    result.specular = r + t * mirror.array() * passed.array();

    Eigen::MatrixXd &out = work.first_out, &in = work.first_in;
    gather_rows(below.rows, requested.out, out);
    gather_rows(below.rows, requested.in, in);
    work.through.resize(out.rows(), G.cols());
    work.through.noalias() = 0.5 * out * G;
    result.multiple = below.multiple;
    result.multiple.noalias() += work.through * in.transpose();
    for (Eigen::Index i = 0; i < result.multiple.cols(); ++i) {
        for (Eigen::Index o = 0; o < result.multiple.rows(); ++o) {
            result.multiple(o, i) *= n * n * passed[requested.in[std::size_t(i)]] *
                                     passed[requested.out[std::size_t(o)]];
        }
    }

    const Eigen::Index common = std::min(X.rows(), boundary.nodes_above);
    const auto enters = boundary.passes_at_nodes.tail(common);
    if (parts != ReflectorParts::pairs) {
        work.other_square.resize(X.rows(), X.cols());
        work.other_square.noalias() = G * X;
        Eigen::MatrixXd& down = work.below;  // (I - Gamma X)^-1
        down = work.other_square;
        down.diagonal().array() += 1.0;
        work.rows.resize(below.rows.rows(), X.cols());
        work.rows.noalias() = below.rows * down;
        result.rows.setZero(below.rows.rows(), boundary.nodes_above);
        result.rows.rightCols(common) =
            (n * passed).asDiagonal() * work.rows.rightCols(common) * enters.asDiagonal();
        Eigen::MatrixXd& seen = work.square;
        seen = X;
        seen.noalias() += X * work.other_square;
        result.nodes.setZero(boundary.nodes_above, boundary.nodes_above);
        result.nodes.diagonal().head(boundary.nodes_above - common) = boundary.trapped_above;
        result.nodes.bottomRightCorner(common, common) =
            enters.asDiagonal() *
            (0.5 * (seen + seen.transpose())).bottomRightCorner(common, common) *
            enters.asDiagonal();
        result.nodes.diagonal().tail(common) += boundary.at_nodes.tail(common);
    }
    if (parts == ReflectorParts::sky) {
        result.sky_at_requested.noalias() = result.rows * sky;
        result.sky_at_nodes.noalias() = result.nodes * sky;
    }
    result.has_transmittance = below.has_transmittance;
    if (below.has_transmittance) {
        Eigen::VectorXd &again = work.downward, &up = work.upward;
        again.noalias() = G * below.transmittance_at_nodes;
        up = below.transmittance_at_nodes;
        up.noalias() += X * again;
        result.transmittance_at_nodes.setZero(boundary.nodes_above);
        result.transmittance_at_nodes.tail(common) = enters.cwiseProduct(up.tail(common)) / n;
        result.transmittance_at_requested = below.transmittance_at_requested;
        result.transmittance_at_requested.noalias() += below.rows * again;
        result.transmittance_at_requested.array() *= passed.array();
    }
}

}  // namespace miebrdf::rte
