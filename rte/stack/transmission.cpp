#include "rte/stack/transmission.h"

#include <Eigen/LU>
#include <algorithm>
#include <cmath>
#include <limits>

#include "rte/first_order/beams.h"
#include "rte/first_order/ways.h"
#include "rte/grid/discretisation.h"
#include "rte/math/tolerance_budget.h"
#include "rte/stack/fourier_sum.h"
#include "rte/stack/stack_solver.h"

namespace miebrdf::rte {
namespace {

Stack turned_over(Stack stack) {
    std::reverse(stack.coats.begin(), stack.coats.end());
    return stack;
}

/// The media of depth > 0, from the bottom up.
std::vector<std::size_t> scattering_media(const ScaledStack& stack) {
    std::vector<std::size_t> list;
    for (std::size_t k = 0; k < stack.media.size(); ++k) {
        if (stack.media[k].scaled_optical_depth > 0.0) list.push_back(k);
    }
    return list;
}

/// Upward light of one Fourier order on top of the layers solved so far, for a beam from below in
/// each requested direction (column): `at_nodes_` = U = 2 D T, `pairs_` = T between requested
/// cosines, `beam_` = the unscattered share of the beam.
class Emission final : public StackFollower {
  public:
    void follow(const StackStep& step) override {
        if (step.kind == StackStep::Kind::ground) start(step);
        if (step.kind == StackStep::Kind::layer) pass_layer(step);
        if (step.kind == StackStep::Kind::boundary) pass_boundary(step);
    }
    /// T between requested cosines: row = cosine above, column = cosine below.
    const Eigen::MatrixXd& pairs() const { return pairs_; }

  private:
    void start(const StackStep& step) {
        const auto count = Eigen::Index(step.requested->in.size());
        beam_.setOnes(count);
        if (step.result->specular.size() > 0) beam_ -= step.result->specular.head(count);
        at_nodes_.setZero(step.grid->size(), count);
        pairs_.setZero(count, count);
    }

    // up = U + X down, down = X_c up + light of the beams that the layer scatters back.
    void pass_layer(const StackStep& step) {
        const LayerOperator& layer = *step.layer;
        const Reflector& below = *step.below;
        const Eigen::Index count = beam_.size();
        const auto reflected = layer.reflection_rows.topRows(count);
        const auto passed = layer.transmission_rows.topRows(count);
        const auto direct = layer.direct.head(count);
        const Eigen::MatrixXd& X = below.nodes;
        Eigen::MatrixXd bounces = -layer.reflection * X;
        bounces.diagonal().array() += 1.0;
        const Eigen::MatrixXd down = bounces.partialPivLu().solve(
            layer.reflection * at_nodes_ + reflected.transpose() * beam_.asDiagonal());
        const Eigen::MatrixXd up = at_nodes_ + X * down;

        pairs_ = direct.asDiagonal() * pairs_;
        pairs_ += layer.transmitted_multiple * beam_.asDiagonal() + 0.5 * (passed * up);
        pairs_ += 0.5 * (direct.asDiagonal() * (below.rows.topRows(count) * down));
        if (below.specular.size() >
            0) {  // a mirror below reflects light that the layer has scattered
            const Eigen::VectorXd returned = direct.cwiseProduct(below.specular.head(count));
            pairs_ += returned.asDiagonal() *
                      (layer.multiple * beam_.asDiagonal() + 0.5 * (reflected * up));
        }
        at_nodes_ = 2.0 * layer.alike * (layer.coupling * (layer.opposite * up));
        at_nodes_ += passed.transpose() * beam_.asDiagonal();
        beam_ = beam_.cwiseProduct(direct).eval();
    }

    // Beams and diffuse light are reflected between the boundary and the layers below it.
    void pass_boundary(const StackStep& step) {
        const SmoothBoundary& boundary = *step.boundary;
        const Reflector& below = *step.below;
        const Eigen::Index count = beam_.size();
        const Eigen::MatrixXd& X = below.nodes;
        const double n = boundary.index_above / boundary.index_below;
        const Eigen::ArrayXd r = boundary.at_requested.head(count);
        Eigen::ArrayXd returned = Eigen::ArrayXd::Zero(count);
        if (below.specular.size() > 0) returned = below.specular.head(count).array();
        const Eigen::ArrayXd often = 1.0 / (1.0 - r * returned);
        const Eigen::VectorXd sent_back = r * beam_.array() * often;
        const Eigen::VectorXd leaves = boundary.passes_at_requested.head(count).array() * often;

        Eigen::VectorXd at_boundary = boundary.at_nodes;
        leave_out_unreachable(X, at_boundary);
        Eigen::MatrixXd bounces = -X * at_boundary.asDiagonal();
        bounces.diagonal().array() += 1.0;
        const auto rows = below.rows.topRows(count);
        const Eigen::MatrixXd up =
            bounces.partialPivLu().solve(at_nodes_ + rows.transpose() * sent_back.asDiagonal());
        const Eigen::MatrixXd down = at_boundary.asDiagonal() * up;
        pairs_ += below.multiple * sent_back.asDiagonal() + 0.5 * (rows * down);
        pairs_ = (n * n * leaves).asDiagonal() * pairs_;
        beam_ = beam_.cwiseProduct(leaves).eval();
        const Eigen::Index common = std::min(X.rows(), boundary.nodes_above);
        at_nodes_.setZero(boundary.nodes_above, count);
        at_nodes_.bottomRows(common) =
            (n * boundary.passes_at_nodes.tail(common)).asDiagonal() * up.bottomRows(common);
    }

