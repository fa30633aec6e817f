#include <utility>

#include "rte/derivatives/medium_tangents.h"

namespace miebrdf::rte {

using Eigen::Index;
using Eigen::MatrixXd;
using Eigen::VectorXd;

MediumModes::MediumModes(const StackStep& step)
    : at_requested(step.mode->at_requested),
      nodes(step.mode->scaled_nodes),
      strengths(step.scattering->strengths),
      mu(step.requested->mu) {
    if (!step.has_eigenmodes) step.eigenmodes->find(*step.mode, *step.scattering, *step.grid, 0.0);
    const Eigenmodes& found = step.eigenmodes->eigenmodes();
    kernels = step.eigenmodes->kernels();
    F = found.vectors;
    k = found.rates;
    VF.noalias() = found.odd * F;
    const MatrixXd even = VF.transpose() * even_columns(nodes);
    const MatrixXd odd = F.transpose() * odd_columns(nodes);
    modes.resize(F.cols(), nodes.cols());
    for (Index c = 0; c < nodes.cols(); ++c) modes.col(c) = (c % 2 == 0 ? even : odd).col(c / 2);
}

MatrixXd weighted(const MatrixXd& table, const StrengthChange& change) {
    MatrixXd result = table * change.own.asDiagonal();
    for (Index c = 0; c < change.beside.size(); ++c) {
        const double both = change.beside[c];
        if (both == 0.0) continue;
        result.col(c) += both * table.col(c + 2);
        result.col(c + 2) += both * table.col(c);
    }
    return result;
}

StrengthChange alternating(StrengthChange change) {
    for (VectorXd* list : {&change.own, &change.beside})
        for (Index c = 1; c < list->size(); c += 2) (*list)[c] *= -1.0;
    return change;
}

MediumModes::Turned MediumModes::turned(const StrengthChange& change) const {
    Turned result;
    result.modes = weighted(modes, change);
    result.M.noalias() = -even_columns(result.modes) * even_columns(modes).transpose();
    result.N.noalias() = -odd_columns(result.modes) * odd_columns(modes).transpose();
    return result;
}

MatrixXd rows_of(const MatrixXd& table, const std::vector<int>& which) {
    MatrixXd result;
    gather_rows(table, which, result);
    return result;
}

MatrixXd columns_of(const MatrixXd& table, const std::vector<int>& which) {
    MatrixXd result(table.rows(), Index(which.size()));
    for (std::size_t k = 0; k < which.size(); ++k) result.col(Index(k)) = table.col(which[k]);
    return result;
}

LitSide::LitSide(const PortFields& fields, const std::vector<int>& lights, std::size_t cosine_count)
    : top(columns_of(fields.top, lights)),
      cosines(lights.begin(), lights.begin() + std::ptrdiff_t(cosine_count)) {
    if (fields.bottom.size() > 0) bottom = columns_of(fields.bottom, lights);
    if (fields.beam_top.size() == 0) cosines.clear();  // no beam gets here
    beam_top = fields.beam_top(cosines);
    if (fields.beam_bottom.size() > 0) beam_bottom = fields.beam_bottom(cosines);
}

MatrixXd four_times_sums(const VectorXd& mu, const LitSide& left, const LitSide& right) {
    MatrixXd result(Index(left.cosines.size()), Index(right.cosines.size()));
    for (Index i = 0; i < result.cols(); ++i)
        for (Index o = 0; o < result.rows(); ++o)
            result(o, i) =
                4.0 * (mu[left.cosines[std::size_t(o)]] + mu[right.cosines[std::size_t(i)]]);
    return result;
}

void add_rows(const VectorXd& left_beams, const VectorXd& right_beams, const MatrixXd& rows,
              const LitSide& left, const LitSide& right, const MatrixXd& left_light,
              const MatrixXd& right_light, double factor, MatrixXd& answer) {
    if (!left.cosines.empty()) {
        const MatrixXd lit = left_beams.asDiagonal() * rows_of(rows, left.cosines);
        answer.topRows(lit.rows()).noalias() += factor * lit * right_light;
    }
    if (!right.cosines.empty()) {
        const MatrixXd lit = right_beams.asDiagonal() * rows_of(rows, right.cosines);
        answer.leftCols(lit.rows()).noalias() += factor * left_light.transpose() * lit.transpose();
    }
}

namespace {

// Z = F k F^T: E_ij = (M_ij - k_i N_ij k_j) / (k_i + k_j), dX = -B^T E B / 2 with B = F^T (I + X).
// Rows at the requested cosines obey r (I + mu K) = [(E - O) + (E + O) X] / 2 with K = S k S^-1, S
// = V F + F k, S^-1 = F^T (I + X) / 2; pairs are sums of phi phi' as those of layers are.
class HalfSpaceTangents final : public MediumTangents {
  public:
    HalfSpaceTangents(const StackStep& step, bool is_changed)
        : mu_(step.requested->mu), rows_(step.result->rows), multiple_(step.result->multiple) {
        if (!is_changed) return;
        modes_ = std::make_unique<MediumModes>(step);
        const MediumModes& of = *modes_;
        const MatrixXd& X = step.result->nodes;
        B_ = of.F.transpose() + of.F.transpose() * X;
        const MatrixXd T = mu_.asDiagonal() * rows_;
        const MatrixXd C =
            of.kernels.even_rows + of.kernels.odd_rows + T * (of.kernels.even - of.kernels.odd);
        W_ = 0.5 * C * B_.transpose();
        decay_.resize(mu_.size(), of.k.size());
        for (Index j = 0; j < of.k.size(); ++j)
            decay_.col(j) = (1.0 + of.k[j] * mu_.array()).inverse();
        phi_ = of.at_requested + reflected_moments(mu_, rows_, *step.mode);
        pairs_ = 0.5 * B_ * (of.nodes * (of.strengths.asDiagonal() * phi_.transpose()));
    }

