#include "rte/stack/stack_side_by_side.h"

#include <algorithm>
#include <cstddef>

#include "rte/fourier/fourier_mode.h"
#include "rte/half_space/pairs_side_by_side.h"
#include "rte/math/matrices_side_by_side.h"
#include "rte/stack/hidden_layers.h"
#include "rte/stack/stack_solver.h"

namespace miebrdf::rte {

bool StackSideBySide::knows(int fourier_order, const Question& question) const {
    const int which = fourier_order - first_;
    return kernels_ == &question.kernels && which >= 0 && which < count_ &&
           has_arrived_[std::size_t(which)];
}

bool StackSideBySide::find(int fourier_order, const Question& question, Reflector& result) {
    if (!knows(fourier_order, question) && !solve(fourier_order, question)) return false;
    result.multiple = multiple_[std::size_t(fourier_order - first_)];
    result.specular.resize(0);
    result.has_glow = false;
    result.iterations = 0;
    result.residual = 0.0;
    result.converged = result.physical = true;
    if (question.wants_nodes) {
        const Eigen::Index n = question.grid.size(), lanes = lanes_;
        const Eigen::VectorXd& mu = question.requested.mu;
        const auto of_order = [&](const double* lane, Eigen::Index rows, Eigen::MatrixXd& matrix) {
            matrix.resize(rows, n);
            lane += fourier_order - first_;
            for (Eigen::Index k = 0; k < matrix.size(); ++k) matrix.data()[k] = lane[k * lanes];
        };
        of_order(nodes_, n, result.nodes);
        of_order(moved_rows_, mu.size(), result.rows);
        for (Eigen::Index q = 0; q < n; ++q) result.rows.col(q).array() /= mu.array();
        return true;
    }
    if (fourier_order > 0) return true;
    result.sky_at_nodes = sky_at_nodes_;
    result.sky_at_requested = sky_at_requested_;
    return true;
}

ProblemSideBySide StackSideBySide::problem_of(std::size_t medium, const Question& question) {
    const ScaledOptics& scaled = question.stack.media[medium].scaled;
    strengths_.setZero(question.stack.moments);
    const Eigen::VectorXd strengths = scaled.strengths();
    const Eigen::Index count = std::min(strengths_.size(), strengths.size());
    strengths_.head(count) = strengths.head(count);
    return {.strengths = strengths_,
            .one_minus_albedo = scaled.one_minus_albedo,
            .brightness = question.brightness[medium],
            .grid = question.grid,
            .requested = question.requested,
            .tolerance = question.tolerance,
            .orders = question.orders,
            .kernels = question.kernels,
            .modes = question.modes};
}

#ifdef MIEBRDF_HAS_FOUR_DOUBLES

namespace {

bool has_coats(const ScaledStack& stack) {
    return stack.media.size() > (stack.base == BaseKind::half_space ? 1U : 0U);
}

bool fits(int fourier_order, const StackSideBySide::Question& question) {
    const RequestedDirections& requested = question.requested;
    const auto cosines =
        std::max({std::size_t(requested.mu.size()), requested.out.size(), requested.in.size()});
    const bool is_alone = !has_coats(question.stack) && !question.wants_nodes;
    constexpr int most_below_others = 32;  // more gain nothing
    const int most_nodes = HalfSpacesSideBySide::most_nodes();
    if (question.grid.size() > (is_alone ? most_nodes : std::min(most_nodes, most_below_others)) ||
        cosines > HalfSpacesSideBySide::kMostCosines) {
        return false;
    }
    if (question.stack.media.empty()) return false;
    if (fourier_order == 0 && only_fourier_order_zero(requested)) return false;
    // The more nodes, the more orders it takes to gain, but fewer for a half-space alone.
    const int nodes_per_order = is_alone ? 13 : 5;
    return nodes_per_order * question.orders > question.grid.size();
}

// Of the media that are solved: the highest coat that counts as a half-space (orders above `first`
// are scattered less), else the base, else one past the end.
std::size_t lowest_visible(int first, const StackSideBySide::Question& question) {
    const std::vector<ScaledMedium>& media = question.stack.media;
    const std::size_t first_coat = question.stack.base == BaseKind::half_space ? 1 : 0;
    const double allowed = question.tolerance * std::min(question.stack.brightness, 1.0);
    FourierMedium medium;
    medium.lowest_degree = first;
    for (std::size_t c = media.size(); c-- > first_coat;) {
        const Eigen::VectorXd strengths = media[c].scaled.strengths();
        medium.strengths = strengths.tail(std::max<Eigen::Index>(strengths.size() - first, 0));
        if (hides_in_fourier_order(medium, media[c].scaled_optical_depth, allowed)) return c;
    }
    return first_coat == 1 ? 0 : media.size();
}

}  // namespace

// White or grey in order 0, and black in all others.
template <typename Doubles>
ReflectorSideBySide<Doubles> StackSideBySide::ground(int first, const Question& question) {
    if (first > 0 || question.stack.base != BaseKind::lambertian) return {};
    const FourierMode& mode =
        question.modes.find(0, question.stack.moments, question.grid, question.requested);
    lambertian_ground(question.stack.ground_albedo, mode, question.grid, question.requested,
                      ground_);
    constexpr Eigen::Index lanes = math::kLanes<Doubles>;
    const Eigen::Index nodes = ground_.nodes.size(), rows = ground_.rows.size();
    ground_memory_.setZero((nodes + rows + ground_.multiple.size()) * lanes);
    const auto put = [&](Eigen::Index begin, const Eigen::MatrixXd& matrix) {
        double* to = ground_memory_.data() + begin * lanes;
        for (Eigen::Index k = 0; k < matrix.size(); ++k) to[k * lanes] = matrix.data()[k];
        return reinterpret_cast<Doubles*>(to);
    };
    const auto& mu = question.requested.mu;
    return {put(0, ground_.nodes), put(nodes, mu.asDiagonal() * ground_.rows),
            put(nodes + rows, ground_.multiple)};
}

template <typename Doubles>
void StackSideBySide::reflect_sky(const ReflectorSideBySide<Doubles>& half_space,
                                  const Question& question) {
    const Eigen::VectorXd& sky = question.sky;
    const Eigen::VectorXd& mu = question.requested.mu;
    sky_at_nodes_.setZero(sky.size());
    sky_at_requested_.setZero(mu.size());
    add_first_order(half_space.nodes, sky, sky_at_nodes_);
    add_first_order(half_space.moved_rows, sky, sky_at_requested_);
    sky_at_requested_.array() /= mu.array();
}

template <typename Doubles>
bool StackSideBySide::solve_with(int first, const Question& question, std::size_t lowest) {
    constexpr int lanes = math::kLanes<Doubles>;
    const std::vector<ScaledMedium>& media = question.stack.media;
    has_arrived_.fill(true);
    ReflectorSideBySide<Doubles> below = ground<Doubles>(first, question);
    std::size_t coat = 0;
    if (lowest < media.size()) {
        if (!half_space_.solve(first, problem_of(lowest, question))) return false;
        for (int k = 0; k < lanes; ++k)
            has_arrived_[std::size_t(k)] = half_space_.multiple(first + k) != nullptr;
        if (first == 0) question.brightness[lowest] = half_space_.brightness();
        below = half_space_.reflector<Doubles>();
        coat = lowest + 1;
    }
    const bool has_sky = first == 0 && !question.wants_nodes;
    if (has_sky && coat == media.size()) reflect_sky(below, question);
    for (; coat < media.size(); ++coat) {
        const bool is_top = coat + 1 == media.size();
        const auto* base = below.nodes != nullptr ? &below : nullptr;
        if (!layers_.put_on(first, problem_of(coat, question), media[coat].scaled_optical_depth,
                            base, is_top && !question.wants_nodes)) {
            return false;
        }
        if (is_top && has_sky)
            layers_.reflect_sky(question.sky, base, sky_at_nodes_, sky_at_requested_);
        below = layers_.reflector<Doubles>();
        for (int k = 0; k < lanes; ++k) {
            const auto order = std::size_t(k);
            has_arrived_[order] = has_arrived_[order] && layers_.physical()[order];
        }
    }
    first_ = first;
    kernels_ = &question.kernels;
    lanes_ = lanes;
    nodes_ = reinterpret_cast<const double*>(below.nodes);
    moved_rows_ = reinterpret_cast<const double*>(below.moved_rows);
    count_ = std::min(lanes, question.stack.moments - first);
    const auto out = Eigen::Index(question.requested.out.size());
    const auto in = Eigen::Index(question.requested.in.size());
    for (int k = 0; k < count_; ++k) {
        const auto order = std::size_t(k);
        multiple_[order].resize(out, in);
        for (Eigen::Index p = 0; p < out * in; ++p) multiple_[order].data()[p] = below.pairs[p][k];
        has_arrived_[order] = has_arrived_[order] && multiple_[order].allFinite();
    }
    return has_arrived_[0];
}

bool StackSideBySide::solve(int first, const Question& question) {
    count_ = 0;
    if (!fits(first, question)) return false;
    const std::size_t lowest = lowest_visible(first, question);
#ifdef MIEBRDF_HAS_EIGHT_DOUBLES
    constexpr int eight = math::kLanes<math::EightDoubles>;
    if (HalfSpacesSideBySide::lanes_of(question.orders) == eight)
        return solve_with<math::EightDoubles>(first, question, lowest);
#endif
    return solve_with<math::FourDoubles>(first, question, lowest);
}

#else

bool StackSideBySide::solve(int, const Question&) { return false; }

#endif

}  // namespace miebrdf::rte
