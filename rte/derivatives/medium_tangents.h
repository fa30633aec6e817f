// Derivatives of what one half-space or layer does in one Fourier order, seen by the light around
// it: closed forms in the eigenbasis of the medium.
//
// A small change dU, dV of the matrices of eigenmodes.h turns a function of the medium Z_h =
// F h(lambda) F^T, lambda = k^2, by F E F^T, with M = (F^T V) dU (F^T V)^T, N = F^T dV F and
// divided differences h[i,j] = (h_j - h_i) / (lambda_j - lambda_i)
//     E_ij = M_ij h[i,j] + N_ij (lambda_i h_j - lambda_j h_i) / (lambda_j - lambda_i).
// All dU, dV are sums over degrees, so that M and N of any number come from the Legendre functions
// in the eigenbasis, which are found once.
#pragma once

#include <Eigen/Core>
#include <memory>
#include <vector>

#include "rte/fourier/eigenmodes.h"
#include "rte/fourier/fourier_mode.h"
#include "rte/half_space/half_space.h"
#include "rte/layer/layer.h"
#include "rte/stack/stack_solver.h"
#include "rte/stokes/stokes_mode.h"

namespace miebrdf::rte {

/// Answers are asked for between a light on the left and one on the right: columns of PortFields.
/// The first ones are requested cosines, with their beams.
struct LitPorts {
    std::vector<int> left, right;
    std::size_t left_cosines = 0, right_cosines = 0;
};

/// Light that enters a medium: diffuse at its nodes, and beams at the requested cosines that were
/// not scattered yet; on top, and from below, of a layer alone.
struct PortFields {
    Eigen::MatrixXd top, bottom;            ///< nodes x lights
    Eigen::VectorXd beam_top, beam_bottom;  ///< of each requested cosine in its own light
};

/// Changes of these beams.
struct BeamChange {
    Eigen::VectorXd top, bottom;

    bool is_zero() const { return top.size() == 0; }
};

/// What the light on the left receives of that on the right: 2 R between cosines, 2 R D between a
/// cosine and nodes, X between nodes.
class MediumTangents {
  public:
    virtual ~MediumTangents() = default;

    /// @param ports  must outlive this
    virtual void light_up(PortFields fields, const LitPorts& ports) = 0;
    /// @param depth   the change of the optical depth
    /// @param answer  left x right, added to
    virtual void add(const StrengthChange& strengths, double depth,
                     Eigen::MatrixXd& answer) const = 0;
    /// Of other beams.
    virtual void add_beams(const BeamChange& beams, Eigen::MatrixXd& answer) const = 0;
};

/// @param is_changed  false: beams alone change
std::unique_ptr<MediumTangents> half_space_tangents(const StackStep& step, bool is_changed);
std::unique_ptr<MediumTangents> layer_tangents(const StackStep& step, double optical_depth,
                                               bool is_changed);

/// Eigenmodes of a medium, and the Legendre functions of its order in their basis.
struct MediumModes {
    Eigen::MatrixXd F, VF;
    Eigen::VectorXd k;
    Eigen::MatrixXd at_requested, nodes;  ///< of FourierMode, requested and scaled_nodes
    Eigen::MatrixXd modes;                ///< K x degrees: (V F)^T y, F^T y of the odd columns
    Eigen::VectorXd strengths;
    Eigen::VectorXd mu;
    ScatteringKernels kernels;

    explicit MediumModes(const StackStep& step);

    /// `modes` times the change, and M and N.
    struct Turned {
        Eigen::MatrixXd modes, M, N;
    };
    Turned turned(const StrengthChange& change) const;
};

/// A table with a column for each degree times a change.
Eigen::MatrixXd weighted(const Eigen::MatrixXd& table, const StrengthChange& change);
/// Each column with its sign (-1)^(l-m).
StrengthChange alternating(StrengthChange change);

/// The listed ones of a matrix.
Eigen::MatrixXd rows_of(const Eigen::MatrixXd& table, const std::vector<int>& which);
Eigen::MatrixXd columns_of(const Eigen::MatrixXd& table, const std::vector<int>& which);

/// A light and its beams on one side of the answer.
struct LitSide {
    Eigen::MatrixXd top, bottom;
    Eigen::VectorXd beam_top, beam_bottom;  ///< of its cosines
    std::vector<int> cosines;

    LitSide() = default;
    LitSide(const PortFields& fields, const std::vector<int>& lights, std::size_t cosine_count);
};

/// 4 (mu + mu') or 4 (mu - mu') of each pair of cosines, out x in.
Eigen::MatrixXd four_times_sums(const Eigen::VectorXd& mu, const LitSide& left,
                                const LitSide& right);

/// answer += of each cosine on the left `beams` times its row times the light on the right, and of
/// each on the right likewise.
void add_rows(const Eigen::VectorXd& left_beams, const Eigen::VectorXd& right_beams,
              const Eigen::MatrixXd& rows, const LitSide& left, const LitSide& right,
              const Eigen::MatrixXd& left_light, const Eigen::MatrixXd& right_light, double factor,
              Eigen::MatrixXd& answer);

}  // namespace miebrdf::rte
