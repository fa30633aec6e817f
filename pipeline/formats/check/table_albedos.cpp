#include "pipeline/formats/check/check.h"

#include <math.h>  // Boost 1.74 calls ::isnan in pchip.hpp

#include <algorithm>
#include <boost/math/interpolators/pchip.hpp>
#include <cmath>
#include <numbers>

#include "rte/math/quadrature.h"

namespace miebrdf {
namespace {

using Indices = std::vector<std::size_t>;

Indices all(std::size_t count) {
    Indices indices(count);
    for (std::size_t i = 0; i < count; ++i) indices[i] = i;
    return indices;
}

/// Every second one, the last among them: the normal, or the end of the half turn.
Indices every_second(std::size_t count) {
    Indices indices;
    for (std::size_t i = (count + 1) % 2; i < count; i += 2) indices.push_back(i);
    return indices;
}

/// Weights of the full turn, in rad, for a list that covers half of it (and is mirrored) or all.
std::vector<double> azimuth_weights(const std::vector<double>& azimuth_deg, const Indices& chosen) {
    const bool half = azimuth_deg.back() <= 180.0;
    const double turn = half ? 180.0 : 360.0;
    const double first = azimuth_deg[chosen.front()], last = azimuth_deg[chosen.back()];
    std::vector<double> weights;
    for (std::size_t i = 0; i < chosen.size(); ++i) {
        const double here = azimuth_deg[chosen[i]];
        double before = half ? 0.0 : (last - turn + here) / 2;
        double after = half ? turn : (here + first + turn) / 2;
        if (i > 0) before = (azimuth_deg[chosen[i - 1]] + here) / 2;
        if (i + 1 < chosen.size()) after = (here + azimuth_deg[chosen[i + 1]]) / 2;
        weights.push_back(2 * std::numbers::pi * (after - before) / turn);
    }
    return weights;
}

double coordinate(double mu) { return std::asin(std::sqrt(std::clamp(mu, 0.0, 1.0))); }

/// A curve through the values at cosines; a cubic from four points on.
class Curve {
  public:
    Curve(std::vector<double> x, std::vector<double> y) : x_(std::move(x)), y_(std::move(y)) {
        if (x_.size() >= 4) cubic_.emplace(std::vector<double>(x_), std::vector<double>(y_));
    }
    double operator()(std::size_t panel, double x) const {
        if (cubic_) return (*cubic_)(x);
        const double share = (x - x_[panel]) / (x_[panel + 1] - x_[panel]);
        return y_[panel] + share * (y_[panel + 1] - y_[panel]);
    }

  private:
    std::vector<double> x_, y_;
    std::optional<boost::math::interpolators::pchip<std::vector<double>>> cubic_;
};

/// Integral of f mu dmu over (0, 1), f given at the chosen cosines.
double cosine_integral(const std::vector<double>& mu, const Indices& chosen,
                       const std::vector<double>& f) {
    std::vector<double> x, y;
    for (const std::size_t i : chosen) {
        x.push_back(coordinate(mu[i]));
        y.push_back(f[i]);
    }
    const double lowest = mu[chosen.front()], highest = mu[chosen.back()];
    double sum = y.front() * lowest * lowest / 2 + y.back() * (1 - highest * highest) / 2;
    const Curve curve(x, y);
    // A cubic times mu dmu = sin^2 x sin 2x dx: to 1e-9 on panels of half a radian.
    static const math::Quadrature rule = math::gauss_legendre(6, 0.0, 1.0);
    for (std::size_t panel = 0; panel + 1 < x.size(); ++panel) {
        const double width = x[panel + 1] - x[panel];
        for (std::size_t i = 0; i < rule.nodes.size(); ++i) {
            const double t = x[panel] + width * rule.nodes[i];
            sum += width * rule.weights[i] * curve(panel, t) * std::pow(std::sin(t), 2) *
                   std::sin(2 * t);
        }
    }
    return sum;
}

/// Integrals over azimuth at each outgoing cosine, for all azimuths and for every second one.
struct Rings {
    std::vector<std::vector<double>> fine, coarse;  ///< [channel][mu_out]
};

Rings rings(const BrdfFile& file, const ListedDirections& lists, double mu_in) {
    const std::size_t channels = file.channels().size(), azimuths = lists.azimuth_deg.size();
    const Indices chosen = every_second(azimuths);
    const std::vector<double> fine = azimuth_weights(lists.azimuth_deg, all(azimuths));
    std::vector<double> coarse(azimuths, 0.0);
    const std::vector<double> chosen_weights = azimuth_weights(lists.azimuth_deg, chosen);
    for (std::size_t i = 0; i < chosen.size(); ++i) coarse[chosen[i]] = chosen_weights[i];
    const std::vector<double> none(lists.mu_out.size(), 0.0);
    Rings sums{std::vector(channels, none), std::vector(channels, none)};
    std::vector<double> values(channels);
    for (std::size_t o = 0; o < lists.mu_out.size(); ++o) {
        for (std::size_t a = 0; a < azimuths; ++a) {
            file.evaluate({mu_in, lists.mu_out[o], lists.azimuth_deg[a]}, values);
            for (std::size_t c = 0; c < channels; ++c) {
                if (std::isnan(values[c])) continue;
                sums.fine[c][o] += fine[a] * values[c];
                sums.coarse[c][o] += coarse[a] * values[c];
            }
        }
    }
    return sums;
}

}  // namespace

std::vector<TableAlbedo> table_albedos(const BrdfFile& file, const ListedDirections& lists) {
    std::vector<TableAlbedo> albedos;
    if (lists.mu_out.size() < 3 || lists.azimuth_deg.size() < 3) return albedos;
    const Indices every = all(lists.mu_out.size()), second = every_second(lists.mu_out.size());
    for (const double mu_in : lists.mu_in) {
        const Rings sums = rings(file, lists, mu_in);
        TableAlbedo found{mu_in, {}, {}};
        for (std::size_t c = 0; c < sums.fine.size(); ++c) {
            const double best = cosine_integral(lists.mu_out, every, sums.fine[c]);
            const double cosines = cosine_integral(lists.mu_out, second, sums.fine[c]);
            const double azimuths = cosine_integral(lists.mu_out, every, sums.coarse[c]);
            found.albedo.push_back(best);
            // Twice: peaks that the table does not resolve converge slowly.
            found.error_estimate.push_back(2 *
                                           (std::abs(cosines - best) + std::abs(azimuths - best)));
        }
        albedos.push_back(std::move(found));
    }
    return albedos;
}

}  // namespace miebrdf