    Eigen::VectorXd beam_;
    Eigen::MatrixXd at_nodes_, pairs_;
};

}  // namespace

const char* why_not_transmitted(const Stack& stack) {
    const bool is_film = stack.boundary
                             ? stack.base_kind == BaseKind::mirror && stack.mirror_index == 1.0
                             : stack.base_kind == BaseKind::none;
    if (lowest_kind(stack) == BaseKind::half_space)
        return "an infinitely deep layer lets nothing pass";
    if (!is_film)
        return stack.boundary ? "what passes a film with a boundary is known in air alone, with "
                                "substrate none"
                              : "with a ground or metal below there is no far side; substrate none "
                                "and black have one";
    if (stack.coats.empty()) return "there is no layer to pass";
    if (stack.boundary && stack.boundary->is_rough())
        return "below a rough boundary light is followed between nodes alone, which know no "
               "direction on the far side; plane and spherical transmittances are computed";
    return "";
}

TransmittedOrders tabulate_transmission(const Stack& stack, const std::vector<double>& mu,
                                        const SolverReport& solved, const SolverOptions& options) {
    TransmittedOrders film;
    scale_stack(stack, solved.moments, options.delta_m, film.stack);
    scale_stack(turned_over(stack), solved.moments, options.delta_m, film.upside_down);
    film.stack.transmits = true;
    const StackGrids grids(film.stack, choose_discretisation(stack, options, solved.streams).grid,
                           solved.streams);
    const RequestedDirections requested = with_cosines_beside(collect(mu, mu));
    StackMemory memory;
    StackSolver solver(film.stack, grids, requested, 1, options, memory);
    Emission emission;
    solver.let_follow(emission);
    const double tolerance = kFourierTailShare * options.tolerance;
    FourierTail tail(tolerance);
    FourierSizes sizes;
    const int highest = count_of_fourier_orders(requested, solver.fourier_orders(), {});
    for (int m = 0; m < highest; ++m) {
        const StackOrder& order = solver.solve(m);
        film.physical = order.physical;
        film.converged = film.converged && order.converged;
        if (!film.physical) break;
        if (m == 0) film.plane_transmittance = order.transmittance;
        film.orders.push_back(emission.pairs().transpose());
        if (tail.ends_with(sizes.next(film.orders.back())) && tail.remaining() <= tolerance) break;
    }
    return film;
}

void add_transmitted_once(const TransmittedOrders& film, double mu_in, double mu_out,
                          const std::vector<double>& cos_azimuth, std::vector<double>& values) {
    const std::vector<std::size_t> media = scattering_media(film.stack);
    const std::vector<std::size_t> others = scattering_media(film.upside_down);
    const auto in = beams_of<double>(film.stack, mu_in);
    const auto out = beams_of<double>(film.upside_down, mu_out);
    for (std::size_t k = 0; k < media.size(); ++k) {
        const ScaledMedium& medium = film.stack.media[media[k]];
        const Beam<double>& from = in[media[k]];
        const Beam<double>& to = out[others[media.size() - 1 - k]];
        const ShareWeights share(medium, from.mu, to.mu);
        const double strength = strength_of(medium, medium.exact);
        const double forward = strength * share.forward * (from.down * to.down + from.up * to.up);
        const double back = strength * share.back * (from.down * to.up + from.up * to.down);
        const ScatteringAngles angles(from.mu, to.mu);
        for (std::size_t a = 0; a < values.size(); ++a) {
            if (forward > 0.0)
                values[a] += forward * exact_phase(medium.exact, angles.forward(cos_azimuth[a]));
            if (back > 0.0)
                values[a] += back * exact_phase(medium.exact, angles.back(cos_azimuth[a]));
        }
    }
}

double unscattered_transmittance(const Stack& stack, double mu) {
    const ScaledStack exact = scale_stack(stack, 1, false);
    const ScaledMedium& lowest = exact.media.front();
    const Beam<double> beam = beams_of<double>(exact, mu).front();
    double step = 0.0, bottom = 0.0;
    if (exact.ground_index != lowest.index)
        step = boundary_reflectance(lowest.index, exact.ground_index, beam.mu);
    if (exact.base == BaseKind::mirror)
        bottom = boundary_reflectance(exact.ground_index, exact.mirror_index,
                                      refracted_cosine(exact.ground_index, mu));
    return beam.down * std::exp(-lowest.scaled_optical_depth / beam.mu) * (1.0 - step) *
           (1.0 - bottom) / (1.0 - step * bottom);
}

}  // namespace miebrdf::rte
