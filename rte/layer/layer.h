// A homogeneous layer of finite optical depth: its reflection and transmission by itself.
#pragma once

#include <Eigen/Core>

#include "rte/fourier/order_work.h"
#include "rte/half_space/reflector.h"
#include "rte/phase/phase_mode.h"
#include "rte/phase/scattering_mode.h"

namespace miebrdf::rte {

/// One azimuthal order of a free layer. The layer is the same from above and from below.
/// Normalisations as in Reflector.
struct LayerOperator {
    Eigen::MatrixXd reflection;         ///< X_c, n x n
    Eigen::MatrixXd transmission;       ///< T_c with the direct beam, n x n; for `nodes` only
    Eigen::MatrixXd reflection_rows;    ///< requested x n
    Eigen::MatrixXd transmission_rows;  ///< requested x n, scattered light only
    Eigen::MatrixXd multiple;           ///< R of light scattered more than once, out x in
    Eigen::VectorXd direct;             ///< exp(-tau / mu) at the requested cosines
    Eigen::MatrixXd thin_impedance;     ///< Z_p = F k tanh(k tau / 2) F^T
    Eigen::MatrixXd coupling;           ///< B = F k / sinh(k tau) F^T
    Eigen::MatrixXd alike;     ///< (I + Z_p)^-1: light from both sides alike, (I + X_c + T_c) / 2
    Eigen::MatrixXd opposite;  ///< (I + Z_m)^-1: with opposite signs, (I + X_c - T_c) / 2
    bool physical = false;

    /// T_c times a vector.
    Eigen::VectorXd transmitted(const Eigen::VectorXd& incident) const;
};

/// From the eigenmodes of the medium: with Z_p = F k tanh(k tau/2) F^T and
/// Z_m = F k coth(k tau/2) F^T = Z_p + 2 B,
///     R = (I + Z_p)^-1 + (I + Z_m)^-1 - I,   T = 2 (I + Z_p)^-1 B (I + Z_m)^-1.
/// Only positive definite operations; the cost does not depend on the optical depth. Radiance at
/// requested cosines is the source function integrated over the layer in closed form.
///
/// @param optical_depth  > 0 and finite, already scaled by delta-M
/// @param parts          what the layer on its base is needed for
/// @param tolerance      as of ModeDecomposition
/// @param layer          overwritten
void solve_layer(double optical_depth, const ScatteringMode& medium, const PhaseMode& mode,
                 const ZenithGrid& grid, const RequestedDirections& requested, ReflectorParts parts,
                 double tolerance, OrderWork& work, LayerOperator& layer);
LayerOperator solve_layer(double optical_depth, const ScatteringMode& medium, const PhaseMode& mode,
                          const ZenithGrid& grid, const RequestedDirections& requested);

/// Reflection of a layer on something: `base` seen through it.
/// Nodes by impedances, Z = Z_p + B (B + Y)^-1 Y with Y = Z_p + Z_base; requested cosines by the
/// radiance at the interface. Nothing cancels, whatever the optical depth.
/// `base` must have its nodes; the result has what `parts` says.
/// @param sky     for ReflectorParts::sky: downward radiance at the nodes
/// @param result  overwritten; not `base`
void put_on(const LayerOperator& layer, const Reflector& base, const RequestedDirections& requested,
            ReflectorParts parts, const Eigen::VectorXd& sky, OrderWork& work, Reflector& result);

}  // namespace miebrdf::rte
