// The strengths of narrow features of a phase function, degree by degree.
#include <algorithm>
#include <cmath>
#include <numbers>
#include <vector>

#include "rte/first_order/glory_correction.h"

namespace miebrdf::rte {
namespace {

// One degree of a medium's phase function.
struct DegreeOfMedium {
    double structure = 0.0;  // N_l
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
    if (k < int(medium.narrow.structure.size()))
        degree.structure = medium.narrow.structure[std::size_t(k)];
    if (l < medium.scaled.chi.size()) {
        degree.kept_peak += (1.0 - f) * medium.scaled.chi[l] - degree.share_kept * degree.structure;
    }
    return degree;
}

// The share of degree l that nodes do not resolve at an angle of zenith where they resolve so many
// waves. Of a function of the scattering angle that varies like l waves in all directions, some
// directions are along the azimuth, which Fourier orders resolve whatever the nodes do. (At the
// zenith all are along the zenith angle; so sharp a change within a degree of it would be worse
// than what it mends.)
double share_unresolved(int l, double waves) {
    return double(l) <= waves ? 0.0 : (2.0 / std::numbers::pi) * std::acos(waves / double(l));
}

// 1 - exp(-x) of x >= 0, of which the library's own has no vectors.
Eigen::ArrayXd one_minus_exp(const Eigen::ArrayXd& x) {
    constexpr double few = 0.01;  // six terms leave few^6 / 7!, 2e-16
    const Eigen::ArrayXd small = x.min(few);
    Eigen::ArrayXd series = 1.0 - small * (1.0 / 6);
    for (const double factor : {1.0 / 5, 1.0 / 4, 1.0 / 3, 1.0 / 2})
        series = 1.0 - factor * small * series;
    return (x < few).select(small * series, 1.0 - (-x).exp());
}

// The light that a medium takes of what reaches it, degree by degree.
Eigen::ArrayXd absorbed_of(const Eigen::ArrayXd& above, double slant, const Eigen::ArrayXd& loss) {
    if (!std::isfinite(slant)) return above;
    return above * one_minus_exp(slant * loss);
}

}  // namespace

DegreeRange narrow_degrees(const std::vector<ScaledMedium>& media, const DegreeRange& wanted) {
    DegreeRange range = {0, 0};
    for (const ScaledMedium& medium : media) {
        if (medium.narrow.structure.empty()) continue;
        const int first = medium.narrow.first_degree;
        range.first = range.end == 0 ? first : std::min(range.first, first);
        range.end = std::max(range.end, first + int(medium.narrow.structure.size()));
    }
    range.first = std::max(range.first, wanted.first);
    range.end = std::clamp(range.end, range.first, std::max(range.first, wanted.end));
    return range;
}

std::vector<double> unresolved_shares(const std::vector<double>& resolved_waves, int degrees) {
    std::vector<double> shares;
    shares.reserve(std::size_t(degrees) * resolved_waves.size());
    for (int l = 0; l < degrees; ++l) {
        for (const double waves : resolved_waves) shares.push_back(share_unresolved(l, waves));
    }
    return shares;
}

GloryStrengths::GloryStrengths(const std::vector<ScaledMedium>& media, const DegreeRange& degrees,
                               NarrowSum sum)
    : sum_(sum) {
    const DegreeRange range = narrow_degrees(media, degrees);
    first_ = range.first;
    count_ = range.end - range.first;
    if (count_ == 0) return;
    for (const ScaledMedium& medium : media) {
        if (sum_ == NarrowSum::features) break;
        kept_ =
            std::max(kept_, std::clamp(medium.scaled.chi.size() - first_, Eigen::Index(0), count_));
    }
    for (auto from = media.rbegin(); from != media.rend(); ++from) {
        const double alpha = from->exact.single_scattering_albedo;
        const auto loss_with = [&](double not_scattered) {
            return (1.0 - not_scattered) + from->exact.one_minus_albedo * not_scattered;
        };
        Medium medium;
        medium.scaled_optical_depth = from->scaled_optical_depth;
        medium.depth_factor = from->scaled.depth_factor;
        medium.unresolved_shares = from->unresolved_shares;
        for (Eigen::ArrayXd* part : {&medium.strength, &medium.loss, &medium.share_kept})
            part->resize(count_);
        medium.loss_of_kept.resize(kept_);
        for (Eigen::Index i = 0; i < count_; ++i) {
            const int l = first_ + int(i);
            const DegreeOfMedium degree = degree_of(*from, l);
            medium.strength[i] = alpha * (2.0 * l + 1.0) * degree.structure;
            medium.loss[i] = loss_with(degree.peak) / medium.depth_factor;
            medium.share_kept[i] = degree.share_kept;
            if (i < kept_)
                medium.loss_of_kept[i] = loss_with(degree.kept_peak) / medium.depth_factor;
        }
        media_.push_back(std::move(medium));
    }
}

// G of each medium, from the top down, is how much light reaches it and how much of that it can
// scatter.
template <typename Visit>
void GloryStrengths::for_each_medium(double q, Eigen::Index degrees, const Visit& visit) const {
    double above_without = 1.0;
    Eigen::ArrayXd above = Eigen::ArrayXd::Ones(degrees), above_kept = Eigen::ArrayXd::Ones(kept_);
    for (const Medium& medium : media_) {
        const double slant = medium.scaled_optical_depth * q, factor = medium.depth_factor;
        const double without = above_without * -std::expm1(-slant);
        above_without -= without;
        const Eigen::ArrayXd of_true = absorbed_of(above, slant, medium.loss.head(degrees));
        above -= of_true;
        // The discrete equations know a peak only up to their own moments.
        const Eigen::ArrayXd of_kept = absorbed_of(above_kept, slant, medium.loss_of_kept);
        above_kept -= of_kept;
        visit(medium, (of_true / medium.loss.head(degrees) - without) / factor,
              (of_kept / medium.loss_of_kept - without) / factor, without / factor);
    }
}

Eigen::VectorXd GloryStrengths::of_all(double q) const {
    Eigen::VectorXd strengths = Eigen::VectorXd::Zero(count_ == 0 ? 0 : first_ + count_);
    auto sums = strengths.tail(count_).array();
    for_each_medium(q, count_,
                    [&](const Medium& medium, const Eigen::ArrayXd& of_true,
                        const Eigen::ArrayXd& of_kept, double without) {
                        if (sum_ == NarrowSum::features) {
                            sums += medium.strength * (of_true + without);
                            return;
                        }
                        sums += medium.strength * of_true;
                        sums.head(kept_) -=
                            medium.strength.head(kept_) * medium.share_kept.head(kept_) * of_kept;
                    });
    return strengths;
}

Eigen::VectorXd GloryStrengths::of_unresolved(double q) const {
    std::size_t listed = 0;
    for (const Medium& medium : media_) listed = std::max(listed, medium.unresolved_shares.size());
    const Eigen::Index degrees =
        std::min(first_ + count_, Eigen::Index(listed / std::size_t(kResolvedAngles)));
    Eigen::VectorXd strengths = Eigen::VectorXd::Zero(degrees * kResolvedAngles);
    if (degrees <= first_) return strengths;
    for_each_medium(
        q, 0,
        [&](const Medium& medium, const Eigen::ArrayXd&, const Eigen::ArrayXd& of_kept, double) {
            const auto own = Eigen::Index(medium.unresolved_shares.size()) / kResolvedAngles;
            for (Eigen::Index l = first_; l < std::min(degrees, own); ++l) {
                const Eigen::Index i = l - first_;
                const double kept = i < kept_ ? of_kept[i] : 0.0;
                const double half = 0.5 * medium.strength[i] * medium.share_kept[i] * kept;
                for (Eigen::Index k = 0; k < kResolvedAngles; ++k) {
                    const Eigen::Index at = l * kResolvedAngles + k;
                    strengths[at] += half * medium.unresolved_shares[std::size_t(at)];
                }
            }
        });
    return strengths;
}

double unresolved_glory(const std::vector<ScaledMedium>& media, double mu) {
    const Eigen::VectorXd strengths =
        GloryStrengths(media, {}, NarrowSum::features).of_all(2.0 / mu);
    // What nodes resolve in part elsewhere they do not resolve at all at the zenith.
    const bool at_zenith = mu >= std::cos(5.0 * std::numbers::pi / 180.0);
    const auto angle =
        std::size_t(std::lround(std::acos(mu) * (2.0 / std::numbers::pi) * (kResolvedAngles - 1)));
    // Shares are of the nodes: any medium that lists a degree tells.
    const auto share_of = [&](Eigen::Index l) {
        const std::size_t at = std::size_t(l) * kResolvedAngles + angle;
        for (const ScaledMedium& medium : media) {
            if (at >= medium.unresolved_shares.size()) continue;
            const double share = medium.unresolved_shares[at];
            return at_zenith && share > 0.0 ? 1.0 : share;
        }
        return 1.0;
    };
    double glory = 0.0, all = 0.0, unresolved = 0.0;
    for (Eigen::Index l = 0; l < strengths.size(); ++l) {
        glory += l % 2 == 0 ? strengths[l] : -strengths[l];
        all += std::abs(strengths[l]);
        unresolved += share_of(l) * std::abs(strengths[l]);
    }
    return all > 0.0 ? std::abs(glory) * (unresolved / all) / (8.0 * mu) : 0.0;
}

}  // namespace miebrdf::rte
