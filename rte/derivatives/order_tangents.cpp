#include "rte/derivatives/order_tangents.h"

#include <algorithm>
#include <cmath>
#include <functional>

namespace miebrdf::rte {
namespace {

using Eigen::MatrixXd;
using Eigen::VectorXd;

// Closer lambda than this share of their sum: a difference would lose more digits than the
// derivative in the middle errs by, 1e-10.
constexpr double kClose = 1e-5;
// The step in lambda of the derivative of an integral, whose second order errs by 1e-9.
constexpr double kLambdaStep = 1e-4;

// A function of lambda at all eigenmodes, and its derivative.
struct Spectrum {
    VectorXd h, slope;
};

// E of the head of OrderTangents.
MatrixXd rotated(const MatrixXd& M, const MatrixXd& N, const VectorXd& lambda, const Spectrum& f) {
    MatrixXd E(M.rows(), M.cols());
    for (Eigen::Index j = 0; j < E.cols(); ++j) {
        for (Eigen::Index i = 0; i < E.rows(); ++i) {
            const double gap = lambda[j] - lambda[i];
            if (std::abs(gap) <= kClose * (lambda[i] + lambda[j])) {
                const double slope = 0.5 * (f.slope[i] + f.slope[j]);
                const double h = 0.5 * (f.h[i] + f.h[j]), at = 0.5 * (lambda[i] + lambda[j]);
                E(i, j) = M(i, j) * slope + N(i, j) * (at * slope - h);
            } else {
                E(i, j) = (M(i, j) * (f.h[j] - f.h[i]) +
                           N(i, j) * (lambda[i] * f.h[j] - lambda[j] * f.h[i])) /
                          gap;
            }
        }
    }
    return E;
}

// k tanh(k tau/2) and its derivative by lambda and by tau; k coth(k tau/2) likewise.
struct Impedances {
    Spectrum tanh, coth;
    VectorXd tanh_by_tau, coth_by_tau;

    Impedances(const VectorXd& k, double tau) {
        const Eigen::Index count = k.size();
        for (VectorXd* list :
             {&tanh.h, &tanh.slope, &coth.h, &coth.slope, &tanh_by_tau, &coth_by_tau})
            list->resize(count);
        for (Eigen::Index j = 0; j < count; ++j) {
            const double y = 0.5 * k[j] * tau, k2 = k[j] * k[j];
            if (y < 1e-4) {  // to the order y^4
                const double y2 = y * y;
                tanh.h[j] = 0.5 * tau * k2 * (1 - y2 / 3);
                tanh.slope[j] = 0.5 * tau * (1 - 2 * y2 / 3);
                coth.h[j] = 2 / tau * (1 + y2 / 3);
                coth.slope[j] = tau / 6 * (1 - 2 * y2 / 15);
                tanh_by_tau[j] = 0.5 * k2 * (1 - y2);
                coth_by_tau[j] = -2 / (tau * tau) * (1 - y2 / 3);
                continue;
            }
            const double t = std::tanh(y);
            const double over_sinh2 = y > 300 ? 0.0 : 1 / (std::sinh(y) * std::sinh(y));
            const double over_cosh2 = (1 - t) * (1 + t);
            tanh.h[j] = k[j] * t;
            tanh.slope[j] = (t + y * over_cosh2) / (2 * k[j]);
            coth.h[j] = k[j] / t;
            coth.slope[j] = (1 / t - y * over_sinh2) / (2 * k[j]);
            tanh_by_tau[j] = 0.5 * k2 * over_cosh2;
            coth_by_tau[j] = -0.5 * k2 * over_sinh2;
        }
    }
};

// near + far and near - far of decay_integrals at one requested cosine.
struct Leaving {
    VectorXd sum, difference;

