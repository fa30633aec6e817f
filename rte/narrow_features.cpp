#include "rte/narrow_features.h"

#include <algorithm>
#include <cmath>
#include <numbers>

namespace miebrdf::rte {
namespace {

constexpr int most_nodes = 48;

double chebyshev_point(int node, int count) {
    return std::cos(std::numbers::pi * (node + 0.5) / count);
}

// Lagrange weights of Chebyshev's points (of the first kind), by the barycentric formula.
Eigen::VectorXd chebyshev_weights(double t, int count) {
    Eigen::VectorXd weights(count);
    for (int j = 0; j < count; ++j) {
        const double distance = t - chebyshev_point(j, count);
        if (distance == 0.0) return Eigen::VectorXd::Unit(count, j);
        weights[j] =
            (j % 2 ? -1.0 : 1.0) * std::sin(std::numbers::pi * (j + 0.5) / count) / distance;
    }
    return weights / weights.sum();
}

// sum_l strengths(j, l) P_l(cos angle): row = angle, column = j. The recurrence is a chain in l, so
// many angles go side by side; the sums are matrix products of blocks of degrees.
Eigen::MatrixXd sum_degrees(const Eigen::MatrixXd& strengths, const Eigen::VectorXd& angles) {
    constexpr int group = 32;
    constexpr int block = 128;
    using Group = Eigen::Array<double, group, 1>;
    Eigen::MatrixXd sums = Eigen::MatrixXd::Zero(angles.size(), strengths.rows());
    Eigen::Matrix<double, group, Eigen::Dynamic> legendre(group, block);
    Eigen::Matrix<double, group, Eigen::Dynamic> sum(group, strengths.rows());
    for (Eigen::Index first = 0; first < angles.size(); first += group) {
        const Eigen::Index count = std::min<Eigen::Index>(group, angles.size() - first);
        Group x = Group::Zero();
        x.head(count) = angles.segment(first, count).array().cos();
        Group before = Group::Zero();
        Group here = Group::Ones();
        sum.setZero();
        for (Eigen::Index start = 0; start < strengths.cols(); start += block) {
            const Eigen::Index degrees = std::min<Eigen::Index>(block, strengths.cols() - start);
            for (Eigen::Index d = 0; d < degrees; ++d) {
                const double l = double(start + d);
                legendre.col(d) = here.matrix();
                const Group next =
                    ((2.0 * l + 1.0) / (l + 1.0)) * x * here - (l / (l + 1.0)) * before;
                before = here;
                here = next;
            }
            sum.noalias() +=
                legendre.leftCols(degrees) * strengths.middleCols(start, degrees).transpose();
        }
        sums.middleRows(first, count) = sum.topRows(count);
    }
    return sums;
}

double log_q_of(double mu_in, double mu_out) { return std::log(1.0 / mu_in + 1.0 / mu_out); }

// Only a finite layer makes strengths depend on q.
bool depends_on_q(const std::vector<ScaledMedium>& media) {
    return std::any_of(media.begin(), media.end(), [](const ScaledMedium& medium) {
        return std::isfinite(medium.optical_depth);
    });
}

Eigen::MatrixXd strengths_at(const std::vector<ScaledMedium>& media, const Eigen::VectorXd& log_q) {
    Eigen::MatrixXd strengths;
    for (Eigen::Index j = 0; j < log_q.size(); ++j) {
        const std::vector<double> at_q = narrow_strengths(media, std::exp(log_q[j]));
        if (j == 0) strengths.resize(log_q.size(), Eigen::Index(at_q.size()));
        if (at_q.empty()) break;  // no degrees: rows of nothing would start behind a null pointer
        strengths.row(j) =
            Eigen::Map<const Eigen::RowVectorXd>(at_q.data(), Eigen::Index(at_q.size()));
    }
    return strengths;
}

// One degree of a medium's phase function.
struct DegreeOfMedium {
    double rest = 0.0;       // N_l
    double peak = 0.0;       // F_l
    double kept_peak = 0.0;  // what the discrete equations have of F_l: all of it below the cutoffs
    double share_kept = 1.0;  // of N_l in the discrete equations
};

DegreeOfMedium degree_of(const ScaledMedium& medium, int l) {
    DegreeOfMedium degree;
    const double f = medium.scaled.truncated;
    const int k = l - medium.narrow.first_degree;
    degree.share_kept = 1.0 - medium.scaled.share_scaled_away(l);
    degree.peak = degree.kept_peak = f;
    if (k < 0 || medium.narrow.peak.empty()) return degree;
    const bool listed = k < int(medium.narrow.peak.size());
    degree.peak = listed ? medium.narrow.peak[std::size_t(k)] : 0.0;
    if (k < int(medium.narrow.rest.size())) degree.rest = medium.narrow.rest[std::size_t(k)];
    if (l < medium.scaled.chi.size()) {
        degree.kept_peak += (1.0 - f) * medium.scaled.chi[l] - degree.share_kept * degree.rest;
    }
    return degree;
}

// The first order's factor of each medium, from the top down: what reaches it of the light, and how
// much of that it can scatter, when a fraction of its scattering counts as none.
class AttenuatedPath {
  public:
    explicit AttenuatedPath(double q) : q_(q) {}

    double scatter(const ScaledMedium& medium, double not_scattered) {
        const double alpha = medium.exact.single_scattering_albedo;
        const double loss = (1.0 - not_scattered) + medium.exact.one_minus_albedo * not_scattered;
        if (loss == medium.scaled.depth_factor || alpha == 0.0) {
            return advance(medium.optical_depth * q_) / medium.scaled.depth_factor;
        }
        return advance(medium.optical_depth * q_ * (loss / medium.scaled.depth_factor)) / loss;
    }

