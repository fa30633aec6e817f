#include "rte/derivatives/order_tangents.h"

#include <Eigen/LU>
#include <algorithm>
#include <array>
#include <utility>

#include "rte/boundary/rough_top.h"

namespace miebrdf::rte {

using Eigen::Index;
using Eigen::MatrixXd;
using Eigen::VectorXd;

namespace {

MatrixXd identity_minus(const MatrixXd& product) {
    MatrixXd result = -product;
    result.diagonal().array() += 1.0;
    return result;
}

// What passes a smooth boundary of a beam, all its returns from below added up, and how much that
// changes with the share that comes back from below.
struct Passed {
    VectorXd share, by_returned;

    Passed(const SmoothBoundary& boundary, const VectorXd& returned)
        : share(boundary.passes_at_requested) {
        const auto r = boundary.at_requested.array();
        if (returned.size() > 0) share.array() /= 1.0 - r * returned.array();
        by_returned = share.array() * r;
        if (returned.size() > 0) by_returned.array() /= 1.0 - r * returned.array();
    }
};

bool is_nonzero(const VectorXd& list) {
    return list.size() > 0 && list.cwiseAbs().maxCoeff() > 0.0;
}

}  // namespace

OrderTangents::OrderTangents(const FrozenStack& frozen, const RequestedDirections& requested,
                             const std::vector<ScaledChange>& changes, int components,
                             bool transmits)
    : frozen_(frozen),
      asked_(requested),
      changes_(changes),
      components_(components),
      stack_(frozen.scaled()),
      solver_((stack_.transmits = transmits, stack_), frozen.grids(), requested, components,
              frozen.options(), memory_) {
    solver_.let_follow(*this);
}

bool OrderTangents::can_solve(const FrozenStack& frozen, const ScaledStack& plus,
                              const ScaledStack& minus, int components) {
    const ScaledStack& middle = frozen.scaled();
    const auto has_b2 = [](const ScaledStack& stack) {
        return std::any_of(stack.media.begin(), stack.media.end(), [](const ScaledMedium& medium) {
            return matrix_strengths(medium).has_b2();
        });
    };
    const auto is_alike = [&](const ScaledStack& stack) {
        if (stack.base != middle.base || stack.ground != middle.ground ||
            stack.media.size() != middle.media.size() ||
            stack.mirror_index != middle.mirror_index ||
            stack.ground_index != middle.ground_index || stack.top_index != middle.top_index ||
            stack.boundary != middle.boundary)
            return false;
        for (std::size_t k = 0; k < stack.media.size(); ++k) {
            const ScaledMedium &one = stack.media[k], &like = middle.media[k];
            if (one.index != like.index) return false;
            if ((one.scaled_optical_depth == 0.0) != (like.scaled_optical_depth == 0.0))
                return false;
        }
        return components < 4 || !has_b2(stack);
    };
    if (components == 4 && (middle.refracts() || middle.has_mirrors())) return false;
    return frozen.options().coat_method == CoatMethod::automatic &&
           frozen.options().half_space_method == HalfSpaceMethod::automatic && is_alike(middle) &&
           is_alike(plus) && is_alike(minus);
}

bool OrderTangents::solve(int fourier_order) {
    order_ = fourier_order;
    let_in_ = let_out_ = nullptr;
    tangents_.assign(changes_.size(), {});
    for (OrderTangent& tangent : tangents_) {
        tangent.multiple.setZero(Index(asked_.out.size()) * components_,
                                 Index(asked_.in.size()) * components_);
    }
    return solver_.solve(fourier_order).physical;
}

bool OrderTangents::solve_albedos(const VectorXd& let_in, const VectorXd& let_out) {
    order_ = 0;
    let_in_ = &let_in;
    let_out_ = &let_out;
    tangents_.assign(changes_.size(), {});
    return solver_.solve_albedos(let_in, let_out).physical;
}

bool OrderTangents::is_changed(std::size_t medium) const {
    return std::any_of(changes_.begin(), changes_.end(), [&](const ScaledChange& change) {
        return components_ > 1 || change.depths[medium] != 0.0 ||
               is_nonzero(change.strengths[medium]);
    });
}

StrengthChange OrderTangents::strengths_of(const ScaledChange& change, std::size_t medium) const {
    if (components_ == 1) {
        const VectorXd& degrees = change.strengths[medium];
        VectorXd own = VectorXd::Zero(std::max(0, stack_.moments - order_));
        const Index known = std::min(own.size(), degrees.size() - order_);
        if (known > 0) own.head(known) = degrees.segment(order_, known);
        return {std::move(own)};
    }
    StrengthChange both = block_change(order_, stack_.moments, solver_.block(),
                                       matrix_strengths(stack_.media[medium]), change.plus[medium],
                                       change.minus[medium]);
    both.own /= change.apart;
    both.beside /= change.apart;
    return both;
}

void OrderTangents::follow(const StackStep& step) {
    using Kind = StackStep::Kind;
    if (step.kind == Kind::whole) {
        finish_block(step);
        return;
    }
    if (step.kind == Kind::half_space || step.kind == Kind::ground || step.kind == Kind::mirrors) {
        steps_.clear();
        rough_ = nullptr;
        emission_scale_ = 1.0;
    }
    Step& kept = steps_.emplace_back();
    kept.kind = step.kind;
    kept.medium = step.medium;
    if (step.requested != nullptr) kept.mu = step.requested->mu;
    if (step.mode != nullptr) unpolarised_ = step.mode->unpolarised;
    if (step.below != nullptr) {
        kept.below_nodes = step.below->nodes;
        kept.below_rows = step.below->rows;
        kept.below_specular = step.below->specular;
        if (step.below->has_transmittance)
            kept.emission = emission_scale_ * step.below->transmittance_at_nodes;
    }
    switch (step.kind) {
        case Kind::half_space:
            kept.tangents = half_space_tangents(step, is_changed(step.medium));
            return;
        case Kind::ground:
            kept.tangents = half_space_tangents(step, false);
            lambertian_ground(1.0, *step.mode, *step.grid, *step.requested, kept.white);
            if (step.result->has_transmittance)
                ground_transmittance_ = step.result->transmittance_at_requested;
            return;
        case Kind::layer:
            kept.layer = *step.layer;
            kept.tangents = layer_tangents(step, stack_.media[step.medium].scaled_optical_depth,
                                           is_changed(step.medium));
            return;
        case Kind::boundary:
            kept.boundary = *step.boundary;
            emission_scale_ *= step.boundary->index_above / step.boundary->index_below;
            return;
        case Kind::rough_top:
            rough_ = step.rough;
            return;
        case Kind::mirrors:
        case Kind::whole:
            return;
    }
}

void OrderTangents::finish_block(const StackStep& whole) {
    light_from_above();
    for (std::size_t c = 0; c < changes_.size(); ++c) {
        BeamEnds ends;
        const MatrixXd answer = answer_to(changes_[c], ends);
        OrderTangent& tangent = tangents_[c];
        if (let_in_ != nullptr) {
            keep_albedos(*whole.result, changes_[c], answer, ends, tangent);
            continue;
        }
        MatrixXd multiple = 0.5 * answer;
        if (rough_ != nullptr && changes_[c].unscattered.size() > 0) {
            const MatrixXd& at_once = rough_->entering_at_once(order_);
            multiple -= 0.5 / (rough_->index() * rough_->index()) * rows_of(at_once, ports_.left) *
                        changes_[c].unscattered.asDiagonal() *
                        rows_of(at_once, ports_.right).transpose();
        }
        if (components_ == 1) {
            tangent.multiple = std::move(multiple);
        } else {
            solver_.spread_block(multiple, tangent.multiple);
        }
    }
}

// From the top down: what enters each medium.
void OrderTangents::light_from_above() {
    const int rows = int(solver_.block().size());
    const RequestedDirections requested = repeated(asked_, rows);
    cosines_ = rough_ != nullptr ? requested.mu.size() : steps_.front().mu.size();
    const auto first_sky = int(cosines_);
    const bool of_albedos = let_in_ != nullptr;
    lights_ = cosines_;
    ports_ = {requested.out, requested.in, requested.out.size(), requested.in.size()};
    const ZenithGrid& air = frozen_.grids().top();
    PortFields light;
    if (of_albedos) {
        ports_ = {requested.in, {first_sky + 1}, requested.in.size(), 0};
        ports_.left.push_back(first_sky);
        lights_ += 2;
        if (stack_.transmits) ports_.right.push_back(int(lights_++));
    }
    light.top.setZero(air.size() * rows, lights_);
    for (Index q = 0; of_albedos && q < light.top.rows(); ++q) {
        const double share = unpolarised_[std::size_t(q % rows)];
        light.top(q, first_sky) = share * (*let_in_)[q / rows];
        light.top(q, first_sky + 1) = share * (*let_out_)[q / rows];
    }
    if (rough_ == nullptr) light.beam_top.setOnes(cosines_);
    for (std::size_t s = steps_.size(); s-- > 0;) {
        Step& step = steps_[s];
        step.beam = light.beam_top;
        if (step.kind == StackStep::Kind::layer) {
            pass_layer(step, light);
        } else if (step.kind == StackStep::Kind::boundary) {
            pass_boundary(step, light);
        } else if (step.kind == StackStep::Kind::rough_top) {
            pass_rough_top(step, light);
        } else {
            if (step.tangents) step.tangents->light_up(light, ports_);
            at_bottom_ = std::move(light);
        }
    }
}

// What is below answers to beams, and the ground's emission.
MatrixXd OrderTangents::sent_up(const Step& step, const VectorXd& beam) const {
    MatrixXd up = MatrixXd::Zero(step.below_nodes.rows(), lights_);
    if (beam.size() > 0) up.leftCols(cosines_) = step.below_rows.transpose() * beam.asDiagonal();
    if (let_in_ != nullptr && step.emission.size() > 0) up.rightCols(1) = step.emission;
    return up;
}

void OrderTangents::pass_boundary(Step& step, PortFields& light) const {
    const SmoothBoundary& boundary = step.boundary;
    const double n = boundary.index_above / boundary.index_below;
    light.beam_top = n * light.beam_top.cwiseProduct(Passed(boundary, step.below_specular).share);
    VectorXd reflectance = boundary.at_nodes;
    leave_out_unreachable(step.below_nodes, reflectance);
    MatrixXd entering = reflectance.asDiagonal() * sent_up(step, light.beam_top);
    const Index common = std::min(entering.rows(), boundary.nodes_above);
    entering.bottomRows(common) +=
        boundary.passes_at_nodes.tail(common).asDiagonal() * light.top.bottomRows(common);
    light.top =
        identity_minus(reflectance.asDiagonal() * step.below_nodes).partialPivLu().solve(entering);
}

void OrderTangents::pass_layer(Step& step, PortFields& light) {
    const LayerOperator& layer = step.layer;
    const VectorXd beam = layer.direct.cwiseProduct(light.beam_top);
    light.beam_bottom.setZero(beam.size());
    if (step.below_specular.size() > 0) light.beam_bottom = step.below_specular.cwiseProduct(beam);
    const MatrixXd source = sent_up(step, beam);
    MatrixXd down = 2.0 * layer.alike * (layer.coupling * (layer.opposite * light.top));
    down.noalias() += layer.reflection * source;
    if (beam.size() > 0) {
        down.leftCols(cosines_) +=
            layer.transmission_rows.transpose() * light.beam_top.asDiagonal();
        down.leftCols(cosines_) +=
            layer.reflection_rows.transpose() * light.beam_bottom.asDiagonal();
    }
    down = identity_minus(layer.reflection * step.below_nodes).partialPivLu().solve(down).eval();
    light.bottom = source + step.below_nodes * down;
    step.tangents->light_up(light, ports_);
    light = {std::move(down), {}, beam, {}};
}

void OrderTangents::pass_rough_top(const Step& step, PortFields& light) const {
    const double n = rough_->index();
    const MatrixXd& inside = rough_->inside(order_);
    MatrixXd entering = inside * sent_up(step, {});
    entering.leftCols(cosines_) += rough_->entering(order_).transpose() / n;
    if (let_in_ != nullptr) {
        const VectorXd D = flux_weights(frozen_.grids().of(stack_.top_index));
        entering.col(cosines_) += rough_->sky_entering() / (2.0 * n);
        entering.col(cosines_ + 1) += n * (D - inside * D);
    }
    light.top = identity_minus(inside * step.below_nodes).partialPivLu().solve(entering);
}

MatrixXd OrderTangents::answer_to(const ScaledChange& change, BeamEnds& ends) const {
    MatrixXd answer = MatrixXd::Zero(Index(ports_.left.size()), Index(ports_.right.size()));
    for (const Step& step : steps_) {
        if (step.kind == StackStep::Kind::half_space || step.kind == StackStep::Kind::layer)
            step.tangents->add(strengths_of(change, step.medium), change.depths[step.medium],
                               answer);
    }
    const Step& lowest = steps_.front();
    if (lowest.kind == StackStep::Kind::mirrors && change.unscattered.size() > 0) {
        answer += columns_of(at_bottom_.top, ports_.left).transpose() *
                  change.unscattered.asDiagonal() * columns_of(at_bottom_.top, ports_.right);
    }
    if (lowest.kind == StackStep::Kind::ground && change.ground_albedo != 0.0) {
        const Reflector& white = lowest.white;
        const LitSide left(at_bottom_, ports_.left, ports_.left_cosines);
        const LitSide right(at_bottom_, ports_.right, ports_.right_cosines);
        MatrixXd more = left.top.transpose() * white.nodes * right.top;
        add_rows(left.beam_top, right.beam_top, white.rows, left, right, left.top, right.top, 1.0,
                 more);
        if (!left.cosines.empty() && !right.cosines.empty()) {
            more.topLeftCorner(white.multiple.rows(), white.multiple.cols()) +=
                2.0 * left.beam_top.asDiagonal() * white.multiple * right.beam_top.asDiagonal();
        }
        answer += change.ground_albedo * more;
    }
    if (rough_ == nullptr && std::any_of(change.depths.begin(), change.depths.end(),
                                         [](double depth) { return depth != 0.0; }))
        add_changed_beams(change, answer, ends);
    return answer;
}

// Beams that pass weakened layers: upward what mirrors and boundaries return, downward the beams.
void OrderTangents::add_changed_beams(const ScaledChange& change, MatrixXd& answer,
                                      BeamEnds& ends) const {
    std::vector<VectorXd> d_below(steps_.size()), d_direct(steps_.size());
    VectorXd d_returned = VectorXd::Zero(cosines_);
    for (std::size_t s = 0; s < steps_.size(); ++s) {
        const Step& step = steps_[s];
        d_below[s] = d_returned;
        const bool has_mirror = step.below_specular.size() > 0;
        if (step.kind == StackStep::Kind::layer) {
            const VectorXd& direct = step.layer.direct;
            d_direct[s] = -change.depths[step.medium] * direct.cwiseQuotient(step.mu);
            d_returned.array() *= direct.array().square();
            if (has_mirror) {
                d_returned.array() +=
                    2.0 * direct.array() * d_direct[s].array() * step.below_specular.array();
            }
        } else if (step.kind == StackStep::Kind::boundary) {
            const Passed passed(step.boundary, step.below_specular);
            VectorXd by_returned = passed.share;
            if (has_mirror) by_returned += step.below_specular.cwiseProduct(passed.by_returned);
            d_returned.array() *= step.boundary.passes_at_requested.array() * by_returned.array();
        }
    }
    ends.returned = d_returned;
    VectorXd d_beam = VectorXd::Zero(cosines_);
    for (std::size_t s = steps_.size(); s-- > 0;) {
        const Step& step = steps_[s];
        if (step.kind == StackStep::Kind::boundary) {
            const Passed passed(step.boundary, step.below_specular);
            const double n = step.boundary.index_above / step.boundary.index_below;
            d_beam = n * (passed.share.cwiseProduct(d_beam) +
                          passed.by_returned.cwiseProduct(d_below[s]).cwiseProduct(step.beam));
        } else if (step.kind == StackStep::Kind::layer) {
            const VectorXd& direct = step.layer.direct;
            const VectorXd under = direct.cwiseProduct(step.beam);
            const VectorXd d_under =
                d_direct[s].cwiseProduct(step.beam) + direct.cwiseProduct(d_beam);
            BeamChange beams{d_beam, {}};
            if (step.below_specular.size() > 0) {
                beams.bottom =
                    d_below[s].cwiseProduct(under) + step.below_specular.cwiseProduct(d_under);
            }
            step.tangents->add_beams(beams, answer);
            d_beam = d_under;
        } else {
            step.tangents->add_beams({d_beam, {}}, answer);
        }
    }
    ends.at_ground = d_beam;
}

// As StackSolver::keep_albedos.
void OrderTangents::keep_albedos(const Reflector& whole, const ScaledChange& change,
                                 const MatrixXd& answer, const BeamEnds& ends,
                                 OrderTangent& tangent) const {
    const int rows = int(solver_.block().size());
    const bool turns = unpolarised_[1] != 0.0;
    const std::array<double, 2> I{unpolarised_[0], unpolarised_[1]};
    const std::array<double, 2> Q = turns ? std::array{I[0], -I[1]} : std::array{0.0, 1.0};
    const auto along = [&](const std::array<double, 2>& axis, std::size_t i) {
        double sum = 0.0;
        for (int k = 0; k < rows; ++k) {
            const auto row = std::size_t(k);
            sum += axis[row] * answer(Index(i) * rows + k, 0);
            if (ends.returned.size() > 0)
                sum += axis[row] * I[row] * ends.returned[asked_.in[i] * rows + k];
        }
        return sum;
    };
    for (std::size_t i = 0; i < asked_.in.size(); ++i) {
        tangent.plane_albedo.push_back(along(I, i));
        if (rows > 1) tangent.polarised_plane_albedo.push_back(along(Q, i));
    }
    const VectorXd D = flux_weights(frozen_.grids().top());
    const Index sky = answer.rows() - 1;
    const double entering = rough_ != nullptr ? 0.5 : let_in_->dot(D);
    tangent.spherical_albedo = entering > 0.0 ? answer(sky, 0) / entering : 0.0;
    if (!stack_.transmits) return;
    const double absorbed = 1.0 - stack_.ground_albedo;
    const auto add = [&](double slope, double value) {
        tangent.transmittance.push_back(absorbed * slope - change.ground_albedo * value);
    };
    for (std::size_t i = 0; i < asked_.in.size(); ++i) {
        double slope = 0.0, value = 0.0;
        for (int k = 0; k < rows; ++k) {
            const auto row = std::size_t(k);
            const Index place = asked_.in[i] * rows + k;
            slope += I[row] * answer(Index(i) * rows + k, 1);
            if (ends.at_ground.size() > 0)
                slope += I[row] * ends.at_ground[place] * ground_transmittance_[place];
            value += I[row] * whole.transmittance_at_requested[place];
        }
        add(stack_.ground_index * slope, value);
    }
    VectorXd uniform(D.size() * rows);
    for (Index q = 0; q < uniform.size(); ++q)
        uniform[q] = unpolarised_[std::size_t(q % rows)] * D[q / rows];
    add(stack_.ground_index * answer(sky, 1) / (rough_ != nullptr ? 0.5 : uniform.squaredNorm()),
        uniform.dot(whole.transmittance_at_nodes) / uniform.squaredNorm());
}

}  // namespace miebrdf::rte
