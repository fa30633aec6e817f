// Layout: 64-byte header, nodes, CDF, (offset, length) of each series, coefficients. Evaluation:
// pbrt-v3, Fourier BSDF (Pharr, Jakob, Humphreys 2016, sections 8.6 and 14.1.4).
#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>

#include "tests/support/outside/bytes.h"
#include "tests/support/outside/outside_file.h"

namespace miebrdf::support {
namespace {

/// Value and antiderivative of the cubic through f0, f1 with end slopes d0, d1, on [0, 1].
struct Cubic {
    double f0, f1, d0, d1;
    double value(double t) const {
        return f0 + t * (d0 + t * (3 * (f1 - f0) - 2 * d0 - d1 + t * (d0 + d1 - 2 * (f1 - f0))));
    }
    double integral(double t) const {
        return t * (f0 + t * (d0 / 2 + t * ((3 * (f1 - f0) - 2 * d0 - d1) / 3 +
                                            t * (d0 + d1 - 2 * (f1 - f0)) / 4)));
    }
};

/// The root in [low, high] of a rising function, by bisection.
template <typename Function>
double root(Function&& function, double low, double high) {
    for (int step = 0; step < 50; ++step) {
        const double middle = (low + high) / 2;
        (function(middle) < 0 ? low : high) = middle;
    }
    return (low + high) / 2;
}

class ScatfunFile : public OutsideFile {
  public:
    explicit ScatfunFile(const std::string& bytes) {
        n_ = number_at<std::uint32_t>(bytes, 12);
        const std::size_t coefficients = number_at<std::uint32_t>(bytes, 16);
        channels_ = number_at<std::uint32_t>(bytes, 24);
        std::size_t at = 64;
        mu_ = numbers_at<float>(bytes, at, n_);
        cdf_ = numbers_at<float>(bytes, at += 4 * n_, n_ * n_);
        extents_ = numbers_at<std::uint32_t>(bytes, at += 4 * n_ * n_, 2 * n_ * n_);
        a_ = numbers_at<float>(bytes, at + 8 * n_ * n_, coefficients);
    }

    std::vector<double> brdf(const Vector& to_light, const Vector& to_viewer) const override {
        const double mu_i = -to_light.z();
        const double angle = azimuth(-to_light, to_viewer);
        const auto series = mixed(mu_i, to_viewer.z());
        const double scale = mu_i != 0 ? 1 / std::abs(mu_i) : 0.0;
        const double y = std::max(0.0, sum(series[0], angle));
        if (channels_ == 1) return {y * scale};
        const double r = sum(series[1], angle), b = sum(series[2], angle);
        const double g = 1.39829 * y - 0.100913 * b - 0.297375 * r;
        return {std::max(0.0, r * scale), std::max(0.0, g * scale), std::max(0.0, b * scale)};
    }

    std::optional<Vector> sample(const Vector& viewer, double u, double v) const override {
        const double mu_i = sample_cosine(viewer.z(), v);
        const auto series = mixed(mu_i, viewer.z())[0];
        if (series.empty() || !(series[0] > 0)) return {};
        // One half of u for each side of the plane of incidence.
        const double half = u < 0.5 ? 2 * u : 2 - 2 * u;
        const double angle = root(
            [&](double phi) {
                double total = series[0] * (phi - half * std::numbers::pi);
                for (std::size_t k = 1; k < series.size(); ++k) {
                    const auto order = static_cast<double>(k);
                    total += series[k] / order * std::sin(order * phi);
                }
                return total;
            },
            0.0, std::numbers::pi);
        const double turned = std::atan2(viewer.y(), viewer.x()) + (u < 0.5 ? angle : -angle);
        const double sine = std::sqrt(std::max(0.0, 1 - mu_i * mu_i));
        return Vector(-sine * std::cos(turned), -sine * std::sin(turned), -mu_i);
    }

    double density(const Vector& viewer, const Vector& light) const override {
        const Weights row = weights(viewer.z());
        double rho = 0;
        for (int i = 0; i < 4; ++i) {
            if (row.w[i] != 0)
                rho += row.w[i] * cdf_[static_cast<std::size_t>(row.first + i) * n_ + n_ - 1];
        }
        const double y = sum(mixed(-light.z(), viewer.z())[0], azimuth(-light, viewer));
        return rho > 0 && y > 0 ? y / (2 * std::numbers::pi * rho) : 0.0;
    }

  private:
    struct Weights {
        int first = 0;
        std::array<double, 4> w{};
    };

