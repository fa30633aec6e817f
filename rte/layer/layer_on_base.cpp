// A layer on something that reflects: adding.
#include "rte/layer/layer.h"
#include "rte/math/positive_definite.h"

namespace miebrdf::rte {
namespace {

using Eigen::MatrixXd;

// X of both from the impedances. False if they have no physical solution.
bool join_impedances(const LayerOperator& layer, const MatrixXd& base, OrderWork& work,
                     MatrixXd& X) {
    // Z_base = 2 (I + X_base)^-1 - I, Y = Z_p + Z_base.
    work.square = base;
    work.square.diagonal().array() += 1.0;
    MatrixXd& below = work.below;
    if (!math::invert_positive_definite(work.square, below)) return false;
    below = layer.thin_impedance + 2.0 * below;
    below.diagonal().array() -= 1.0;
    work.square = layer.coupling + below;
    if (!math::invert_positive_definite(work.square, work.joint)) return false;
    work.square.noalias() = work.joint * below;
    work.other_square = layer.thin_impedance;
    work.other_square.diagonal().array() += 1.0;
    work.other_square.noalias() += layer.coupling * work.square;
    work.square = 0.5 * (work.other_square + work.other_square.transpose());
    if (!math::invert_positive_definite(work.square, X)) return false;
    X *= 2.0;
    X.diagonal().array() -= 1.0;
    return true;
}

// Radiance between layer and base for light incident at some of the requested cosines, columns:
// down = t + X_c up, up = X_base down + exp(-tau / mu) rho_base.
void fill_interface(const LayerOperator& layer, const Reflector& base, OrderWork& work) {
    work.incoming = work.through;
    work.incoming.noalias() += layer.reflection * work.beam;
    work.down.resize(work.incoming.rows(), work.incoming.cols());
    work.down = work.bounces.solve(work.incoming);
    work.up = work.beam;
    work.up.noalias() += base.nodes * work.down;
}

void gather_columns(const MatrixXd& rows, const std::vector<int>& which,
                    math::ScratchMatrix& columns) {
    columns.resize(rows.cols(), Eigen::Index(which.size()));
    for (std::size_t k = 0; k < which.size(); ++k) {
        columns.col(Eigen::Index(k)) = rows.row(which[k]).transpose();
    }
}

// R between requested cosines: of the layer, of the base seen through it, and of light that
// passes the interface. Reciprocity: the side with fewer cosines is the one that is lit.
void fill_pairs(const LayerOperator& layer, const Reflector& base,
                const RequestedDirections& requested, OrderWork& work, Reflector& result) {
    const bool out_is_lit = requested.out.size() < requested.in.size();
    const std::vector<int>& lit = out_is_lit ? requested.out : requested.in;
    const std::vector<int>& other = out_is_lit ? requested.in : requested.out;
    gather_columns(work.seen, lit, work.beam);
    gather_columns(layer.transmission_rows, lit, work.through);
    fill_interface(layer, base, work);
    gather_columns(work.seen, other, work.beam);
    gather_columns(layer.transmission_rows, other, work.through);
    work.pairs.resize(Eigen::Index(other.size()), Eigen::Index(lit.size()));
    work.pairs.noalias() = 0.5 * work.beam.transpose() * work.down;
    work.pairs.noalias() += 0.5 * work.through.transpose() * work.up;

    result.multiple = layer.multiple;
    if (out_is_lit) {
        result.multiple += work.pairs.transpose();
    } else {
        result.multiple += work.pairs;
    }
    for (Eigen::Index i = 0; i < result.multiple.cols(); ++i) {
        const double direct_in = layer.direct[requested.in[std::size_t(i)]];
        for (Eigen::Index o = 0; o < result.multiple.rows(); ++o) {
            result.multiple(o, i) +=
                layer.direct[requested.out[std::size_t(o)]] * base.multiple(o, i) * direct_in;
        }
    }
}

// The answer to a sky: down = T sky + X_c up, up = X_base down.
void fill_sky(const LayerOperator& layer, const Reflector& base, const Eigen::VectorXd& sky,
              const OrderWork& work, Reflector& result) {
    const Eigen::VectorXd down = work.bounces.solve(layer.transmitted(sky));
    const Eigen::VectorXd up = base.nodes * down;
    result.sky_at_requested =
        layer.reflection_rows * sky + layer.transmission_rows * up + work.seen * down;
    result.sky_at_nodes = layer.reflection * sky + layer.transmitted(up);
}

}  // namespace

void put_on(const LayerOperator& layer, const Reflector& base, const RequestedDirections& requested,
            ReflectorParts parts, const Eigen::VectorXd& sky, OrderWork& work, Reflector& result) {
    const Eigen::Index n = base.nodes.rows();
    result.iterations = base.iterations;
    result.residual = base.residual;
    result.converged = base.converged;
    result.physical =
        parts != ReflectorParts::nodes || join_impedances(layer, base.nodes, work, result.nodes);
    if (!result.physical) return;

    work.seen = layer.direct.asDiagonal() * base.rows;
    work.square.resize(n, n);
    work.square.noalias() = -layer.reflection * base.nodes;
    work.square.diagonal().array() += 1.0;
    work.bounces.compute(work.square);
    if (parts == ReflectorParts::sky) fill_sky(layer, base, sky, work, result);
    if (parts == ReflectorParts::nodes) {
        work.beam = work.seen.transpose();
        work.through = layer.transmission_rows.transpose();
        fill_interface(layer, base, work);
        result.rows = layer.reflection_rows;
        result.rows.noalias() += work.up.transpose() * layer.transmission;  // T = T^T
    }
    fill_pairs(layer, base, requested, work, result);
}

}  // namespace miebrdf::rte
