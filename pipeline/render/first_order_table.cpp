#include "pipeline/render/first_order_table.h"

#include <algorithm>
#include <cmath>

#include "pipeline/render/table_nodes.h"
#include "rte/first_order/narrow_features.h"
#include "rte/math/legendre.h"

namespace miebrdf::render {
namespace {

constexpr std::size_t kAngles = 1025;
/// Of 1/mu_in + 1/mu_out; what is narrow is lost at steeper slants than the last (cosines of 1e-3),
/// where it is that of the last.
constexpr std::size_t kSlants = 24;
const double kFirstLogQ = std::log(2.0), kLastLogQ = std::log(2000.0);

double slant_node(std::size_t j) {
    return std::exp(kFirstLogQ + (kLastLogQ - kFirstLogQ) * double(j) / (kSlants - 1));
}

}  // namespace

FirstOrderTable::FirstOrderTable(const std::vector<std::vector<rte::ScaledMedium>>& stacks,
                                 bool exact)
    : stride_(lanes_for(stacks.size()) * kLaneWidth) {
    add_layers(stacks, exact);
    if (exact) add_narrow(stacks);
}

void FirstOrderTable::add_layers(const std::vector<std::vector<rte::ScaledMedium>>& stacks,
                                 bool exact) {
    const std::vector<double> angles = scattering_angle_nodes(kAngles);
    for (const auto& media : stacks) layers_ = std::max(layers_, media.size());
    depth_.resize(layers_ * stride_);  // a layer that is not there at a wavelength has no depth
    phase_.resize(layers_ * kAngles * stride_);
    for (std::size_t w = 0; w < stacks.size(); ++w) {
        for (std::size_t layer = 0; layer < stacks[w].size(); ++layer) {
            const rte::ScaledMedium& medium = stacks[w][stacks[w].size() - 1 - layer];
            depth_[layer * stride_ + w] = float(medium.scaled_optical_depth);
            for (std::size_t a = 0; a < kAngles; ++a) {
                phase_[(layer * kAngles + a) * stride_ + w] =
                    float(rte::first_order_strength(medium, exact, std::cos(angles[a])));
            }
        }
    }
}

void FirstOrderTable::add_narrow(const std::vector<std::vector<rte::ScaledMedium>>& stacks) {
    // Column node * stride + w; row = degree.
    const std::size_t nodes = layers_ > 1 ? kSlants : 1;
    Eigen::MatrixXd strengths;
    const std::vector<rte::NarrowStrengths> of_stacks(stacks.begin(), stacks.end());
    for (std::size_t node = 0; node < nodes; ++node) {
        for (std::size_t w = 0; w < stacks.size(); ++w) {
            const Eigen::VectorXd of_degree = of_stacks[w].of_all(slant_node(node));
            const Eigen::Index degrees = of_degree.size();
            if (degrees == 0) continue;
            if (strengths.rows() < degrees) {
                const Eigen::Index old = strengths.rows();
                strengths.conservativeResize(degrees, Eigen::Index(nodes * stride_));
                strengths.bottomRows(degrees - old).setZero();
            }
            strengths.col(Eigen::Index(node * stride_ + w)).head(degrees) = of_degree;
        }
    }
    if (strengths.rows() == 0) return;
    narrow_nodes_ = nodes;
    narrow_.resize(nodes * kAngles * stride_);
    constexpr std::size_t kBlock = 64;  // angles at a time: their polynomials take a few MB
    const std::vector<double> angles = scattering_angle_nodes(kAngles);
    Eigen::MatrixXd polynomials;
    for (std::size_t first = 0; first < kAngles; first += kBlock) {
        const std::size_t count = std::min(kBlock, kAngles - first);
        Eigen::VectorXd cosines(static_cast<Eigen::Index>(count));
        for (std::size_t a = 0; a < count; ++a)
            cosines[Eigen::Index(a)] = std::cos(angles[first + a]);
        math::legendre_functions(0, int(strengths.rows()), cosines, polynomials);
        const Eigen::MatrixXd sums = polynomials * strengths;
        for (std::size_t node = 0; node < nodes; ++node) {
            for (std::size_t a = 0; a < count; ++a) {
                Eigen::Map<Eigen::RowVectorXf>(&narrow_[((first + a) * nodes + node) * stride_],
                                               Eigen::Index(stride_)) =
                    sums.row(Eigen::Index(a))
                        .segment(Eigen::Index(node * stride_), Eigen::Index(stride_))
                        .cast<float>();
            }
        }
    }
}

FirstOrderTable::Place FirstOrderTable::place(double mu_in, double mu_out,
                                              double cos_azimuth) const {
    const double q = 1.0 / mu_in + 1.0 / mu_out;
    Place place;
    place.angle =
        scattering_angle_taps(rte::cos_scattering_angle(mu_in, mu_out, cos_azimuth), kAngles);
    if (narrow_nodes_ > 1) {
        place.log_q = uniform_taps(
            (std::log(q) - kFirstLogQ) / (kLastLogQ - kFirstLogQ) * (kSlants - 1), kSlants);
    }
    place.q = float(q);
    place.shape = float(1.0 / (4.0 * (mu_in + mu_out)));
    return place;
}

/// The angles outside: neighbours in log q lie side by side.
Lane FirstOrderTable::narrow(const Place& place, std::size_t lane) const {
    const std::size_t columns = narrow_nodes_ * stride_;
    const float* values = &narrow_[place.log_q.first * stride_ + lane * kLaneWidth];
    if (narrow_nodes_ == 1) return interpolate(values, columns, place.angle);
    Lane sum = Lane::Zero();
    for (std::size_t k = 0; k < 4; ++k) {
        sum +=
            place.angle.weight[k] * interpolate(values + (place.angle.first + k) * columns, stride_,
                                                {.first = 0, .weight = place.log_q.weight});
    }
    return sum;
}

Lane FirstOrderTable::reflection(const Place& place, std::size_t lane) const {
    Lane sum = Lane::Zero();
    Lane above = Lane::Ones();  // what is left of the light on its way through upper layers
    for (std::size_t layer = 0; layer < layers_; ++layer) {
        const Lane left = (-place.q * lane_at(row(depth_, layer, lane))).exp();
        const float* phase = row(phase_, layer * kAngles, lane);
        sum += above * interpolate(phase, stride_, place.angle) * (1.0F - left);
        above *= left;
    }
    if (narrow_nodes_ > 0) sum += narrow(place, lane);
    return place.shape * sum;
}

}  // namespace miebrdf::render
