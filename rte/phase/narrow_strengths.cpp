#include "rte/phase/narrow_strengths.h"

#include <algorithm>
#include <cmath>

namespace miebrdf::rte {
namespace {

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
        above_ -= absorbed;
        return absorbed;
    }

    double q_;
    double above_ = 1.0;
};

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
    std::vector<double> without;  // from the top down, of no degree in particular
    AttenuatedPath no_peak(q);
    for (auto medium = media.rbegin(); medium != media.rend(); ++medium)
        without.push_back(no_peak.scatter(*medium, medium->scaled.truncated));
    for (int l = first; l < end; ++l) {
        AttenuatedPath true_peak(q), kept_peak(q);
        // The discrete equations know a peak only up to their own moments.
        const bool any_kept = std::any_of(media.begin(), media.end(), [l](const auto& medium) {
            return l < medium.scaled.chi.size();
        });
        for (std::size_t m = 0; m < media.size(); ++m) {
            const ScaledMedium& medium = media[media.size() - 1 - m];
            const DegreeOfMedium degree = degree_of(medium, l);
            const double with_true = true_peak.scatter(medium, degree.peak);
            const double with_kept =
                any_kept ? kept_peak.scatter(medium, degree.kept_peak) : without[m];
            strengths[std::size_t(l)] +=
                (2.0 * l + 1.0) * medium.exact.single_scattering_albedo * degree.rest *
                ((with_true - without[m]) - degree.share_kept * (with_kept - without[m]));
        }
    }
    return strengths;
}

}  // namespace miebrdf::rte
