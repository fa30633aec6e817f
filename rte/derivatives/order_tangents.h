// One Fourier order of a stack, and its derivatives by strengths of scattering, optical depths and
// the ground.
//
// Media are changed one by one, in the light that is around them: with x the light that enters a
// medium out of one requested direction, and x' that of another, the reflection between the two
// changes by x^T dX x' / 2 (MediumTangents), by reciprocity. Boundaries, mirrors and other media
// show in x alone, which is found from the top down once for all numbers.
#pragma once

#include <Eigen/Core>
#include <array>
#include <memory>
#include <vector>

#include "rte/derivatives/frozen_stack.h"
#include "rte/derivatives/medium_tangents.h"
#include "rte/phase/matrix_strengths.h"
#include "rte/stack/stack_solver.h"

namespace miebrdf::rte {

/// The change of the media and the ground of a stack, times the change of the number.
struct ScaledChange {
    std::vector<Eigen::VectorXd> strengths;  ///< of ScaledOptics::strengths, by medium
    std::vector<double> depths;              ///< of scaled optical depths; 0 of a half-space
    double ground_albedo = 0.0;
    /// Of unscattered_return at the nodes below a rough boundary over mirrors.
    Eigen::VectorXd unscattered = {};
    /// Of polarised light both sides, and how far apart they are.
    std::vector<MatrixStrengths> plus = {}, minus = {};
    double apart = 1.0;
};

/// Derivatives of a StackOrder; of light as a number or polarised light that does not couple V.
struct OrderTangent {
    Eigen::MatrixXd multiple;  ///< as StackOrder::multiple
    std::vector<double> plane_albedo = {}, polarised_plane_albedo = {}, transmittance = {};
    double spherical_albedo = 0.0;
};

class OrderTangents final : private StackFollower {
  public:
    /// All arguments must outlive this.
    /// @param requested  in air
    OrderTangents(const FrozenStack& frozen, const RequestedDirections& requested,
                  const std::vector<ScaledChange>& changes, int components, bool transmits);

    /// Whether both sides of a change differ by what has closed forms: not by indices.
    static bool can_solve(const FrozenStack& frozen, const ScaledStack& plus,
                          const ScaledStack& minus, int components);
    int fourier_orders() const { return solver_.fourier_orders(); }

    /// Pairs of cosines. False if there is no physical solution.
    bool solve(int fourier_order);
    /// Albedos, as StackSolver::solve_albedos.
    bool solve_albedos(const Eigen::VectorXd& let_in, const Eigen::VectorXd& let_out);
    const std::vector<OrderTangent>& tangents() const { return tangents_; }

  private:
    /// What is kept of a StackStep for the way down.
    struct Step {
        StackStep::Kind kind;
        std::size_t medium = 0;
        Eigen::VectorXd mu = {};  ///< requested, by rows
        Eigen::MatrixXd below_nodes = {}, below_rows = {};
        Eigen::VectorXd below_specular = {}, emission = {};  ///< the second of a ground that emits
        LayerOperator layer = {};
        SmoothBoundary boundary = {};
        Reflector white = {};  ///< of a ground
        std::unique_ptr<MediumTangents> tangents = {};
        Eigen::VectorXd beam = {};  ///< of each cosine, above the step
    };
    /// Changes of what beams are at last: sent back into air, and arriving at the ground.
    struct BeamEnds {
        Eigen::VectorXd returned, at_ground;
    };

    void follow(const StackStep& step) override;
    bool is_changed(std::size_t medium) const;
    StrengthChange strengths_of(const ScaledChange& change, std::size_t medium) const;
    void finish_block(const StackStep& whole);
    void light_from_above();
    Eigen::MatrixXd sent_up(const Step& step, const Eigen::VectorXd& beam) const;
    void pass_boundary(Step& step, PortFields& light) const;
    void pass_layer(Step& step, PortFields& light);
    void pass_rough_top(const Step& step, PortFields& light) const;
    Eigen::MatrixXd answer_to(const ScaledChange& change, BeamEnds& ends) const;
    void add_changed_beams(const ScaledChange& change, Eigen::MatrixXd& answer,
                           BeamEnds& ends) const;
    void keep_albedos(const Reflector& whole, const ScaledChange& change,
                      const Eigen::MatrixXd& answer, const BeamEnds& ends,
                      OrderTangent& tangent) const;

    const FrozenStack& frozen_;
    const RequestedDirections& asked_;
    const std::vector<ScaledChange>& changes_;
    int components_;
    ScaledStack stack_;
    StackMemory memory_;
    StackSolver solver_;
    int order_ = 0;
    const Eigen::VectorXd *let_in_ = nullptr, *let_out_ = nullptr;  ///< of albedos
    std::vector<Step> steps_;  ///< of the block that is being solved, from the bottom up
    const RoughTop* rough_ = nullptr;
    LitPorts ports_;
    Eigen::Index cosines_ = 0, lights_ = 0;
    std::array<double, 4> unpolarised_ = {1.0, 0.0, 0.0, 0.0};  ///< FourierMode's
    double emission_scale_ = 1.0;           ///< of radiance at nodes above the boundaries so far
    Eigen::VectorXd ground_transmittance_;  ///< of the ground alone, at the requested cosines
    PortFields at_bottom_;
    std::vector<OrderTangent> tangents_;
};

}  // namespace miebrdf::rte