    static double azimuth(const Vector& a, const Vector& b) {
        return std::atan2(b.y(), b.x()) - std::atan2(a.y(), a.x());
    }

    std::size_t interval(double x) const {
        const auto above = std::upper_bound(mu_.begin(), mu_.end(), x) - mu_.begin() - 1;
        return static_cast<std::size_t>(
            std::clamp<std::ptrdiff_t>(above, 0, static_cast<std::ptrdiff_t>(n_) - 2));
    }

    /// Catmull-Rom weights of four nodes: the spline of the unit vectors.
    Weights weights(double x) const {
        const std::size_t i = interval(x);
        Weights result{static_cast<int>(i) - 1, {}};
        const double t = (x - mu_[i]) / (double(mu_[i + 1]) - mu_[i]);
        for (int j = 0; j < 4; ++j) {
            const auto unit = [&](std::size_t node) {
                return static_cast<std::ptrdiff_t>(node) == result.first + j ? 1.0 : 0.0;
            };
            result.w[j] = cubic(i, unit).value(t);
        }
        return result;
    }

    /// The spline's piece on interval i of values f(node); one-sided at the ends of the table.
    template <typename Values>
    Cubic cubic(std::size_t i, Values&& f) const {
        const double width = double(mu_[i + 1]) - mu_[i];
        Cubic piece{f(i), f(i + 1), 0, 0};
        piece.d0 = i == 0 ? piece.f1 - piece.f0
                          : width * (piece.f1 - f(i - 1)) / (double(mu_[i + 1]) - mu_[i - 1]);
        piece.d1 = i + 2 == n_ ? piece.f1 - piece.f0
                               : width * (f(i + 2) - piece.f0) / (double(mu_[i + 2]) - mu_[i]);
        return piece;
    }

    /// Series of each channel at a pair of cosines: row = viewer, column = minus the light.
    std::array<std::vector<double>, 3> mixed(double mu_i, double mu_o) const {
        const Weights in = weights(mu_i), out = weights(mu_o);
        std::array<std::vector<double>, 3> series;
        for (int o = 0; o < 4; ++o) {
            for (int i = 0; i < 4; ++i) {
                const double weight = in.w[i] * out.w[o];
                if (weight == 0) continue;
                const std::size_t pair = static_cast<std::size_t>(out.first + o) * n_ +
                                         static_cast<std::size_t>(in.first + i);
                const std::size_t first = extents_[2 * pair], length = extents_[2 * pair + 1];
                for (std::size_t c = 0; c < channels_; ++c) {
                    if (series[c].size() < length) series[c].resize(length, 0.0);
                    for (std::size_t k = 0; k < length; ++k)
                        series[c][k] += weight * a_[first + c * length + k];
                }
            }
        }
        return series;
    }

    static double sum(const std::vector<double>& a, double angle) {
        double total = 0;
        for (std::size_t k = 0; k < a.size(); ++k)
            total += a[k] * std::cos(static_cast<double>(k) * angle);
        return total;
    }

    /// Inverts the row's running integral: the interval from the file's CDF, the rest from the
    /// cubic through the means.
    double sample_cosine(double mu_o, double u) const {
        const Weights row = weights(mu_o);
        const auto mix = [&](auto&& entry) {
            double total = 0;
            for (int i = 0; i < 4; ++i) {
                if (row.w[i] != 0)
                    total += row.w[i] * entry(static_cast<std::size_t>(row.first + i) * n_);
            }
            return total;
        };
        const auto cdf = [&](std::size_t c) {
            return mix([&](std::size_t r) { return double(cdf_[r + c]); });
        };
        const auto mean = [&](std::size_t c) {
            return mix([&](std::size_t r) {
                return extents_[2 * (r + c) + 1] > 0 ? double(a_[extents_[2 * (r + c)]]) : 0.0;
            });
        };
        const double target = u * cdf(n_ - 1);
        std::size_t i = 0;
        while (i + 2 < n_ && cdf(i + 1) <= target) ++i;
        const double width = double(mu_[i + 1]) - mu_[i];
        const Cubic piece = cubic(i, mean);
        const double rest = (target - cdf(i)) / width;
        return mu_[i] + width * root([&](double t) { return piece.integral(t) - rest; }, 0.0, 1.0);
    }

    std::size_t n_ = 0, channels_ = 0;
    std::vector<float> mu_, cdf_, a_;
    std::vector<std::uint32_t> extents_;
};

}  // namespace

std::unique_ptr<OutsideFile> scatfun_file(const std::string& bytes) {
    return std::make_unique<ScatfunFile>(bytes);
}

}  // namespace miebrdf::support