    Leaving(double x, double tau, const VectorXd& k) : sum(k.size()), difference(k.size()) {
        for (Eigen::Index j = 0; j < k.size(); ++j) {
            const math::DecayIntegrals both = math::decay_integrals(x, k[j] * tau);
            sum[j] = both.near + both.far;
            difference[j] = both.near - both.far;
        }
    }
};

MatrixXd gathered(const MatrixXd& rows, const std::vector<int>& which) {
    MatrixXd result;
    gather_rows(rows, which, result);
    return result;
}

}  // namespace

OrderTangents::OrderTangents(const FrozenStack& frozen, const RequestedDirections& requested,
                             const std::vector<ScaledChange>& changes, bool transmits)
    : frozen_(frozen),
      requested_(requested),
      changes_(changes),
      transmits_(transmits),
      grid_(frozen.grids().top()) {}

bool OrderTangents::can_solve(const FrozenStack& frozen, const ScaledStack& plus,
                              const ScaledStack& minus) {
    const ScaledStack& middle = frozen.scaled();
    const auto is_alike = [&](const ScaledStack& stack) {
        return !stack.boundary && !stack.refracts() && stack.base != BaseKind::mirror &&
               stack.base == middle.base && stack.media.size() == middle.media.size();
    };
    return frozen.options().coat_method == CoatMethod::automatic &&
           frozen.options().half_space_method == HalfSpaceMethod::automatic && is_alike(middle) &&
           is_alike(plus) && is_alike(minus);
}

void OrderTangents::set_medium(std::size_t medium) {
    const ScaledMedium& of = frozen_.scaled().media[medium];
    medium_ = {};
    medium_.one_minus_albedo = of.scaled.one_minus_albedo;
    medium_.lowest_degree = order_;
    const VectorXd all = of.scaled.strengths();
    medium_.strengths = all.tail(std::max<Eigen::Index>(0, all.size() - order_));
}

VectorXd OrderTangents::own_strengths(const ScaledChange& change, std::size_t medium) const {
    const VectorXd& all = change.strengths[medium];
    return all.tail(std::max<Eigen::Index>(0, all.size() - order_));
}

OrderTangents::Kernels OrderTangents::kernels_of(const VectorXd& strengths) const {
    const auto form = [](const auto& degrees, const auto& at_requested, const auto& weights,
                         MatrixXd& kernel, MatrixXd& rows) {
        const MatrixXd weighted = degrees * weights.asDiagonal();
        kernel = weighted * degrees.transpose();
        rows = at_requested * weighted.transpose();
    };
    Kernels kernels;
    form(even_columns(mode_->scaled_nodes), even_columns(mode_->at_requested), even_part(strengths),
         kernels.even, kernels.even_rows);
    form(odd_columns(mode_->scaled_nodes), odd_columns(mode_->at_requested), odd_part(strengths),
         kernels.odd, kernels.odd_rows);
    return kernels;
}

void OrderTangents::keep_eigenmodes() {
    const Eigenmodes& modes = work_.eigenmode_solver.eigenmodes();
    F_ = modes.vectors;
    k_ = modes.rates;
    V_ = modes.odd;
    VF_ = V_ * F_;
    kernels_ = kernels_of(medium_.strengths);
}

OrderTangents::Rotation OrderTangents::rotation_of(const Kernels& change) const {
    return {-VF_.transpose() * change.even * VF_, -F_.transpose() * change.odd * F_};
}

ReflectorTangent OrderTangents::half_space(const VectorXd& strengths) const {
    const Kernels change = kernels_of(strengths);
    const auto [M, N] = rotation_of(change);
    MatrixXd E(M.rows(), M.cols());
    for (Eigen::Index j = 0; j < E.cols(); ++j) {
        for (Eigen::Index i = 0; i < E.rows(); ++i) {
            const double sum = k_[i] + k_[j];
            E(i, j) = sum > 0.0 ? (M(i, j) - k_[i] * N(i, j) * k_[j]) / sum : 0.0;
        }
    }
    const MatrixXd& X = below_.nodes;
    const MatrixXd B = F_.transpose() + F_.transpose() * X;
    ReflectorTangent tangent;
    tangent.nodes = -0.5 * B.transpose() * E * B;

    // r (1 + mu K) = [(E - O) + (E + O) X] / 2, K = M^-1 - [(E + O) + (E - O) X] / 2 = S k S^-1
    // with S = V F + F k, S^-1 = F^T (I + X) / 2.
    const MatrixXd same = kernels_.even_rows + kernels_.odd_rows;
    const MatrixXd opposite = kernels_.even - kernels_.odd;
    const MatrixXd d_same = change.even + change.odd, d_opposite = change.even - change.odd;
    const MatrixXd d_same_rows = change.even_rows + change.odd_rows;
    const MatrixXd T = requested_.mu.asDiagonal() * below_.rows;
    const MatrixXd d_gain = d_same + d_opposite * X + opposite * tangent.nodes;
    MatrixXd G = change.even_rows - change.odd_rows + d_same_rows * X + same * tangent.nodes;
    G += T * d_gain;
    MatrixXd GS = 0.5 * G * (VF_ + F_ * k_.asDiagonal());
    for (Eigen::Index j = 0; j < GS.cols(); ++j)
        GS.col(j).array() /= 1.0 + k_[j] * requested_.mu.array();
    tangent.rows = 0.5 * GS * B;

    // 4 (mu + mu') R = T_o (A_i + T_i B)^T + A_o T_i^T.
    const MatrixXd dT = requested_.mu.asDiagonal() * tangent.rows;
    const MatrixXd C = same + T * opposite;
    const MatrixXd dC = d_same_rows + dT * opposite + T * d_opposite;
    const std::vector<int>&out = requested_.out, &in = requested_.in;
    tangent.multiple = gathered(dT, out) * gathered(C, in).transpose() +
                       gathered(T, out) * gathered(dC, in).transpose() +
                       gathered(d_same_rows, out) * gathered(T, in).transpose() +
                       gathered(same, out) * gathered(dT, in).transpose();
    divide_by_cosines(requested_, tangent.multiple);
    return tangent;
}

OrderTangents::Interface OrderTangents::interface_of(const Reflector& base) const {
    const Eigen::Index n = grid_.size();
    const Eigen::PartialPivLU<MatrixXd> bounces(MatrixXd::Identity(n, n) -
                                                layer_.reflection * base.nodes);
    Interface light;
    light.node_down = bounces.solve(layer_.transmission);
    light.node_up = base.nodes * light.node_down;
    const MatrixXd beam = base.rows.transpose() * layer_.direct.asDiagonal();
    light.down =
        bounces.solve(MatrixXd(layer_.transmission_rows.transpose() + layer_.reflection * beam));
    light.up = beam + base.nodes * light.down;
    if (!base.has_transmittance) return light;
    light.ground_down = bounces.solve(VectorXd(layer_.reflection * base.transmittance_at_nodes));
    light.ground_up = base.transmittance_at_nodes + base.nodes * light.ground_down;
    return light;
}

ReflectorTangent OrderTangents::layer(const VectorXd& strengths, double depth,
                                      const ReflectorTangent& base, const Interface& light,
                                      const Reflector& below, double tau) const {
    const Eigen::Index n = grid_.size(), cosines = requested_.mu.size();
    const std::vector<int>&out = requested_.out, &in = requested_.in;
    MatrixXd dX = MatrixXd::Zero(n, n), dT = dX;
    MatrixXd d_rows = MatrixXd::Zero(cosines, n), d_through = d_rows;
    MatrixXd d_multiple = MatrixXd::Zero(Eigen::Index(out.size()), Eigen::Index(in.size()));
    VectorXd d_direct = VectorXd::Zero(cosines);
    const bool is_own =
        depth != 0.0 || (strengths.size() > 0 && strengths.cwiseAbs().maxCoeff() > 0);
    if (is_own) {
        const Kernels change = kernels_of(strengths);
        const auto [M, N] = rotation_of(change);
        const VectorXd lambda = k_.cwiseAbs2();
        const Impedances h(k_, tau);
        MatrixXd Ep = rotated(M, N, lambda, h.tanh), Em = rotated(M, N, lambda, h.coth);
        Ep.diagonal() += depth * h.tanh_by_tau;
        Em.diagonal() += depth * h.coth_by_tau;
        const MatrixXd P = F_.transpose() * layer_.alike, Q = F_.transpose() * layer_.opposite;
        const MatrixXd d_alike = -P.transpose() * Ep * P, d_opposite = -Q.transpose() * Em * Q;
        dX = d_alike + d_opposite;
        dT = d_alike - d_opposite;

        // Rows of light from both sides alike, [e V Z_sum - o Z_(difference k tanh)] alike / 2, and
        // with opposite signs, [e V Z_difference - o Z_(sum k coth)] opposite / 2.
        const MatrixXd eVF = kernels_.even_rows * VF_, oF = kernels_.odd_rows * F_;
        const MatrixXd d_eVF = change.even_rows * VF_ - kernels_.even_rows * change.odd * F_;
        const MatrixXd d_oF = change.odd_rows * F_;
        // Where lambda is 0 the step is upwards, in units in which integrals change.
        const VectorXd delta = kLambdaStep * lambda.cwiseMax(1e-2 / (tau * tau));
        const VectorXd above = (lambda + delta).cwiseSqrt(),
                       under = (lambda - delta).cwiseMax(0.0).cwiseSqrt();
        const VectorXd step = above.cwiseAbs2() - under.cwiseAbs2();
        const double later = tau * (1 + kLambdaStep), earlier = tau * (1 - kLambdaStep);
        MatrixXd alike(cosines, k_.size()), apart = alike, d_a = alike, d_o = alike;
        for (Eigen::Index r = 0; r < cosines; ++r) {
            const double mu = requested_.mu[r], x = tau / mu;
            const Leaving at(x, tau, k_), up(x, tau, above), down(x, tau, under);
            const auto slope = [&](const VectorXd& a, const VectorXd& b) -> VectorXd {
                return (a - b).cwiseQuotient(step);
            };
            const Spectrum sum{at.sum, slope(up.sum, down.sum)};
            const Spectrum difference{at.difference, slope(up.difference, down.difference)};
            const auto times = [](const VectorXd& a, const VectorXd& b) -> VectorXd {
                return a.cwiseProduct(b);
            };
            const Spectrum tanh{
                times(at.difference, h.tanh.h),
                times(difference.slope, h.tanh.h) + times(at.difference, h.tanh.slope)};
            const Spectrum coth{times(at.sum, h.coth.h),
                                times(sum.slope, h.coth.h) + times(at.sum, h.coth.slope)};
            const auto e = eVF.row(r), o = oF.row(r), de = d_eVF.row(r), d_odd = d_oF.row(r);
            alike.row(r) = e.cwiseProduct(sum.h.transpose()) - o.cwiseProduct(tanh.h.transpose());
            apart.row(r) =
                e.cwiseProduct(difference.h.transpose()) - o.cwiseProduct(coth.h.transpose());
            d_a.row(r) = de.cwiseProduct(sum.h.transpose()) -
                         d_odd.cwiseProduct(tanh.h.transpose()) + e * rotated(M, N, lambda, sum) -
                         o * rotated(M, N, lambda, tanh);
            d_o.row(r) = de.cwiseProduct(difference.h.transpose()) -
                         d_odd.cwiseProduct(coth.h.transpose()) +
                         e * rotated(M, N, lambda, difference) - o * rotated(M, N, lambda, coth);
            if (depth == 0.0) continue;
            const Leaving late(later / mu, later, k_), early(earlier / mu, earlier, k_);
            const double share = depth / (2 * kLambdaStep * tau);
            const VectorXd d_sum = share * (late.sum - early.sum);
            const VectorXd d_difference = share * (late.difference - early.difference);
            d_a.row(r) += e.cwiseProduct(d_sum.transpose()) -
                          o.cwiseProduct((times(d_difference, h.tanh.h) +
                                          depth * times(at.difference, h.tanh_by_tau))
                                             .transpose());
            d_o.row(r) +=
                e.cwiseProduct(d_difference.transpose()) -
                o.cwiseProduct(
                    (times(d_sum, h.coth.h) + depth * times(at.sum, h.coth_by_tau)).transpose());
        }
        const MatrixXd rows_alike = 0.5 * (d_a * P + alike * F_.transpose() * d_alike);
        const MatrixXd rows_opposite = 0.5 * (d_o * Q + apart * F_.transpose() * d_opposite);
        d_rows = rows_alike + rows_opposite;
        d_through = rows_alike - rows_opposite;
        d_direct = -depth * layer_.direct.cwiseQuotient(requested_.mu);

        // 4 (mu + mu') R = sum of +-a (phi phi' - psi psi') without the first order: phi = Y + p,
        // psi = direct Y + s.
        const auto moments = [&](const MatrixXd& rows, bool reflected) {
            MatrixXd result = requested_.mu.asDiagonal() * (rows * mode_->scaled_nodes);
            for (Eigen::Index c = 1; reflected && c < result.cols(); c += 2) result.col(c) *= -1;
            return result;
        };
        const MatrixXd& Y = mode_->at_requested;
        const MatrixXd p = moments(layer_.reflection_rows, true), dp = moments(d_rows, true);
        const MatrixXd s = moments(layer_.transmission_rows, false), ds = moments(d_through, false);
        const MatrixXd DY = layer_.direct.asDiagonal() * Y, dDY = d_direct.asDiagonal() * Y;
        const MatrixXd phi = Y + p, psi = DY + s, d_psi = dDY + ds;
        const VectorXd a = alternating(medium_.strengths), da = alternating(strengths);
        const auto product = [&](const MatrixXd& left, const VectorXd& weights,
                                 const MatrixXd& right) -> MatrixXd {
            return gathered(left, out) * weights.asDiagonal() * gathered(right, in).transpose();
        };
        d_multiple = product(p, da, phi) + product(Y, da, p) - product(s, da, psi) -
                     product(DY, da, s) + product(dp, a, phi) + product(phi, a, dp) -
                     product(ds, a, psi) - product(psi, a, ds) - product(dDY, a, s) -
                     product(s, a, dDY);
        divide_by_cosines(requested_, d_multiple);
    }

    ReflectorTangent tangent;
    tangent.nodes = dX + dT * light.node_up + (dT * light.node_up).transpose() +
                    light.node_up.transpose() * dX * light.node_up;
    const VectorXd& direct = layer_.direct;
    tangent.rows = d_rows + d_through * light.node_up + light.up.transpose() * dT +
                   light.up.transpose() * dX * light.node_up +
                   d_direct.asDiagonal() * (below.rows * light.node_down);
    MatrixXd seen = d_through * light.up + d_direct.asDiagonal() * (below.rows * light.down);
    MatrixXd between = light.up.transpose() * dX * light.up;
    MatrixXd beams = MatrixXd::Zero(Eigen::Index(out.size()), Eigen::Index(in.size()));
    if (!base.is_zero()) {
        tangent.nodes += light.node_down.transpose() * base.nodes * light.node_down;
        tangent.rows += light.down.transpose() * base.nodes * light.node_down +
                        direct.asDiagonal() * (base.rows * light.node_down);
        seen += direct.asDiagonal() * (base.rows * light.down);
        between += light.down.transpose() * base.nodes * light.down;
        beams = base.multiple;
    }
    tangent.multiple = d_multiple;
    for (std::size_t i = 0; i < in.size(); ++i) {
        for (std::size_t o = 0; o < out.size(); ++o) {
            const auto row = Eigen::Index(o), column = Eigen::Index(i);
            const int to = out[o], from = in[i];
            tangent.multiple(row, column) +=
                0.5 * (seen(to, from) + seen(from, to) + between(to, from)) +
                direct[to] * direct[from] * beams(row, column) +
                (d_direct[to] * direct[from] + direct[to] * d_direct[from]) *
                    below.multiple(row, column);
        }
    }
    if (!below.has_transmittance) return tangent;
    tangent.transmittance_at_nodes =
        dT * light.ground_up + light.node_up.transpose() * (dX * light.ground_up);
    tangent.transmittance_at_requested =
        d_through * light.ground_up + light.up.transpose() * (dX * light.ground_up) +
        d_direct.cwiseProduct(below.rows * light.ground_down + below.transmittance_at_requested);
    if (base.is_zero()) return tangent;
    tangent.transmittance_at_nodes +=
        light.node_down.transpose() * (base.nodes * light.ground_down);
    tangent.transmittance_at_requested +=
        light.down.transpose() * (base.nodes * light.ground_down) +
        direct.cwiseProduct(base.rows * light.ground_down);
    if (base.transmittance_at_nodes.size() == 0) return tangent;
    tangent.transmittance_at_nodes += light.node_down.transpose() * base.transmittance_at_nodes;
    tangent.transmittance_at_requested += light.down.transpose() * base.transmittance_at_nodes +
                                          direct.cwiseProduct(base.transmittance_at_requested);
    return tangent;
}

bool OrderTangents::solve(int fourier_order) {
    const ScaledStack& stack = frozen_.scaled();
    order_ = fourier_order;
    mode_ = &tables_.find(fourier_order, stack.moments, grid_, requested_);
    tangents_.assign(changes_.size(), {});
    std::size_t first = 0;
    if (stack.base == BaseKind::half_space) {
        set_medium(0);
        solve_half_space(HalfSpaceMethod::automatic, medium_, *mode_, grid_, requested_, 0.0, work_,
                         below_);
        if (!below_.physical) return false;
        // Where few sweeps were enough there are none yet.
        if (!work_.eigenmode_solver.find(*mode_, medium_, grid_, 0.0).physical) return false;
        keep_eigenmodes();
        for (std::size_t c = 0; c < changes_.size(); ++c) {
            const VectorXd own = own_strengths(changes_[c], 0);
            if (own.size() > 0 && own.cwiseAbs().maxCoeff() > 0.0) tangents_[c] = half_space(own);
        }
        first = 1;
    } else {
        const auto ground = [&](double albedo, Reflector& result) {
            lambertian_ground(albedo, *mode_, grid_, requested_, result);
        };
        ground(stack.base == BaseKind::lambertian ? stack.ground_albedo : 0.0, below_);
        below_.has_transmittance = transmits_ && fourier_order == 0;
        below_.transmittance_at_nodes = flux_weights(grid_);
        below_.transmittance_at_requested.setOnes(requested_.mu.size());
        Reflector white;
        ground(1.0, white);
        for (std::size_t c = 0; c < changes_.size(); ++c) {
            const double change = changes_[c].ground_albedo;
            if (change == 0.0 || fourier_order > 0) continue;
            tangents_[c].nodes = change * white.nodes;
            tangents_[c].rows = change * white.rows;
            tangents_[c].multiple = change * white.multiple;
        }
    }
    for (std::size_t medium = first; medium < stack.media.size(); ++medium) {
        const double tau = stack.media[medium].scaled_optical_depth;
        set_medium(medium);
        solve_layer(tau, medium_, *mode_, grid_, requested_, ReflectorParts::nodes, 0.0, work_,
                    layer_);
        if (!layer_.physical) return false;
        keep_eigenmodes();
        const Interface light = interface_of(below_);
        for (std::size_t c = 0; c < changes_.size(); ++c) {
            const VectorXd own = own_strengths(changes_[c], medium);
            const double depth = changes_[c].depths[medium];
            const bool is_own = depth != 0.0 || (own.size() > 0 && own.cwiseAbs().maxCoeff() > 0.0);
            if (!is_own && tangents_[c].is_zero()) continue;
            tangents_[c] = layer(own, depth, tangents_[c], light, below_, tau);
        }
        put_on(layer_, below_, requested_, ReflectorParts::nodes, {}, work_, above_);
        if (!above_.physical) return false;
        std::swap(below_, above_);
    }
    return true;
}

}  // namespace miebrdf::rte
