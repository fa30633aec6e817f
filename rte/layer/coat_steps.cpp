// The stepwise coat methods: the paper's, and a uniform replacement at the same cost.
#include <cmath>

#include "rte/fourier/fourier_mode.h"
#include "rte/layer/layer.h"
#include "rte/math/interruption.h"

namespace miebrdf::rte {
namespace {

using Eigen::MatrixXd;
using Eigen::VectorXd;

// Plain R between nodes, from nodes to requested cosines, and between requested pairs.
struct Blocks {
    MatrixXd nodes;
    MatrixXd rows;
    MatrixXd pairs;
};

// Ambartsumian's functions phi_l and the cosines they belong to, for both sides of each block.
struct Side {
    VectorXd mu;
    MatrixXd phi;
};

struct Sides {
    Side nodes;
    Side requested;
    Side out;
    Side in;
};

Sides make_sides(const Blocks& R, const FourierMode& mode, const ZenithGrid& grid,
                 const RequestedDirections& requested) {
    const VectorXd twice_D = 2.0 * flux_weights(grid);
    Sides sides;
    sides.nodes = {
        grid.mu, mode.at_nodes + reflected_moments(grid.mu, R.nodes * twice_D.asDiagonal(), mode)};
    sides.requested = {
        requested.mu,
        mode.at_requested + reflected_moments(requested.mu, R.rows * twice_D.asDiagonal(), mode)};
    sides.out = {requested.mu(requested.out), sides.requested.phi(requested.out, Eigen::all)};
    sides.in = {requested.mu(requested.in), sides.requested.phi(requested.in, Eigen::all)};
    return sides;
}

MatrixXd sources(const VectorXd& strengths, const Side& row, const Side& column) {
    return (0.25 * row.mu.cwiseInverse()).asDiagonal() * row.phi * strengths.asDiagonal() *
           column.phi.transpose() * column.mu.cwiseInverse().asDiagonal();
}

// (e^z - 1)/z and (e^z - 1 - z)/z^2 for z <= 0.
double f1(double z) { return z > -1e-8 ? 1.0 + 0.5 * z : std::expm1(z) / z; }
double f2(double z) {
    if (z < -0.1) return (std::expm1(z) - z) / (z * z);
    double sum = 0.0;  // Taylor: the terms fall by |z| / (k + 2) < 0.04
    double term = 0.5;
    for (int k = 0; k < 10; ++k) {
        sum += term;
        term *= z / (k + 3.0);
    }
    return sum;
}

// R' at one pair of cosines from R, S(R), and for the second stage S(R1) - S(R).
double first_order_step(double h, double mu_row, double mu_column, double R, double S) {
    return (1.0 - h / mu_row) * R * (1.0 - h / mu_column) + h * S;
}

template <typename Step>
MatrixXd for_each_pair(const MatrixXd& R, const MatrixXd& S, const VectorXd& mu_row,
                       const VectorXd& mu_column, Step step) {
    MatrixXd result(R.rows(), R.cols());
    for (Eigen::Index c = 0; c < R.cols(); ++c) {
        for (Eigen::Index r = 0; r < R.rows(); ++r) {
            result(r, c) = step(mu_row[r], mu_column[c], R(r, c), S(r, c));
        }
    }
    return result;
}

template <typename Step>
Blocks advance(const Blocks& R, const Blocks& S, const Sides& sides, Step step) {
    return {for_each_pair(R.nodes, S.nodes, sides.nodes.mu, sides.nodes.mu, step),
            for_each_pair(R.rows, S.rows, sides.requested.mu, sides.nodes.mu, step),
            for_each_pair(R.pairs, S.pairs, sides.out.mu, sides.in.mu, step)};
}

Blocks all_sources(const VectorXd& strengths, const Sides& sides) {
    return {sources(strengths, sides.nodes, sides.nodes),
            sources(strengths, sides.requested, sides.nodes),
            sources(strengths, sides.out, sides.in)};
}

MatrixXd first_order_matrix(const ScaledMedium& medium, const FourierMode& mode,
                            const RequestedDirections& requested) {
    VectorXd strengths = VectorXd::Zero(mode.at_nodes.cols());
    const VectorXd all = medium.scaled.strengths();
    const Eigen::Index count = std::max<Eigen::Index>(0, all.size() - mode.fourier_order);
    strengths.head(count) = all.tail(count);
    return mode.at_requested(requested.out, Eigen::all) * alternating(strengths).asDiagonal() *
           mode.at_requested(requested.in, Eigen::all).transpose();
}

}  // namespace

MatrixXd first_order_of(const std::vector<ScaledMedium>& media, const FourierMode& mode,
                        const RequestedDirections& requested) {
    const VectorXd mu_out = requested.mu(requested.out);
    const VectorXd mu_in = requested.mu(requested.in);
    MatrixXd sum = MatrixXd::Zero(mu_out.size(), mu_in.size());
    for (const ScaledMedium& medium : media) {
        const MatrixXd here = first_order_matrix(medium, mode, requested);
        for (Eigen::Index i = 0; i < sum.cols(); ++i) {
            for (Eigen::Index o = 0; o < sum.rows(); ++o) {
                const double slant =
                    medium.scaled_optical_depth * (1.0 / mu_out[o] + 1.0 / mu_in[i]);
                sum(o, i) = std::exp(-slant) * sum(o, i) -
                            std::expm1(-slant) * here(o, i) / (4.0 * (mu_out[o] + mu_in[i]));
            }
        }
    }
    return sum;
}

Reflector step_through_coat(CoatMethod method, int substeps, double scaled_optical_depth,
                            const FourierMedium& medium, const MatrixXd& first_order_below,
                            const FourierMode& mode, const ZenithGrid& grid,
                            const RequestedDirections& requested, Reflector base) {
    const VectorXd D = flux_weights(grid);
    const VectorXd per_two_D = 0.5 * D.cwiseInverse();
    const VectorXd strengths = alternating(medium.strengths);
    const double h = scaled_optical_depth / substeps;
    Blocks R{2.0 * per_two_D.asDiagonal() * base.nodes * per_two_D.asDiagonal(),
             base.rows * per_two_D.asDiagonal(), base.multiple + first_order_below};

    for (int step = 0; step < substeps; ++step) {
        math::interruption_point();
        const Sides sides = make_sides(R, mode, grid, requested);
        const Blocks S = all_sources(strengths, sides);
        if (method == CoatMethod::exponential) {
            const Blocks first = advance(R, S, sides, [h](double a, double b, double r, double s) {
                const double z = -h * (1.0 / a + 1.0 / b);
                return std::exp(z) * r + h * f1(z) * s;
            });
            Blocks change = all_sources(strengths, make_sides(first, mode, grid, requested));
            change.nodes -= S.nodes;
            change.rows -= S.rows;
            change.pairs -= S.pairs;
            R = advance(first, change, sides, [h](double a, double b, double r, double ds) {
                return r + h * f2(-h * (1.0 / a + 1.0 / b)) * ds;
            });
            continue;
        }
        const bool patched = method == CoatMethod::first_order_patched;
        R = advance(R, S, sides, [=](double a, double b, double r, double s) {
            return patched && h > 0.5 * std::min(a, b) ? std::nan("")
                                                       : first_order_step(h, a, b, r, s);
        });
        if (patched) {  // what was left open: single scattering of the coat so far
            const double depth = h * (step + 1);
            const Sides single{{grid.mu, mode.at_nodes},
                               {requested.mu, mode.at_requested},
                               {sides.out.mu, mode.at_requested(requested.out, Eigen::all)},
                               {sides.in.mu, mode.at_requested(requested.in, Eigen::all)}};
            R = advance(R, all_sources(strengths, single), single,
                        [depth](double a, double b, double r, double s) {
                            const double q = 1.0 / a + 1.0 / b;
                            return std::isnan(r) ? s * -std::expm1(-depth * q) / q : r;
                        });
        }
    }

    base.nodes = 2.0 * D.asDiagonal() * R.nodes * D.asDiagonal();
    base.rows = 2.0 * R.rows * D.asDiagonal();
    const MatrixXd coat_alone = mode.at_requested(requested.out, Eigen::all) *
                                strengths.asDiagonal() *
                                mode.at_requested(requested.in, Eigen::all).transpose();
    for (Eigen::Index i = 0; i < R.pairs.cols(); ++i) {
        for (Eigen::Index o = 0; o < R.pairs.rows(); ++o) {
            const double a = requested.mu[requested.out[o]];
            const double b = requested.mu[requested.in[i]];
            const double slant = scaled_optical_depth * (1.0 / a + 1.0 / b);
            R.pairs(o, i) -= std::exp(-slant) * first_order_below(o, i) -
                             std::expm1(-slant) * coat_alone(o, i) / (4.0 * (a + b));
        }
    }
    base.multiple = R.pairs;
    return base;
}

}  // namespace miebrdf::rte
