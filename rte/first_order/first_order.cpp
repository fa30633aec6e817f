#include "rte/first_order/first_order.h"

#include <algorithm>
#include <cmath>
#include <numbers>

#include "rte/first_order/narrow_features.h"
#include "rte/math/legendre.h"
#include "rte/math/tolerance_budget.h"

namespace miebrdf::rte {
namespace {

double cos_of_degrees(double angle_deg) { return std::cos(angle_deg * (std::numbers::pi / 180.0)); }

/// Between a pair of directions, at all azimuths.
class ScatteringAngles {
  public:
    ScatteringAngles(double mu_in, double mu_out)
        : cosines_(-mu_in * mu_out),
          sines_(std::sqrt((1.0 - mu_in) * (1.0 + mu_in) * (1.0 - mu_out) * (1.0 + mu_out))) {}

    double cosine(double cos_azimuth) const {
        return std::clamp(cosines_ + sines_ * cos_azimuth, -1.0, 1.0);
    }

  private:
    double cosines_, sines_;
};

std::vector<double> cosines_of(const std::vector<double>& angles_deg) {
    std::vector<double> cosines(angles_deg.size());
    std::transform(angles_deg.begin(), angles_deg.end(), cosines.begin(), cos_of_degrees);
    return cosines;
}

int most_moments(const std::vector<ScaledMedium>& media) {
    Eigen::Index most = 0;
    for (const ScaledMedium& medium : media) most = std::max(most, medium.scaled.chi.size());
    return int(most);
}

ForwardPeak from_degree(const ForwardPeak& whole, int degree) {
    const auto tail = [&](const std::vector<double>& list) {
        const int before = std::clamp(degree - whole.first_degree, 0, int(list.size()));
        return std::vector<double>(list.begin() + before, list.end());
    };
    return {degree, tail(whole.peak), tail(whole.rest)};
}

}  // namespace

double cos_scattering_angle(double mu_in, double mu_out, double cos_azimuth) {
    return ScatteringAngles(mu_in, mu_out).cosine(cos_azimuth);
}

double exact_phase(const Optics& optics, double cos_theta) {
    return optics.phase ? optics.phase(cos_theta) : math::legendre_series(optics.chi, cos_theta);
}

double first_order_strength(const ScaledMedium& medium, bool exact, double cos_theta) {
    const ScaledOptics& scaled = medium.scaled;
    if (exact) {
        return medium.exact.single_scattering_albedo / scaled.depth_factor *
               exact_phase(medium.exact, cos_theta);
    }
    return scaled.albedo *
           math::legendre_series({scaled.chi.data(), std::size_t(scaled.chi.size())}, cos_theta);
}

void first_order_weights(const std::vector<ScaledMedium>& media, double mu_in, double mu_out,
                         std::span<double> weights) {
    const double q = 1.0 / mu_in + 1.0 / mu_out;
    double above = 0.25 / (mu_in + mu_out);  // what is left on the way through the media above
    for (std::size_t i = media.size(); i-- > 0;) {
        const double slant = media[i].scaled_optical_depth * q;
        weights[i] = above * -std::expm1(-slant);
        above *= std::exp(-slant);
    }
}

double single_scattering(const std::vector<ScaledMedium>& media, bool exact, double mu_in,
                         double mu_out, double cos_azimuth) {
    const double cos_theta = cos_scattering_angle(mu_in, mu_out, cos_azimuth);
    std::vector<double> weights(media.size());
    first_order_weights(media, mu_in, mu_out, weights);
    double sum = 0.0;
    for (std::size_t i = 0; i < media.size(); ++i) {
        if (weights[i] == 0.0) continue;
        sum += weights[i] * first_order_strength(media[i], exact, cos_theta);
    }
    return sum;
}

std::vector<bool> near_retro_reflection(const Directions& directions) {
    const double nearest = -cos_of_degrees(5.0);
    const std::vector<double> cos_azimuth = cosines_of(directions.azimuth_deg);
    std::vector<bool> backwards;
    backwards.reserve(directions.mu_in.size() * directions.mu_out.size() *
                      directions.azimuth_deg.size());
    for (const double mu_in : directions.mu_in) {
        for (const double mu_out : directions.mu_out) {
            const ScatteringAngles angles(mu_in, mu_out);
            for (const double cosine : cos_azimuth)
                backwards.push_back(angles.cosine(cosine) <= nearest);
        }
    }
    return backwards;
}

FirstOrderSum::FirstOrderSum(const Directions& directions, const SolverOptions& options)
    : directions_(directions), options_(options), cos_azimuth_(cosines_of(directions.azimuth_deg)) {
    for (const double mu : directions_.mu_in) mu_least_ = std::min(mu_least_, mu);
    for (const double mu : directions_.mu_out) mu_least_ = std::min(mu_least_, mu);
}

void FirstOrderSum::add_to(std::vector<double>& reflection, const std::vector<ScaledMedium>& media,
                           std::vector<double>* unresolved) {
    const bool exact = options_.single_scattering_correction;
    if (exact && !has_kept(media)) keep(media);
    if (exact) add_narrow_features(reflection, media, unresolved);
    for (std::size_t k = 0; k < narrow_.size(); ++k) reflection[k] += narrow_[k];
    const std::size_t directions = reflection.size();
    std::vector<double> weights(media.size());
    std::size_t first = 0;
    for (const double mu_in : directions_.mu_in) {
        for (const double mu_out : directions_.mu_out) {
            first_order_weights(media, mu_in, mu_out, weights);
            for (std::size_t i = 0; i < media.size(); ++i) {
                const double scale = weights[i] * media[i].exact.single_scattering_albedo /
                                     media[i].scaled.depth_factor;
                for (std::size_t a = 0; a < cos_azimuth_.size(); ++a) {
                    if (exact) {
                        reflection[first + a] += scale * phase_[i * directions + first + a];
                    } else if (weights[i] != 0.0) {
                        const double cosine = cos_scattering_angle(mu_in, mu_out, cos_azimuth_[a]);
                        reflection[first + a] +=
                            weights[i] * first_order_strength(media[i], false, cosine);
                    }
                }
            }
            first += cos_azimuth_.size();
        }
    }
}

void FirstOrderSum::add_narrow_features(std::vector<double>& reflection,
                                        const std::vector<ScaledMedium>& media,
                                        std::vector<double>* unresolved) const {
    NarrowFeatures narrow({&media, 1}, mu_least_, kNarrowFeaturesShare * options_.tolerance,
                          {.end = first_kept_});
    if (worth_a_table(reflection.size())) narrow.tabulate();
    const bool wanted = unresolved != nullptr && narrow.has_unresolved();
    if (wanted) unresolved->assign(reflection.size(), 0.0);
    narrow.add_to(reflection.data(), directions_.mu_in, directions_.mu_out, cos_azimuth_,
                  wanted ? unresolved->data() : nullptr);
}

bool FirstOrderSum::has_kept(const std::vector<ScaledMedium>& media) const {
    if (phase_.empty()) return false;
    if (narrow_.empty()) return true;
    if (most_moments(media) > first_kept_) return false;
    for (std::size_t i = 0; i < media.size(); ++i) {
        const ForwardPeak here = from_degree(media[i].narrow, first_kept_);
        if (here.peak != kept_[i].peak || here.rest != kept_[i].rest) return false;
    }
    return true;
}

void FirstOrderSum::keep(const std::vector<ScaledMedium>& media) {
    phase_.clear();
    phase_.reserve(media.size() * directions_.mu_in.size() * directions_.mu_out.size() *
                   cos_azimuth_.size());
    for (const ScaledMedium& medium : media) {
        for (const double mu_in : directions_.mu_in) {
            for (const double mu_out : directions_.mu_out) {
                const ScatteringAngles angles(mu_in, mu_out);
                for (const double cosine : cos_azimuth_)
                    phase_.push_back(exact_phase(medium.exact, angles.cosine(cosine)));
            }
        }
    }
    keep_narrow_features(media);
}

void FirstOrderSum::keep_narrow_features(const std::vector<ScaledMedium>& media) {
    narrow_.clear();
    kept_.clear();
    // The first numbers of nodes have fewer moments; where others double there is a new first
    // degree.
    constexpr int least = 128;
    first_kept_ = std::max(least, 2 * most_moments(media));
    constexpr int worth = 2;  // times as many
    if (narrow_degrees(media).end < worth * first_kept_) {
        first_kept_ = std::numeric_limits<int>::max();
        return;
    }
    const double tolerance = kNarrowFeaturesShare * options_.tolerance;
    narrow_.assign(phase_.size() / media.size(), 0.0);
    NarrowFeatures features({&media, 1}, mu_least_, tolerance, {.first = first_kept_},
                            NarrowSum::features);
    if (worth_a_table(narrow_.size())) features.tabulate();
    features.add_to(narrow_.data(), directions_.mu_in, directions_.mu_out, cos_azimuth_);
    Eigen::VectorXd angles(Eigen::Index(narrow_.size()));
    Eigen::Index k = 0;
    for (const double mu_in : directions_.mu_in) {
        for (const double mu_out : directions_.mu_out) {
            const ScatteringAngles between(mu_in, mu_out);
            for (const double cosine : cos_azimuth_)
                angles[k++] = std::acos(between.cosine(cosine));
        }
    }
    Eigen::Map<Eigen::MatrixXd>(phase_.data(), angles.size(), Eigen::Index(media.size())) -=
        narrow_phase(media, first_kept_, angles, tolerance);
    for (const ScaledMedium& medium : media)
        kept_.push_back(from_degree(medium.narrow, first_kept_));
}

}  // namespace miebrdf::rte
