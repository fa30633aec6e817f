// One Fourier order of a stack without boundaries, and its derivatives by strengths of scattering,
// optical depths and the ground: closed forms in the eigenbasis of each medium.
#pragma once

#include <Eigen/Core>
#include <vector>

#include "rte/derivatives/frozen_stack.h"
#include "rte/fourier/eigenmodes.h"
#include "rte/fourier/fourier_mode.h"
#include "rte/half_space/half_space.h"
#include "rte/layer/layer.h"

namespace miebrdf::rte {

/// The change of the media and the ground of a stack, times the change of the number.
struct ScaledChange {
    std::vector<Eigen::VectorXd> strengths;  ///< of ScaledOptics::strengths, by medium
    std::vector<double> depths;              ///< of scaled optical depths; 0 of a half-space
    double ground_albedo = 0.0;
};

/// Derivatives of a Reflector; empty matrices: zero.
struct ReflectorTangent {
    Eigen::MatrixXd nodes, rows, multiple;
    Eigen::VectorXd transmittance_at_nodes, transmittance_at_requested;

    bool is_zero() const { return nodes.size() == 0; }
};

/// Solves order after order. A small change dU, dV of the matrices of eigenmodes.h turns a function
/// of the medium Z_h = F h(lambda) F^T, lambda = k^2, by F E F^T, with M = (F^T V) dU (F^T V)^T,
/// N = F^T dV F and divided differences h[i,j] = (h_j - h_i) / (lambda_j - lambda_i)
///     E_ij = M_ij h[i,j] + N_ij (lambda_i h_j - lambda_j h_i) / (lambda_j - lambda_i).
/// Half-spaces: h = k; layers: h = k tanh(k tau/2), k coth(k tau/2), and the integrals of light
/// that leaves at a requested cosine. What a layer and its base do together follows from the light
/// at their interface: derivatives of both, seen by light from above on either side.
class OrderTangents {
  public:
    /// All arguments must outlive this.
    OrderTangents(const FrozenStack& frozen, const RequestedDirections& requested,
                  const std::vector<ScaledChange>& changes, bool transmits);

    /// Whether a stack, and those that differ from it a little, are of this kind.
    static bool can_solve(const FrozenStack& frozen, const ScaledStack& plus,
                          const ScaledStack& minus);

    /// False if there is no physical solution.
    bool solve(int fourier_order);
    const Reflector& reflector() const { return below_; }
    const std::vector<ReflectorTangent>& tangents() const { return tangents_; }

  private:
    struct Kernels {
        Eigen::MatrixXd even, odd, even_rows, odd_rows;
    };
    /// M and N of a change.
    struct Rotation {
        Eigen::MatrixXd M, N;
    };
    /// Light at the interface under a layer: upward and downward radiance at its nodes for light
    /// that enters above at each node, at each requested cosine, and for the ground's emission.
    struct Interface {
        Eigen::MatrixXd node_up, node_down, up, down;
        Eigen::VectorXd ground_up, ground_down;
    };

    void set_medium(std::size_t medium);
    Kernels kernels_of(const Eigen::VectorXd& strengths) const;
    Rotation rotation_of(const Kernels& change) const;
    void keep_eigenmodes();
    ReflectorTangent half_space(const Eigen::VectorXd& strengths) const;
    Interface interface_of(const Reflector& base) const;
    ReflectorTangent layer(const Eigen::VectorXd& strengths, double depth,
                           const ReflectorTangent& base, const Interface& light,
                           const Reflector& below, double tau) const;
    Eigen::VectorXd own_strengths(const ScaledChange& change, std::size_t medium) const;

    const FrozenStack& frozen_;
    const RequestedDirections& requested_;
    const std::vector<ScaledChange>& changes_;
    bool transmits_;
    const ZenithGrid& grid_;
    int order_ = 0;
    FourierModes tables_;
    const FourierMode* mode_ = nullptr;
    FourierMedium medium_;
    FourierWork work_;
    LayerOperator layer_;
    Reflector below_, above_;
    Eigen::MatrixXd F_, V_, VF_;
    Eigen::VectorXd k_;
    Kernels kernels_;
    std::vector<ReflectorTangent> tangents_;
};

}  // namespace miebrdf::rte
