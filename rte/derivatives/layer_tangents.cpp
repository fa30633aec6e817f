#include <algorithm>
#include <cmath>
#include <utility>

#include "rte/derivatives/medium_tangents.h"
#include "rte/math/decay_integrals.h"

namespace miebrdf::rte {
namespace {

using Eigen::Index;
using Eigen::MatrixXd;
using Eigen::VectorXd;

// Closer lambda than this share of their sum: a difference would lose more digits than the
// derivative in the middle errs by, 1e-10.
constexpr double kClose = 1e-5;
// The same of an eigenmode and a requested cosine, where no more is at stake than a sum over
// eigenmodes of its own; what the derivative in the middle errs by is divided by it.
constexpr double kPole = 3e-2;
// The step in lambda of the derivative of an integral, whose second order errs by 1e-9.
constexpr double kLambdaStep = 1e-4;

bool are_close(double a, double b) { return std::abs(a - b) <= kClose * (a + b); }

// A function of lambda at all eigenmodes, its derivatives, and divided differences.
struct Spectrum {
    VectorXd h, slope, by_tau;
    MatrixXd divided;

    void divide(const VectorXd& lambda) {
        divided.resize(lambda.size(), lambda.size());
        for (Index j = 0; j < lambda.size(); ++j) {
            for (Index i = 0; i < lambda.size(); ++i) {
                divided(i, j) = are_close(lambda[i], lambda[j])
                                    ? 0.5 * (slope[i] + slope[j])
                                    : (h[j] - h[i]) / (lambda[j] - lambda[i]);
            }
        }
    }
};

// k tanh(k tau/2) and k coth(k tau/2).
struct Impedances {
    Spectrum tanh, coth;

    Impedances(const VectorXd& k, double tau) {
        const Index count = k.size();
        for (Spectrum* one : {&tanh, &coth})
            for (VectorXd* list : {&one->h, &one->slope, &one->by_tau}) list->resize(count);
        for (Index j = 0; j < count; ++j) {
            const double y = 0.5 * k[j] * tau, k2 = k[j] * k[j];
            if (y < 1e-4) {  // to the order y^4
                const double y2 = y * y;
                tanh.h[j] = 0.5 * tau * k2 * (1 - y2 / 3);
                tanh.slope[j] = 0.5 * tau * (1 - 2 * y2 / 3);
                coth.h[j] = 2 / tau * (1 + y2 / 3);
                coth.slope[j] = tau / 6 * (1 - 2 * y2 / 15);
                tanh.by_tau[j] = 0.5 * k2 * (1 - y2);
                coth.by_tau[j] = -2 / (tau * tau) * (1 - y2 / 3);
                continue;
            }
            const double t = std::tanh(y);
            const double over_sinh2 = y > 300 ? 0.0 : 1 / (std::sinh(y) * std::sinh(y));
            const double over_cosh2 = (1 - t) * (1 + t);
            tanh.h[j] = k[j] * t;
            tanh.slope[j] = (t + y * over_cosh2) / (2 * k[j]);
            coth.h[j] = k[j] / t;
            coth.slope[j] = (1 / t - y * over_sinh2) / (2 * k[j]);
            tanh.by_tau[j] = 0.5 * k2 * over_cosh2;
            coth.by_tau[j] = -0.5 * k2 * over_sinh2;
        }
        tanh.divide(k.cwiseAbs2());
        coth.divide(k.cwiseAbs2());
    }
};

// near + far and near - far of decay_integrals.
struct Leaving {
    double sum, difference;

