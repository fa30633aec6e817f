// What narrow features of a phase function are worth, degree by degree.
#include <algorithm>
#include <cmath>
#include <numbers>
#include <vector>

#include "rte/first_order/narrow_features.h"

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

// The factor G of each medium, from the top down: how much light reaches it, and how much of that
// it can scatter, when a fraction of its scattering counts as none.
class AttenuatedPath {
  public:
    explicit AttenuatedPath(double q) : q_(q) {}

    double scatter(const ScaledMedium& medium, double not_scattered) {
        const double alpha = medium.exact.single_scattering_albedo;
        const double loss = (1.0 - not_scattered) + medium.exact.one_minus_albedo * not_scattered;
        if (loss == medium.scaled.depth_factor || alpha == 0.0) {
            return advance(medium.scaled_optical_depth * q_) / medium.scaled.depth_factor;
        }
        return advance(medium.scaled_optical_depth * q_ * (loss / medium.scaled.depth_factor)) /
               loss;
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

// What one degree of one medium adds to C: its strength times what the factor G of the true peak,
// and that of what the discrete equations keep of it, differ from G(f).
struct DegreeChange {
    double strength = 0.0;  // alpha (2l+1) N_l
    double of_true = 0.0, of_kept = 0.0;
    double share_kept = 1.0;
};

// Calls visit(l, medium, change) for all degrees of all media.
template <typename Visit>
void for_each_degree(const std::vector<ScaledMedium>& media, double q, int first, int end,
                     const Visit& visit) {
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
            visit(
                l, medium,
                DegreeChange{(2.0 * l + 1.0) * medium.exact.single_scattering_albedo * degree.rest,
                             with_true - without[m], with_kept - without[m], degree.share_kept});
        }
    }
}

struct DegreeRange {
    int first = 0, end = 0;
};

DegreeRange degrees_of(const std::vector<ScaledMedium>& media) {
    DegreeRange range;
    for (const ScaledMedium& medium : media) {
        if (medium.narrow.rest.empty()) continue;
        const int first = medium.narrow.first_degree;
        range.first = range.end == 0 ? first : std::min(range.first, first);
        range.end = std::max(range.end, first + int(medium.narrow.rest.size()));
    }
    return range;
}

// The share of degree l that nodes do not resolve at an angle of zenith where they resolve so many
// waves. Of a function of the scattering angle that varies like l waves in all directions, some
// directions are along the azimuth, which Fourier orders resolve whatever the nodes do. (At the
// zenith all are along the zenith angle; so sharp a change within a degree of it would be worse
// than what it mends.)
double share_unresolved(int l, double waves) {
    return double(l) <= waves ? 0.0 : (2.0 / std::numbers::pi) * std::acos(waves / double(l));
}

}  // namespace

std::vector<double> narrow_strengths(const std::vector<ScaledMedium>& media, double q) {
    const auto [first, end] = degrees_of(media);
    std::vector<double> strengths(std::size_t(end), 0.0);
    for_each_degree(media, q, first, end,
                    [&](int l, const ScaledMedium&, const DegreeChange& change) {
                        strengths[std::size_t(l)] +=
                            change.strength * (change.of_true - change.share_kept * change.of_kept);
                    });
    return strengths;
}

std::vector<double> kept_strengths(const std::vector<ScaledMedium>& media, double q) {
    const auto [first, end] = degrees_of(media);
    std::vector<double> strengths(std::size_t(end), 0.0);
    for_each_degree(media, q, first, end,
                    [&](int l, const ScaledMedium& medium, const DegreeChange& change) {
                        if (l < medium.scaled.chi.size())
                            strengths[std::size_t(l)] +=
                                std::abs(change.strength * change.share_kept * change.of_kept);
                    });
    return strengths;
}

std::vector<double> unresolved_shares(const std::vector<double>& resolved_waves, int degrees) {
    std::vector<double> shares;
    shares.reserve(std::size_t(degrees) * resolved_waves.size());
    for (int l = 0; l < degrees; ++l) {
        for (const double waves : resolved_waves) shares.push_back(share_unresolved(l, waves));
    }
    return shares;
}

std::vector<double> unresolved_strengths(const std::vector<ScaledMedium>& media, double q) {
    const auto [first, end] = degrees_of(media);
    std::size_t kept = 0;
    for (const ScaledMedium& medium : media)
        kept = std::max(kept, medium.unresolved_shares.size() / kResolvedAngles);
    const std::size_t degrees = std::min(std::size_t(end), kept);
    std::vector<double> strengths(degrees * kResolvedAngles, 0.0);
    for_each_degree(media, q, first, int(degrees),
                    [&](int l, const ScaledMedium& medium, const DegreeChange& change) {
                        const std::size_t row = std::size_t(l) * kResolvedAngles;
                        if (row >= medium.unresolved_shares.size()) return;
                        const double half =
                            0.5 * change.strength * change.share_kept * change.of_kept;
                        for (std::size_t k = 0; k < kResolvedAngles; ++k)
                            strengths[row + k] += half * medium.unresolved_shares[row + k];
                    });
    return strengths;
}

}  // namespace miebrdf::rte