  private:
    double advance(double slant) {
        const double absorbed = above_ * -std::expm1(-slant);
        above_ *= std::exp(-slant);
        return absorbed;
    }

    double q_;
    double above_ = 1.0;
};

// Degrees at the end that sum to less than the tolerance at every angle: |P_l| <= 1.
void drop_tail(Eigen::MatrixXd& strengths, double tolerance) {
    double dropped = 0.0;
    Eigen::Index degrees = strengths.cols();
    while (degrees > 1) {
        dropped += strengths.col(degrees - 1).cwiseAbs().maxCoeff();
        if (!(dropped <= tolerance)) break;
        --degrees;
    }
    strengths.conservativeResize(Eigen::NoChange, degrees);
}

}  // namespace

std::vector<double> narrow_strengths(const std::vector<ScaledMedium>& media, double q) {
    int first = 0;
    int end = 0;
    for (const ScaledMedium& medium : media) {
        if (medium.narrow.rest.empty()) continue;
        first = end == 0 ? medium.narrow.first_degree : std::min(first, medium.narrow.first_degree);
        end = std::max(end, medium.narrow.first_degree + int(medium.narrow.rest.size()));
    }
    std::vector<double> strengths(std::size_t(end), 0.0);
    for (int l = first; l < end; ++l) {
        AttenuatedPath true_peak(q), kept_peak(q), no_peak(q);
        for (auto medium = media.rbegin(); medium != media.rend(); ++medium) {
            const DegreeOfMedium degree = degree_of(*medium, l);
            const double with_true = true_peak.scatter(*medium, degree.peak);
            const double with_kept = kept_peak.scatter(*medium, degree.kept_peak);
            const double without = no_peak.scatter(*medium, medium->scaled.truncated);
            strengths[std::size_t(l)] +=
                (2.0 * l + 1.0) * medium->exact.single_scattering_albedo * degree.rest *
                ((with_true - without) - degree.share_kept * (with_kept - without));
        }
    }
    return strengths;
}

NarrowFeatures::NarrowFeatures(const std::vector<ScaledMedium>& media, double mu_least,
                               double tolerance)
    : tolerance_(tolerance) {
    const double lowest = log_q_of(1.0, 1.0);
    const double highest = log_q_of(mu_least, mu_least);
    log_q_middle_ = 0.5 * (lowest + highest);
    log_q_half_ = std::max(0.5 * (highest - lowest), 1e-3);
    strengths_ = strengths_at_nodes(media, tolerance);
}

void NarrowFeatures::tabulate() {
    if (none()) return;
    const double shortest_wave = 2.0 * std::numbers::pi / double(strengths_.cols());
    table_.emplace([&](const Eigen::VectorXd& angles) { return sum_degrees(strengths_, angles); },
                   0.5 * shortest_wave, tolerance_);
}

Eigen::MatrixXd NarrowFeatures::strengths_at_nodes(const std::vector<ScaledMedium>& media,
                                                   double tolerance) const {
    const auto log_q = [&](double t) { return log_q_middle_ + log_q_half_ * t; };
    for (int count = depends_on_q(media) ? 6 : 1;; count += count / 2) {
        Eigen::VectorXd at_nodes(count);
        for (int j = 0; j < count; ++j) at_nodes[j] = log_q(chebyshev_point(j, count));
        Eigen::MatrixXd strengths = strengths_at(media, at_nodes);
        if (strengths.cols() == 0 || count == 1) return strengths;
        drop_tail(strengths, 0.1 * tolerance);
        // Between the outermost nodes and in the middle: where polynomials through them are worst.
        double error = 0.0;
        for (const double place : {0.0, 1.0, 0.5 * count}) {
            const double t = std::cos(std::numbers::pi * place / count);
            const Eigen::MatrixXd exact =
                strengths_at(media, Eigen::VectorXd::Constant(1, log_q(t)));
            error = std::max(error, (chebyshev_weights(t, count).transpose() * strengths -
                                     exact.leftCols(strengths.cols()))
                                        .cwiseAbs()
                                        .sum());
        }
        if (error <= tolerance || count >= most_nodes) return strengths;
    }
}

Eigen::VectorXd NarrowFeatures::node_weights(double q) const {
    const int count = int(strengths_.rows());
    if (count == 1) return Eigen::VectorXd::Ones(1);
    return chebyshev_weights((std::log(q) - log_q_middle_) / log_q_half_, count);
}

void NarrowFeatures::add_to(double* reflection, std::span<const double> mu_in,
                            std::span<const double> mu_out,
                            std::span<const double> cos_azimuth) const {
    if (none()) return;
    std::vector<double> angles;
    for (const double in : mu_in) {
        for (const double out : mu_out) {
            for (const double cosine : cos_azimuth) {
                angles.push_back(std::acos(cos_scattering_angle(in, out, cosine)));
            }
        }
    }
    Eigen::MatrixXd sums;  // without a table: row = direction, column = node in log q
    if (!table_) {
        sums = sum_degrees(strengths_, Eigen::Map<const Eigen::VectorXd>(
                                           angles.data(), Eigen::Index(angles.size())));
    }
    std::size_t k = 0;
    for (const double in : mu_in) {
        for (const double out : mu_out) {
            const Eigen::VectorXd weights = node_weights(1.0 / in + 1.0 / out);
            const double scale = 1.0 / (4.0 * (in + out));
            for (std::size_t a = 0; a < cos_azimuth.size(); ++a, ++k) {
                const double value = table_ ? table_->combined(angles[k], weights)
                                            : sums.row(Eigen::Index(k)).dot(weights);
                reflection[k] += scale * value;
            }
        }
    }
}

}  // namespace miebrdf::rte