    Leaving(double mu, double tau, double k) {
        const math::DecayIntegrals both = math::decay_integrals(tau / mu, k * tau);
        sum = both.near + both.far;
        difference = both.near - both.far;
    }
};

// With z = 1/mu and D = exp(-z tau) the integrals of light that leaves at mu are divided
// differences of the impedances with z^2,
//     sum = z (1 + D) h_p[lambda, z^2],   difference = z (1 - D) h_m[lambda, z^2],
// h_p = k tanh(k tau/2), h_m = k coth(k tau/2), and
//     difference h_p = z (1 - D) - z sum,   sum h_m = z (1 + D) - z difference.
// Rows for light from both sides alike are then (e + z o) sum - z (1 - D) o, times alike / 2, with
// e = E V F, o = O F; and with opposite signs (e + z o) difference - z (1 + D) o, times opposite /
// 2. The divided differences of `sum` between two eigenmodes are f[i,j] = (z (1 + D) h_p[i,j] -
// f_j) / (lambda_i - z^2): sums over them are products of matrices, one for all cosines.
class LayerTangents final : public MediumTangents {
  public:
    LayerTangents(const StackStep& step, double optical_depth, bool is_changed)
        : tau_(optical_depth),
          mu_(step.requested->mu),
          rows_(step.layer->reflection_rows),
          through_(step.layer->transmission_rows),
          multiple_(step.layer->multiple),
          transmitted_(step.layer->transmitted_multiple),
          beside_(step.requested->beside),
          rows_per_node_(step.mode->rows_per_node) {
        if (is_changed) take_modes(step);
    }

    void light_up(PortFields fields, const LitPorts& ports) override;
    void add(const StrengthChange& strengths, double depth, MatrixXd& answer) const override;
    void add_beams(const BeamChange& beams, MatrixXd& answer) const override;

  private:
    // Light from both sides alike, or with opposite signs.
    struct Part {
        MatrixXd integrals, by_tau;  // requested x modes
        VectorXd factor, beam;       // z (1 +- D), and what o is taken times
        VectorXd beam_by_tau;
        MatrixXd in, sources, pairs;  // modes x nodes; of Z's change in rows; and in pairs
        MatrixXd left, right;         // the light, modes x lights
    };

    void take_modes(const StackStep& step);
    MatrixXd turned_rows(const Part& part, const Spectrum& h, const MatrixXd& Q,
                         const MatrixXd& N) const;
    void add_pairs(const StrengthChange& strengths, double depth, const MatrixXd& alike,
                   const MatrixXd& opposite, MatrixXd& answer) const;
    MatrixXd transmitted_pairs(const MatrixXd& numerator) const;

