#include "rte/fourier/fourier_mode.h"

#include <cmath>

#include "rte/math/legendre.h"

namespace miebrdf::rte {
namespace {

// Behind a refracting surface the nodes' weights add up to 1, and with mu^2 to 1/3, no better than
// the grid integrates a square root: as if media of albedo 1 gained or lost a little at every
// scattering. Where sums are right, rounding is left as it is.
void normalise_lowest(const ZenithGrid& grid, FourierMode& mode) {
    constexpr double rounding = 1e-14;
    for (Eigen::Index l = 0; l < std::min<Eigen::Index>(2, mode.at_nodes.cols()); ++l) {
        const double sum = mode.at_nodes.col(l).cwiseAbs2().dot(grid.weights) * double(2 * l + 1);
        if (std::abs(sum - 1.0) <= rounding) continue;
        mode.at_nodes.col(l) /= std::sqrt(sum);
        mode.at_requested.col(l) /= std::sqrt(sum);
    }
}

void orthogonalise_to_lowest(const ZenithGrid& grid, FourierMode& mode) {
    for (Eigen::Index lowest = 0; lowest < std::min<Eigen::Index>(2, mode.at_nodes.cols());
         ++lowest) {
        Eigen::VectorXd& weighted = mode.node_factors;
        weighted = mode.at_nodes.col(lowest).cwiseProduct(grid.weights);
        const double norm = weighted.dot(mode.at_nodes.col(lowest));
        for (Eigen::Index c = lowest + 2; c < mode.at_nodes.cols(); c += 2) {
            const double overlap = weighted.dot(mode.at_nodes.col(c)) / norm;
            mode.at_nodes.col(c) -= overlap * mode.at_nodes.col(lowest);
            mode.at_requested.col(c) -= overlap * mode.at_requested.col(lowest);
        }
    }
}

// The lowest two of order 0 are polynomials that any grid holds, and energy depends on their last
// digits.
void legendre_functions_at_nodes(int fourier_order, int degrees, const ZenithGrid& grid,
                                 LegendreSampling& sampling, FourierMode& mode) {
    if (points_suffice(grid, degrees)) {
        math::legendre_functions(fourier_order, degrees, grid.mu, mode.at_nodes);
        return;
    }
    const NodeProjection& projection = sampling.projections.find(grid, degrees);
    math::legendre_functions(fourier_order, degrees, projection.fine.mu, sampling.samples);
    mode.at_nodes.resize(grid.size(), sampling.samples.cols());
    mode.at_nodes.noalias() = projection.of_order(fourier_order) * sampling.samples;
    if (fourier_order > 0) return;
    mode.at_nodes.col(0).setOnes();
    if (degrees > 1) mode.at_nodes.col(1) = grid.mu;
}

}  // namespace

void gather_rows(const Eigen::Ref<const Eigen::MatrixXd>& table, const std::vector<int>& which,
                 Eigen::MatrixXd& result) {
    result.resize(Eigen::Index(which.size()), table.cols());
    for (Eigen::Index c = 0; c < table.cols(); ++c) {
        for (std::size_t k = 0; k < which.size(); ++k) {
            result(Eigen::Index(k), c) = table(which[k], c);
        }
    }
}

void make_fourier_mode(int fourier_order, int degrees, const ZenithGrid& grid,
                       const RequestedDirections& requested, LegendreSampling& sampling,
                       FourierMode& mode) {
    mode.fourier_order = fourier_order;
    legendre_functions_at_nodes(fourier_order, degrees, grid, sampling, mode);
    math::legendre_functions(fourier_order, degrees, requested.mu, mode.at_requested);
    if (fourier_order == 0) {
        normalise_lowest(grid, mode);
        orthogonalise_to_lowest(grid, mode);
    }
    mode.node_factors = grid.weights.cwiseQuotient(grid.mu).cwiseSqrt();
    mode.scaled_nodes.resize(mode.at_nodes.rows(), mode.at_nodes.cols());
    mode.scaled_nodes = mode.node_factors.asDiagonal() * mode.at_nodes;
}

bool FourierModes::are_of(int degrees, const ZenithGrid& grid,
                          const RequestedDirections& requested) const {
    const auto alike = [](const Eigen::VectorXd& a, const Eigen::VectorXd& b) {
        return a.size() == b.size() && a == b;
    };
    return degrees_ == degrees && alike(grid_.mu, grid.mu) && alike(grid_.weights, grid.weights) &&
           grid_.panels == grid.panels && alike(requested_, requested.mu);
}

const FourierMode& FourierModes::find(int fourier_order, int degrees, const ZenithGrid& grid,
                                      const RequestedDirections& requested, bool keep) {
    if (!are_of(degrees, grid, requested)) {
        degrees_ = degrees;
        grid_ = grid;
        requested_ = requested.mu;
        for (Known& known : known_) known.is_filled = false;
    }
    // All tables together take at most 2 MB: 28 orders of 32 nodes and 10 cosines.
    constexpr Eigen::Index most = 1 << 18;
    const Eigen::Index size = (2 * grid.size() + requested.mu.size()) * degrees;
    const auto order = std::size_t(fourier_order);
    const bool is_known = order < known_.size() && known_[order].is_filled;
    const bool is_kept = is_known || (keep && Eigen::Index(order + 1) * size <= most);
    if (is_kept && order >= known_.size()) known_.resize(order + 1);
    Known& known = is_kept ? known_[order] : passing_;
    if (!is_known)
        make_fourier_mode(fourier_order, degrees, grid, requested, sampling_, known.mode);
    known.is_filled = is_kept;
    return known.mode;
}

ColumnsOfOneParity even_columns(const Eigen::Ref<const Eigen::MatrixXd>& table) {
    return {table.data(), table.rows(), (table.cols() + 1) / 2,
            Eigen::OuterStride<>(2 * table.rows())};
}

ColumnsOfOneParity odd_columns(const Eigen::Ref<const Eigen::MatrixXd>& table) {
    return {table.data() + (table.cols() > 1 ? table.rows() : 0), table.rows(), table.cols() / 2,
            Eigen::OuterStride<>(2 * table.rows())};
}

ElementsOfOneParity even_part(const Eigen::Ref<const Eigen::VectorXd>& strengths) {
    return {strengths.data(), (strengths.size() + 1) / 2};
}

ElementsOfOneParity odd_part(const Eigen::Ref<const Eigen::VectorXd>& strengths) {
    return {strengths.data() + (strengths.size() > 1 ? 1 : 0), strengths.size() / 2};
}

void alternating(const Eigen::Ref<const Eigen::VectorXd>& strengths, Eigen::VectorXd& result) {
    result = strengths;
    for (Eigen::Index c = 1; c < result.size(); c += 2) result[c] = -result[c];
}

Eigen::VectorXd alternating(const Eigen::Ref<const Eigen::VectorXd>& strengths) {
    Eigen::VectorXd result;
    alternating(strengths, result);
    return result;
}

void PairProducts::gather(const Eigen::Ref<const Eigen::VectorXd>& strengths,
                          const Eigen::Ref<const Eigen::MatrixXd>& extra,
                          const RequestedDirections& requested) {
    gather_rows(extra, requested.out, extra_out_);
    gather_rows(extra, requested.in, extra_in_);
    weighted_.resize(extra_in_.rows(), extra_in_.cols());
    weighted_ = extra_in_ * strengths.asDiagonal();
}

void PairProducts::add(const Eigen::Ref<const Eigen::VectorXd>& strengths,
                       const Eigen::Ref<const Eigen::MatrixXd>& extra,
                       const Eigen::Ref<const Eigen::MatrixXd>& first_out,
                       const Eigen::Ref<const Eigen::MatrixXd>& first_in,
                       const RequestedDirections& requested, Eigen::MatrixXd& sum) {
    gather(strengths, extra, requested);
    sum.noalias() += first_out * weighted_.transpose();
    weighted_ += first_in * strengths.asDiagonal();
    sum.noalias() += extra_out_ * weighted_.transpose();
}

void PairProducts::subtract_below(const Eigen::Ref<const Eigen::VectorXd>& strengths,
                                  const Eigen::Ref<const Eigen::MatrixXd>& extra,
                                  const Eigen::Ref<const Eigen::VectorXd>& direct,
                                  const Eigen::Ref<const Eigen::MatrixXd>& first_out,
                                  const Eigen::Ref<const Eigen::MatrixXd>& first_in,
                                  const RequestedDirections& requested, Eigen::MatrixXd& sum) {
    gather(strengths, extra, requested);
    product_.resize(sum.rows(), sum.cols());
    product_.noalias() = first_out * weighted_.transpose();
    for (Eigen::Index i = 0; i < sum.cols(); ++i) {
        for (Eigen::Index o = 0; o < sum.rows(); ++o) {
            sum(o, i) -= direct[requested.out[std::size_t(o)]] * product_(o, i);
        }
    }
    for (Eigen::Index c = 0; c < weighted_.cols(); ++c) {
        for (Eigen::Index i = 0; i < weighted_.rows(); ++i) {
            weighted_(i, c) += direct[requested.in[std::size_t(i)]] * strengths[c] * first_in(i, c);
        }
    }
    sum.noalias() -= extra_out_ * weighted_.transpose();
}

void divide_by_cosines(const RequestedDirections& requested, Eigen::MatrixXd& reflection) {
    for (Eigen::Index i = 0; i < reflection.cols(); ++i) {
        const double mu_in = requested.mu[requested.in[std::size_t(i)]];
        for (Eigen::Index o = 0; o < reflection.rows(); ++o) {
            reflection(o, i) /= 4.0 * (requested.mu[requested.out[std::size_t(o)]] + mu_in);
        }
    }
}

}  // namespace miebrdf::rte
