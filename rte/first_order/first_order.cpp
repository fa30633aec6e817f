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
    : directions_(directions),
      options_(options),
      cos_azimuth_(cosines_of(directions.azimuth_deg)) {}

void FirstOrderSum::add_to(std::vector<double>& reflection, const std::vector<ScaledMedium>& media,
                           std::vector<double>* unresolved) {
    const bool exact = options_.single_scattering_correction;
    if (exact) add_narrow_features(reflection, media, unresolved);
    if (exact && phase_.empty()) evaluate_phase(media);
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
    constexpr std::size_t many_directions = 2000;  // from here on a table pays
    double mu_least = 1.0;
    for (const double mu : directions_.mu_in) mu_least = std::min(mu_least, mu);
    for (const double mu : directions_.mu_out) mu_least = std::min(mu_least, mu);
    NarrowFeatures narrow({&media, 1}, mu_least, kNarrowFeaturesShare * options_.tolerance);
    if (reflection.size() > many_directions) narrow.tabulate();
    const bool wanted = unresolved != nullptr && narrow.has_unresolved();
    if (wanted) unresolved->assign(reflection.size(), 0.0);
    narrow.add_to(reflection.data(), directions_.mu_in, directions_.mu_out, cos_azimuth_,
                  wanted ? unresolved->data() : nullptr);
}

void FirstOrderSum::evaluate_phase(const std::vector<ScaledMedium>& media) {
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
}

}  // namespace miebrdf::rte
