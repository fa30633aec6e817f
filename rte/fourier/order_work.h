// The memory in which azimuthal orders are solved.
#pragma once

#include <Eigen/LU>

#include "rte/fourier/mode_sources.h"
#include "rte/fourier/pair_products.h"
#include "rte/fourier/transfer_modes.h"
#include "rte/math/decay_integrals.h"
#include "rte/math/scratch.h"

namespace miebrdf::rte {

/// Intermediate results of solve_half_space, solve_layer and put_on. One is enough for all media
/// of a stack, all orders and one number of nodes after the other: what it holds matters to none
/// but the function that runs. Not for two threads.
struct OrderWork {
    ModeDecomposition decomposition;
    ModeSources sources;
    PairProducts products;
    math::DecayIntegrator decays;     ///< of the layer solved last
    math::ScratchVector alternating;  ///< strengths with the sign of their column
    math::ScratchMatrix phi, weighted, phi_requested, moments;  ///< cosines x degrees
    math::ScratchMatrix beam, through, incoming, down, up;      ///< nodes x cosines
    math::ScratchMatrix pairs;
    Eigen::VectorXd flux_weights, mu_over_flux_weights;
    Eigen::VectorXd near, far, tanh_rates, sinh_rates;
    Eigen::MatrixXd square, other_square, below, joint;  ///< n x n
    Eigen::MatrixXd rows, seen;                          ///< cosines x n
    Eigen::PartialPivLU<Eigen::MatrixXd> bounces;
};

}  // namespace miebrdf::rte
