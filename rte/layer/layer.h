// A homogeneous layer of finite optical depth: its reflection and transmission by itself, the layer
// on something that reflects, and the stepwise methods of the paper for the same.
#pragma once

#include <Eigen/Core>
#include <vector>

#include "rte/half_space/half_space.h"
#include "rte/phase/scaled_medium.h"

namespace miebrdf::rte {

/// One Fourier order of a free layer. The layer is the same from above and from below.
/// Normalisations as in Reflector.
struct LayerOperator {
    Eigen::MatrixXd reflection;         ///< X_c, n x n
    Eigen::MatrixXd transmission;       ///< T_c with the direct beam, n x n; for `nodes` only
    Eigen::MatrixXd reflection_rows;    ///< requested x n
    Eigen::MatrixXd transmission_rows;  ///< requested x n, scattered light only
    Eigen::MatrixXd multiple;           ///< R of light scattered more than once, out x in
    /// Transmission of such light, out x in, where RequestedDirections::beside says that it is
    /// wanted.
    Eigen::MatrixXd transmitted_multiple;
    Eigen::VectorXd direct;          ///< exp(-tau / mu) at the requested cosines
    Eigen::MatrixXd thin_impedance;  ///< Z_p = F k tanh(k tau / 2) F^T
    Eigen::MatrixXd coupling;        ///< B = F k / sinh(k tau) F^T
    Eigen::MatrixXd alike;     ///< (I + Z_p)^-1: light from both sides alike, (I + X_c + T_c) / 2
    Eigen::MatrixXd opposite;  ///< (I + Z_m)^-1: with opposite signs, (I + X_c - T_c) / 2
    bool physical = false;

    /// T_c times a vector; `between` is overwritten.
    void transmit(const Eigen::VectorXd& incident, Eigen::VectorXd& between,
                  Eigen::VectorXd& transmitted) const;
};

/// A free layer from the eigenmodes of its medium: with Z_p = F k tanh(k tau/2) F^T and
/// Z_m = F k coth(k tau/2) F^T = Z_p + 2 B,
///     R = (I + Z_p)^-1 + (I + Z_m)^-1 - I,   T = 2 (I + Z_p)^-1 B (I + Z_m)^-1.
/// Only positive definite operations; the cost does not depend on the optical depth. Radiance at
/// requested cosines is the source function integrated over the layer in closed form.
///
/// @param scaled_optical_depth  tau, > 0 and finite
/// @param parts      what the layer on its base is needed for
/// @param tolerance  as of EigenmodeSolver
/// @param layer      overwritten
void solve_layer(double scaled_optical_depth, const FourierMedium& medium, const FourierMode& mode,
                 const ZenithGrid& grid, const RequestedDirections& requested, ReflectorParts parts,
                 double tolerance, FourierWork& work, LayerOperator& layer);
LayerOperator solve_layer(double scaled_optical_depth, const FourierMedium& medium,
                          const FourierMode& mode, const ZenithGrid& grid,
                          const RequestedDirections& requested);

/// `multiple` of a layer out of its rows and `direct`, by Chandrasekhar's X and Y functions: R =
/// sum_l (-1)^(l-m) a_l (phi phi' - psi psi') / (4 (mu + mu')), without the first order.
/// @param work  with `alternating`
void fill_layer_pairs(const FourierMode& mode, const RequestedDirections& requested,
                      FourierWork& work, LayerOperator& layer);

/// `transmitted_multiple` likewise: T = sum_l a_l (psi phi' - phi psi') / (4 (mu - mu')), without
/// the first order. Towards the incident direction itself numerator and denominator vanish:
/// extrapolated from two incident cosines beside it.
void fill_transmitted(const FourierMedium& medium, const FourierMode& mode,
                      const RequestedDirections& requested, LayerOperator& layer);

/// Reflection of a layer on something: `base` seen through it.
/// Nodes by impedances, Z = Z_p + B (B + Y)^-1 Y with Y = Z_p + Z_base; requested cosines by the
/// radiance at the interface. Nothing cancels, whatever the optical depth.
/// `base` must have its nodes; the result has what `parts` says. A base with a specular part needs
/// requested cosines with `beside`. Light that the layer scatters only once is left out, also what
/// the base's mirror sends into it or out of it.
/// @param sky     for ReflectorParts::sky: downward radiance at the nodes
/// @param result  overwritten; must not be `base`
void put_on(const LayerOperator& layer, const Reflector& base, const RequestedDirections& requested,
            ReflectorParts parts, const Eigen::VectorXd& sky, FourierWork& work, Reflector& result);

/// Adds a coat by `substeps` equal steps of invariant imbedding. With S(R) the bracket of eq. (2)
/// without its loss terms, S = sum_l (-1)^(l-m) a_l phi_l(mu) phi_l(mu') / (4 mu mu'), and
/// q = 1/mu + 1/mu':
///
/// `first_order`: Chen et al. 2013, eq. (2): R' = (1 - h/mu) R (1 - h/mu') + h S(R). Diverges for
/// mu below h.
/// `first_order_patched`: the same, and where h/mu > 1/2 for either cosine the coat's single
/// scattering alone, as the paper does "at small eta" (it does not say how small).
/// `exponential`: losses exactly, sources to second order (Cox & Matthews 2002, ETD2RK):
/// R1 = e^-qh R + h f1(-qh) S(R), R' = R1 + h f2(-qh) [S(R1) - S(R)],
/// f1(z) = (e^z - 1)/z, f2(z) = (e^z - 1 - z)/z^2. Uniform down to grazing.
///
/// @param first_order_below  R of single scattering in everything below, out x in (first_order_of)
Reflector step_through_coat(CoatMethod method, int substeps, double scaled_optical_depth,
                            const FourierMedium& medium, const Eigen::MatrixXd& first_order_below,
                            const FourierMode& mode, const ZenithGrid& grid,
                            const RequestedDirections& requested, Reflector base);

/// One Fourier order of single scattering, by the moments of the discrete equations, out x in.
/// @param media  from the bottom up
Eigen::MatrixXd first_order_of(const std::vector<ScaledMedium>& media, const FourierMode& mode,
                               const RequestedDirections& requested);

}  // namespace miebrdf::rte