    void light_up(PortFields fields, const LitPorts& ports) override {
        left_ = LitSide(fields, ports.left, ports.left_cosines);
        right_ = LitSide(fields, ports.right, ports.right_cosines);
        if (!modes_) return;
        left_light_.noalias() = B_ * left_.top;
        right_light_.noalias() = B_ * right_.top;
    }

    void add(const StrengthChange& strengths, double, MatrixXd& answer) const override {
        if (strengths.is_zero()) return;
        const MediumModes& of = *modes_;
        const auto [modes, M, N] = of.turned(strengths);
        MatrixXd E(M.rows(), M.cols());
        for (Index j = 0; j < E.cols(); ++j) {
            for (Index i = 0; i < E.rows(); ++i) {
                const double sum = of.k[i] + of.k[j];
                E(i, j) = sum > 0.0 ? (M(i, j) - of.k[i] * N(i, j) * of.k[j]) / sum : 0.0;
            }
        }
        answer.noalias() -= 0.5 * left_light_.transpose() * (E * right_light_);
        if (left_.cosines.empty() && right_.cosines.empty()) return;
        MatrixXd rows = even_columns(phi_) * even_columns(modes).transpose();
        rows.noalias() -= odd_columns(phi_) * odd_columns(modes).transpose() * of.k.asDiagonal();
        rows.noalias() -= W_ * E;
        rows.array() *= decay_.array();
        add_rows(left_.beam_top, right_.beam_top, rows, left_, right_, left_light_, right_light_,
                 0.5, answer);
        if (left_.cosines.empty() || right_.cosines.empty()) return;
        const MatrixXd seen = mu_.asDiagonal() * (rows * pairs_);
        const StrengthChange signs = alternating(strengths);
        const auto product = [&](const MatrixXd& table) -> MatrixXd {
            return weighted(rows_of(table, left_.cosines), signs) *
                   rows_of(table, right_.cosines).transpose();
        };
        MatrixXd numerator = product(phi_) - product(of.at_requested);
        numerator +=
            seen(left_.cosines, right_.cosines) + seen(right_.cosines, left_.cosines).transpose();
        answer.topLeftCorner(numerator.rows(), numerator.cols()) +=
            2.0 * left_.beam_top.asDiagonal() *
            numerator.cwiseQuotient(four_times_sums(mu_, left_, right_)) *
            right_.beam_top.asDiagonal();
    }

    void add_beams(const BeamChange& beams, MatrixXd& answer) const override {
        const VectorXd left = beams.top(left_.cosines), right = beams.top(right_.cosines);
        add_rows(left, right, rows_, left_, right_, left_.top, right_.top, 1.0, answer);
        if (left_.cosines.empty() || right_.cosines.empty()) return;
        answer.topLeftCorner(multiple_.rows(), multiple_.cols()) +=
            2.0 * (left.asDiagonal() * multiple_ * right_.beam_top.asDiagonal() +
                   left_.beam_top.asDiagonal() * multiple_ * right.asDiagonal());
    }

  private:
    VectorXd mu_;
    MatrixXd rows_, multiple_;
    std::unique_ptr<MediumModes> modes_;
    MatrixXd B_, W_, decay_, phi_, pairs_;
    LitSide left_, right_;
    MatrixXd left_light_, right_light_;
};

}  // namespace

std::unique_ptr<MediumTangents> half_space_tangents(const StackStep& step, bool is_changed) {
    return std::make_unique<HalfSpaceTangents>(step, is_changed);
}

}  // namespace miebrdf::rte