    double tau_;
    VectorXd mu_;
    MatrixXd rows_, through_, multiple_, transmitted_;
    std::vector<int> beside_;
    int rows_per_node_;
    std::unique_ptr<MediumModes> modes_;
    std::unique_ptr<Impedances> h_;
    VectorXd lambda_, direct_;
    MatrixXd sources_, odd_, over_poles_, seen_odd_;  // e + z o, o, the first over lambda - z^2
    std::vector<std::pair<Index, Index>> poles_;      // cosine and eigenmode
    Part alike_, opposite_;
    MatrixXd phi_, psi_;              // requested x degrees
    MatrixXd first_psi_, first_phi_;  // direct light into s and p, requested x requested
    LitSide left_, right_;
};

void LayerTangents::take_modes(const StackStep& step) {
    const LayerOperator& layer = *step.layer;
    modes_ = std::make_unique<MediumModes>(step);
    const MediumModes& of = *modes_;
    h_ = std::make_unique<Impedances>(of.k, tau_);
    lambda_ = of.k.cwiseAbs2();
    direct_ = layer.direct;
    const Index cosines = mu_.size(), count = of.k.size();
    const VectorXd z = mu_.cwiseInverse();
    odd_ = of.kernels.odd_rows * of.F;
    sources_ = of.kernels.even_rows * of.VF + z.asDiagonal() * odd_;
    seen_odd_ = of.kernels.even_rows * odd_columns(of.nodes);
    over_poles_.resize(cosines, count);
    for (Part* part : {&alike_, &opposite_}) {
        part->integrals.resize(cosines, count);
        part->by_tau.resize(cosines, count);
    }
    for (Index j = 0; j < count; ++j) {
        for (Index r = 0; r < cosines; ++r) {
            const double square = z[r] * z[r], leaves = z[r] * direct_[r];
            const Leaving at(mu_[r], tau_, of.k[j]);
            alike_.integrals(r, j) = at.sum;
            opposite_.integrals(r, j) = at.difference;
            alike_.by_tau(r, j) = leaves + 0.5 * h_->tanh.h[j] * (at.difference - at.sum);
            opposite_.by_tau(r, j) = -leaves + 0.5 * h_->coth.h[j] * (at.sum - at.difference);
            const bool is_pole = std::abs(lambda_[j] - square) <= kPole * (lambda_[j] + square);
            over_poles_(r, j) = is_pole ? 0.0 : sources_(r, j) / (lambda_[j] - square);
            if (is_pole) poles_.emplace_back(r, j);
        }
    }
    const auto z_array = z.array();
    alike_.factor = opposite_.beam = z_array * (1.0 + direct_.array());
    opposite_.factor = alike_.beam = z_array * -(-mu_.cwiseInverse() * tau_).array().expm1();
    alike_.beam_by_tau = z_array.square() * direct_.array();
    opposite_.beam_by_tau = -alike_.beam_by_tau;
    alike_.in = of.F.transpose() * layer.alike;
    opposite_.in = of.F.transpose() * layer.opposite;

    const MatrixXd& Y = of.at_requested;
    const VectorXd& a = of.strengths;
    const VectorXd signs = alternating(a);
    const MatrixXd p = reflected_moments(mu_, rows_, *step.mode);
    const MatrixXd s = mu_.asDiagonal() * (through_ * of.nodes);
    phi_ = Y + p;
    psi_ = direct_.asDiagonal() * Y + s;
    first_psi_ = Y * signs.asDiagonal() * s.transpose();
    if (!beside_.empty()) first_phi_ = Y * a.asDiagonal() * p.transpose();
    const MatrixXd to_phi = of.nodes * (a.asDiagonal() * phi_.transpose());
    const MatrixXd to_psi = of.nodes * (signs.asDiagonal() * psi_.transpose());
    alike_.pairs = 0.5 * alike_.in * (to_phi - to_psi);
    opposite_.pairs = 0.5 * opposite_.in * (to_phi + to_psi);
    for (Part* part : {&alike_, &opposite_}) {
        const MatrixXd rows =
            sources_.cwiseProduct(part->integrals) - part->beam.asDiagonal() * odd_;
        part->sources = rows * (part->in * of.F);
    }
}

void LayerTangents::light_up(PortFields fields, const LitPorts& ports) {
    left_ = LitSide(fields, ports.left, ports.left_cosines);
    right_ = LitSide(fields, ports.right, ports.right_cosines);
    if (!modes_) return;
    alike_.left = alike_.in * (left_.top + left_.bottom);
    alike_.right = alike_.in * (right_.top + right_.bottom);
    opposite_.left = opposite_.in * (left_.top - left_.bottom);
    opposite_.right = opposite_.in * (right_.top - right_.bottom);
}

// (e + z o) times E of the integrals, and of what o is taken times besides, a constant, whose E is
// -N times it; Q = M + lambda N.
MatrixXd LayerTangents::turned_rows(const Part& part, const Spectrum& h, const MatrixXd& Q,
                                    const MatrixXd& N) const {
    MatrixXd rows = part.factor.asDiagonal() * (over_poles_ * Q.cwiseProduct(h.divided));
    rows -= part.integrals.cwiseProduct(over_poles_ * Q);
    rows.noalias() -= (sources_.cwiseProduct(part.integrals) - part.beam.asDiagonal() * odd_) * N;
    const bool is_alike = &part == &alike_;
    for (const auto& [r, i] : poles_) {
        const auto at = [&, row = r](double lambda) {
            const Leaving leaving(mu_[row], tau_, std::sqrt(lambda));
            return is_alike ? leaving.sum : leaving.difference;
        };
        const auto slope_at = [&](double lambda) {
            const double delta = kLambdaStep * lambda;
            return (at(lambda + delta) - at(lambda - delta)) / (2 * delta);
        };
        for (Index j = 0; j < lambda_.size(); ++j) {
            const double divided =
                are_close(lambda_[i], lambda_[j])
                    ? slope_at(0.5 * (lambda_[i] + lambda_[j]))
                    : (part.integrals(r, j) - part.integrals(r, i)) / (lambda_[j] - lambda_[i]);
            rows(r, j) += sources_(r, i) * Q(i, j) * divided;
        }
    }
    return rows;
}

void LayerTangents::add(const StrengthChange& strengths, double depth, MatrixXd& answer) const {
    const bool scatters = !strengths.is_zero();
    if (!scatters && depth == 0.0) return;
    const MediumModes& of = *modes_;
    const Index count = of.k.size();
    MediumModes::Turned turned;
    MatrixXd Q;
    if (scatters) {
        turned = of.turned(strengths);
        Q = turned.M + lambda_.asDiagonal() * turned.N;
    }
    const bool has_rows = !left_.cosines.empty() || !right_.cosines.empty();
    MatrixXd d_sources, d_odd;
    if (scatters && has_rows) {
        // Changes of o, and of e + z o: that of V goes with e.
        const auto odd = odd_columns(turned.modes);
        d_odd = odd_columns(of.at_requested) * odd.transpose();
        d_sources = even_columns(of.at_requested) * even_columns(turned.modes).transpose() -
                    seen_odd_ * odd.transpose() + mu_.cwiseInverse().asDiagonal() * d_odd;
    }
    const auto part_of = [&](const Part& part, const Spectrum& h, const VectorXd& left_beams,
                             const VectorXd& right_beams) {
        MatrixXd E = MatrixXd::Zero(count, count);
        if (scatters) E = Q.cwiseProduct(h.divided) - h.h.asDiagonal() * turned.N;
        E.diagonal() += depth * h.by_tau;
        answer.noalias() -= part.left.transpose() * (E * part.right);
        MatrixXd rows;
        if (!has_rows) return rows;
        rows = -part.sources * E;
        if (scatters) {
            rows += d_sources.cwiseProduct(part.integrals) + turned_rows(part, h, Q, turned.N) -
                    part.beam.asDiagonal() * d_odd;
        }
        if (depth != 0.0) {
            rows +=
                depth * (sources_.cwiseProduct(part.by_tau) - part.beam_by_tau.asDiagonal() * odd_);
        }
        add_rows(left_beams, right_beams, rows, left_, right_, part.left, part.right, 0.5, answer);
        return rows;
    };
    const MatrixXd alike = part_of(alike_, h_->tanh, left_.beam_top + left_.beam_bottom,
                                   right_.beam_top + right_.beam_bottom);
    const MatrixXd opposite = part_of(opposite_, h_->coth, left_.beam_top - left_.beam_bottom,
                                      right_.beam_top - right_.beam_bottom);
    if (!left_.cosines.empty() && !right_.cosines.empty())
        add_pairs(strengths, depth, alike, opposite, answer);
}

// R = sum_l +-a_l (phi phi' - psi psi') / (4 (mu + mu')), T = sum_l a_l (psi phi' - phi psi') /
// (4 (mu - mu')) without the first order, phi = Y + p, psi = direct Y + s.
void LayerTangents::add_pairs(const StrengthChange& strengths, double depth, const MatrixXd& alike,
                              const MatrixXd& opposite, MatrixXd& answer) const {
    const MatrixXd& Y = modes_->at_requested;
    const MatrixXd from_alike = mu_.asDiagonal() * (alike * alike_.pairs);
    const MatrixXd from_opposite = mu_.asDiagonal() * (opposite * opposite_.pairs);
    const VectorXd d_direct = -depth * direct_.cwiseQuotient(mu_);
    const std::vector<int>&out = left_.cosines, &in = right_.cosines;
    MatrixXd numerator = from_alike + from_opposite - d_direct.asDiagonal() * first_psi_;
    numerator = (numerator + numerator.transpose()).eval()(out, in);
    if (!strengths.is_zero()) {
        const StrengthChange signs = alternating(strengths);
        const auto product = [&](const MatrixXd& table) -> MatrixXd {
            return weighted(rows_of(table, out), signs) * rows_of(table, in).transpose();
        };
        const MatrixXd first = product(Y);
        numerator += product(phi_) - product(psi_) - first +
                     direct_(out).asDiagonal() * first * direct_(in).asDiagonal();
    }
    auto pairs = answer.topLeftCorner(numerator.rows(), numerator.cols());
    const MatrixXd reflected = numerator.cwiseQuotient(four_times_sums(mu_, left_, right_));
    pairs += 2.0 * left_.beam_top.asDiagonal() * reflected * right_.beam_top.asDiagonal();
    if (beside_.empty()) return;
    pairs += 2.0 * left_.beam_bottom.asDiagonal() * reflected * right_.beam_bottom.asDiagonal();
    numerator = from_alike - from_opposite + d_direct.asDiagonal() * first_phi_;
    numerator = (numerator - numerator.transpose()).eval();
    if (!strengths.is_zero()) {
        const MatrixXd first = weighted(Y, strengths) * Y.transpose();
        const MatrixXd both = weighted(psi_, strengths) * phi_.transpose();
        numerator +=
            both - both.transpose() - direct_.asDiagonal() * first + first * direct_.asDiagonal();
    }
    const MatrixXd transmitted = transmitted_pairs(numerator);
    pairs += 2.0 * (left_.beam_top.asDiagonal() * transmitted * right_.beam_bottom.asDiagonal() +
                    left_.beam_bottom.asDiagonal() * transmitted * right_.beam_top.asDiagonal());
}

// As fill_transmitted does.
MatrixXd LayerTangents::transmitted_pairs(const MatrixXd& numerator) const {
    const std::vector<int>&outs = left_.cosines, &ins = right_.cosines;
    MatrixXd result(Index(outs.size()), Index(ins.size()));
    const auto at = [&](int o, int i) { return numerator(o, i) / (4.0 * (mu_[o] - mu_[i])); };
    for (std::size_t i = 0; i < ins.size(); ++i) {
        for (std::size_t o = 0; o < outs.size(); ++o) {
            const int out = outs[o], in = ins[i];
            const bool is_straight = out / rows_per_node_ == in / rows_per_node_;
            const int beside = is_straight ? beside_[std::size_t(in)] : -1;
            result(Index(o), Index(i)) =
                beside < 0 ? at(out, in) : 2.0 * at(out, beside) - at(out, beside + rows_per_node_);
        }
    }
    return result;
}

void LayerTangents::add_beams(const BeamChange& beams, MatrixXd& answer) const {
    const auto side = [](const VectorXd& all_beams, const LitSide& of) -> VectorXd {
        if (all_beams.size() == 0) return VectorXd::Zero(Index(of.cosines.size()));
        return all_beams(of.cosines);
    };
    const VectorXd left_top = side(beams.top, left_), right_top = side(beams.top, right_);
    const VectorXd left_bottom = side(beams.bottom, left_),
                   right_bottom = side(beams.bottom, right_);
    add_rows(left_top, right_top, rows_, left_, right_, left_.top, right_.top, 1.0, answer);
    add_rows(left_top, right_top, through_, left_, right_, left_.bottom, right_.bottom, 1.0,
             answer);
    if (beams.bottom.size() > 0) {
        add_rows(left_bottom, right_bottom, rows_, left_, right_, left_.bottom, right_.bottom, 1.0,
                 answer);
        add_rows(left_bottom, right_bottom, through_, left_, right_, left_.top, right_.top, 1.0,
                 answer);
    }
    if (left_.cosines.empty() || right_.cosines.empty()) return;
    auto pairs = answer.topLeftCorner(multiple_.rows(), multiple_.cols());
    const auto add = [&](const MatrixXd& of, const VectorXd& left, const VectorXd& d_left,
                         const VectorXd& right, const VectorXd& d_right) {
        pairs += 2.0 * (d_left.asDiagonal() * of * right.asDiagonal() +
                        left.asDiagonal() * of * d_right.asDiagonal());
    };
    add(multiple_, left_.beam_top, left_top, right_.beam_top, right_top);
    if (beside_.empty()) return;
    add(multiple_, left_.beam_bottom, left_bottom, right_.beam_bottom, right_bottom);
    add(transmitted_, left_.beam_top, left_top, right_.beam_bottom, right_bottom);
    add(transmitted_, left_.beam_bottom, left_bottom, right_.beam_top, right_top);
}

}  // namespace

std::unique_ptr<MediumTangents> layer_tangents(const StackStep& step, double optical_depth,
                                               bool is_changed) {
    return std::make_unique<LayerTangents>(step, optical_depth, is_changed);
}

}  // namespace miebrdf::rte
