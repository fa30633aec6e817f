// Textbook solvers of the equation of transfer share this: Gauss nodes, a truncated phase function,
// azimuthal orders and the exact first order. Written anew: of rte/ it has quadrature and Legendre
// functions alone.
#pragma once

#include <Eigen/Core>
#include <functional>
#include <vector>

#include <miebrdf/solver.h>

namespace miebrdf::bench {

/// A layer by its Legendre moments.
struct MomentLayer {
    double single_scattering_albedo = 0.0;
    std::vector<double> chi;  ///< chi_0 = 1, chi_1 = g, ...
    std::function<double(double cos_theta)> phase;
    double optical_depth = 0.0;  ///< infinite for the base
};

/// From the top down; the last one has no end.
using MomentStack = std::vector<MomentLayer>;

/// One layer and one azimuthal order after delta-M (Wiscombe 1977).
struct OrderLayer {
    double albedo = 0.0;
    double optical_depth = 0.0;
    Eigen::VectorXd strength;  ///< (2l+1) chi'_l for l = m ... L-1
};

/// One azimuthal order m: Y_l^m = sqrt((l-m)!/(l+m)!) P_l^m, rows = directions, columns = l - m.
struct Order {
    Eigen::VectorXd mu, weights;  ///< Gauss nodes on (0, 1)
    Eigen::MatrixXd nodes;
    Eigen::VectorXd user_mu;  ///< incident cosines first
    Eigen::MatrixXd user;
    Eigen::Index incident = 0;       ///< how many of them are incident: columns that are wanted
    std::vector<OrderLayer> layers;  ///< from the top down

    /// p^m(a, b) = sum strength Y(a) Y(b), or with (-1)^(l-m) for opposite hemispheres.
    Eigen::MatrixXd phase(const OrderLayer& layer, const Eigen::MatrixXd& a,
                          const Eigen::MatrixXd& b, bool opposite) const;
};

/// R^m(user, user), columns of incident cosines at least, with everything scattered at least once
/// by the truncated phase function.
using OrderSolver = std::function<Eigen::MatrixXd(const Order&)>;

/// Cosine of the scattering angle.
double cos_scattering(double mu_in, double mu_out, double azimuth_deg);

/// R (laid out as rte::ReflectionTable) by a solver for one order: delta-M with 2 n moments, orders
/// until two in a row change nothing by more than 1e-10, and the first order exact (Nakajima &
/// Tanaka 1988).
/// @param streams  Gauss nodes per hemisphere
std::vector<double> sum_orders(const MomentStack& stack, int streams, const rte::Directions& wanted,
                               const OrderSolver& solver);

/// Plane albedo from order 0, the outgoing hemisphere integrated by the nodes themselves.
std::vector<double> plane_albedo(const MomentStack& stack, int streams,
                                 const std::vector<double>& mu_in, const OrderSolver& solver);

/// Doubling from a thin layer and adding (van de Hulst 1963; de Haan, Bosma & Hovenier 1987, eq.
/// 69-80, scalar). The thin layer scatters once, so light of the order of its optical depth is lost
/// in every unit of depth; a thinner start loses as much to rounding. A half-space is a layer that
/// is doubled until nothing changes.
/// @param thin  optical depth to start from
Eigen::MatrixXd adding_doubling(const Order& order, double thin = 1e-8);

/// Discrete ordinates (Chandrasekhar 1960; Stamnes et al. 1988): eigenvectors of every layer, a
/// particular solution for the beam and the boundary conditions as one linear system, all done
/// anew for each incident direction, as a program that is called once per sun angle does. Radiance
/// at user angles by integrating the source function. Albedo 1 is replaced by 1 - 1e-10: the method
/// as published has no answer there.
Eigen::MatrixXd discrete_ordinates(const Order& order);

}  // namespace miebrdf::bench
