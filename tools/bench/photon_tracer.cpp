#include "tools/bench/photon_tracer.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <stdexcept>

namespace miebrdf::bench {
namespace {

// Constants of Salmon et al. 2011, table 2 and section 4.3.
constexpr std::uint64_t kMultiplier0 = 0xD2511F53;
constexpr std::uint64_t kMultiplier1 = 0xCD9E8D57;
constexpr std::uint32_t kWeyl0 = 0x9E3779B9;
constexpr std::uint32_t kWeyl1 = 0xBB67AE85;
constexpr int kRounds = 10;

std::uint32_t low(std::uint64_t x) { return static_cast<std::uint32_t>(x); }
std::uint32_t high(std::uint64_t x) { return static_cast<std::uint32_t>(x >> 32); }

}  // namespace

PhiloxCounter philox(PhiloxCounter c, PhiloxKey k) {
    for (int round = 0; round < kRounds; ++round) {
        const std::uint64_t a = kMultiplier0 * c[0];
        const std::uint64_t b = kMultiplier1 * c[2];
        c = {high(b) ^ c[1] ^ k[0], low(b), high(a) ^ c[3] ^ k[1], low(a)};
        k = {k[0] + kWeyl0, k[1] + kWeyl1};
    }
    return c;
}

RandomStream::RandomStream(std::uint64_t seed, std::uint64_t stream)
    : key_{low(seed), high(seed)}, counter_{0, 0, low(stream), high(stream)} {}

double RandomStream::uniform() {
    if (used_ == 4) {
        block_ = philox(counter_, key_);
        if (++counter_[0] == 0) ++counter_[1];
        used_ = 0;
    }
    const std::uint64_t bits = (std::uint64_t{block_[used_]} << 32 | block_[used_ + 1]) >> 11;
    used_ += 2;
    // The largest sum would round up to 1 in the last place.
    const double u = (static_cast<double>(bits) + 0.5) * 0x1p-53;
    return u < 1.0 ? u : 1.0 - 0x1p-53;
}

ScatteringLaw ScatteringLaw::isotropic() { return ScatteringLaw(Kind::isotropic); }
ScatteringLaw ScatteringLaw::rayleigh() { return ScatteringLaw(Kind::rayleigh); }

ScatteringLaw ScatteringLaw::henyey_greenstein(double asymmetry) {
    if (!(asymmetry > -1 && asymmetry < 1)) {
        throw std::invalid_argument(fmt::format("asymmetry {} is not in (-1, 1)", asymmetry));
    }
    if (asymmetry == 0) return isotropic();
    ScatteringLaw law(Kind::henyey_greenstein);
    law.g_ = asymmetry;
    return law;
}

ScatteringLaw ScatteringLaw::tabulated(std::vector<double> x, std::vector<double> value) {
    const std::size_t n = x.size();
    if (n < 2 || value.size() != n || x.front() != -1 || x.back() != 1) {
        throw std::invalid_argument(
            "a phase function table needs cosines from -1 to 1, each with a value");
    }
    ScatteringLaw law(Kind::tabulated);
    law.cumulative_.assign(n, 0.0);
    for (std::size_t i = 0; i < n; ++i) {
        if (!(value[i] >= 0) || (i > 0 && !(x[i] > x[i - 1]))) {
            throw std::invalid_argument(fmt::format(
                "phase function table: value {} at cosine {} is negative or out of order", value[i],
                x[i]));
        }
        if (i > 0) {
            law.cumulative_[i] =
                law.cumulative_[i - 1] + (x[i] - x[i - 1]) * (value[i] + value[i - 1]) / 2;
        }
    }
    const double total = law.cumulative_.back();
    if (!(total > 0)) throw std::invalid_argument("phase function table is 0 everywhere");
    for (double& c : law.cumulative_) c /= total;
    for (double& v : value) v *= 2 / total;
    law.cos_theta_ = std::move(x);
    law.value_ = std::move(value);
    return law;
}

double ScatteringLaw::value(double x) const {
    switch (kind_) {
        case Kind::isotropic:
            return 1.0;
        case Kind::rayleigh:
            return 0.75 * (1 + x * x);
        case Kind::henyey_greenstein: {
            const double base = (1 - g_) * (1 - g_) + 2 * g_ * (1 - x);
            return (1 - g_ * g_) / (base * std::sqrt(base));
        }
        case Kind::tabulated:
            break;
    }
    const auto above = std::upper_bound(cos_theta_.begin() + 1, cos_theta_.end() - 1, x);
    const auto i = static_cast<std::size_t>(above - cos_theta_.begin());
    const double t = (x - cos_theta_[i - 1]) / (cos_theta_[i] - cos_theta_[i - 1]);
    return value_[i - 1] + t * (value_[i] - value_[i - 1]);
}

double ScatteringLaw::sample(double u) const {
    double x = 0;
    switch (kind_) {
        case Kind::isotropic:
            return 2 * u - 1;
        case Kind::rayleigh: {
            // x^3 + 3 x = 8 u - 4, by Cardano's formula.
            const double half = 4 * u - 2;
            const double a = std::cbrt(std::abs(half) + std::sqrt(half * half + 1));
            x = std::copysign(a - 1 / a, half);
            break;
        }
        case Kind::henyey_greenstein: {
            // Witt 1977, eq. 19.
            const double s = (1 - g_ * g_) / (1 - g_ + 2 * g_ * u);
            x = (1 + g_ * g_ - s * s) / (2 * g_);
            break;
        }
        case Kind::tabulated: {
            const auto above = std::upper_bound(cumulative_.begin() + 1, cumulative_.end() - 1, u);
            const auto i = static_cast<std::size_t>(above - cumulative_.begin());
            // The area of a trapezoid from its left end is what is missing: v t + slope t^2 / 2.
            const double width = cos_theta_[i] - cos_theta_[i - 1];
            const double v = value_[i - 1];
            const double slope = (value_[i] - v) / width;
            const double area = 2 * (u - cumulative_[i - 1]);
            const double root = std::sqrt(std::max(0.0, v * v + 2 * slope * area));
            const double t = v + root > 0 ? 2 * area / (v + root) : 0.0;
            x = cos_theta_[i - 1] + std::min(t, width);
            break;
        }
    }
    return std::clamp(x, -1.0, 1.0);
}

double ScatteringLaw::asymmetry() const {
    if (kind_ != Kind::tabulated) return g_;
    double sum = 0;
    for (std::size_t i = 1; i < cos_theta_.size(); ++i) {
        const double a = cos_theta_[i - 1], b = cos_theta_[i];
        // Integral of x times a linear function, by Simpson's rule, which is exact for it.
        sum += (b - a) / 6 *
               (a * value_[i - 1] + (a + b) * (value_[i - 1] + value_[i]) + b * value_[i]);
    }
    return sum / 2;
}

namespace {

// Below this weight a photon survives with probability 1/10, with ten times its weight: fewer
// collisions are traced for light that hardly matters.
constexpr double kRouletteBelow = 0.05;
constexpr double kSurvival = 0.1;

void require(bool good, const char* what, double value, const char* allowed) {
    if (!good) throw std::invalid_argument(fmt::format("{} {} is not in {}", what, value, allowed));
}

void check(const TracedLayer& layer, bool is_coat) {
    const double a = layer.single_scattering_albedo;
    require(a >= 0 && a <= 1, "albedo", a, "[0, 1]");
    if (is_coat)
        require(layer.optical_depth >= 0, "optical depth", layer.optical_depth, "[0, inf)");
}

struct Direction {
    double x, y, z;  // z points down, into the layers
};

// Turns a direction by the scattering angle, at a uniform angle around it.
Direction scattered(const Direction& d, double cos_theta, double around) {
    const double sin_theta = std::sqrt(std::max(0.0, (1 - cos_theta) * (1 + cos_theta)));
    const double c = sin_theta * std::cos(around), s = sin_theta * std::sin(around);
    const double across = std::sqrt(d.x * d.x + d.y * d.y);
    if (across < 1e-10) return {c, s, d.z > 0 ? cos_theta : -cos_theta};
    return {d.x * cos_theta + (d.x * d.z * c - d.y * s) / across,
            d.y * cos_theta + (d.y * d.z * c + d.x * s) / across, d.z * cos_theta - across * c};
}

// Layers from the top, each with the optical depth at which it ends.
struct Medium {
    double end;
    const TracedLayer* layer;
};

std::vector<Medium> from_the_top(const TracedStack& stack) {
    std::vector<Medium> media;
    double depth = 0;
    for (auto coat = stack.coats.rbegin(); coat != stack.coats.rend(); ++coat) {
        check(*coat, true);
        depth += coat->optical_depth;
        media.push_back({depth, &*coat});
    }
    check(stack.base, false);
    media.push_back({std::numeric_limits<double>::infinity(), &stack.base});
    return media;
}

struct Sums {
    double first = 0, second = 0;
    void add(double x) {
        first += x;
        second += x * x;
    }
    Estimate estimate(double count, double unfinished) const {
        const double mean = first / count;
        const double variance = std::max(0.0, second / count - mean * mean);
        return {mean, std::sqrt(variance / std::max(1.0, count - 1)), unfinished};
    }
};

class Tracer {
  public:
    Tracer(const TracedStack& stack, double mu_in, const std::vector<Detector>& detectors,
           const TracerOptions& options)
        : media_(from_the_top(stack)), options_(options), mu_in_(mu_in) {
        for (const Detector& d : detectors) {
            require(d.mu_out > 0 && d.mu_out <= 1, "mu_out", d.mu_out, "(0, 1]");
            const double across = std::sqrt((1 - d.mu_out) * (1 + d.mu_out));
            const double azimuth = d.azimuth_deg * M_PI / 180;
            eyes_.push_back({across * std::cos(azimuth), across * std::sin(azimuth), -d.mu_out});
        }
        seen_.resize(detectors.size());
    }

    TracedReflection trace() {
        Sums left;
        std::vector<Sums> sums(eyes_.size());
        double given_up = 0;
        for (int i = 0; i < options_.photons; ++i) {
            std::fill(seen_.begin(), seen_.end(), 0.0);
            RandomStream random(options_.seed, static_cast<std::uint64_t>(i));
            const auto [out, inside] = follow(random);
            left.add(out);
            given_up += inside;
            for (std::size_t d = 0; d < sums.size(); ++d) sums[d].add(seen_[d]);
        }
        const double n = options_.photons;
        TracedReflection result;
        result.plane_albedo = left.estimate(n, given_up / n);
        // What is given up is deep inside; from there light leaves with a radiance of at most 1.3
        // times its mean (the escape function at the zenith, van de Hulst 1980, table 12).
        for (const Sums& s : sums) result.reflection.push_back(s.estimate(n, 1.3 * given_up / n));
        return result;
    }

  private:
    struct Fate {
        double out;     // weight that left through the top
        double inside;  // weight given up
    };

    Fate follow(RandomStream& random) {
        Direction d{std::sqrt((1 - mu_in_) * (1 + mu_in_)), 0, mu_in_};
        double depth = 0, weight = 1;
        for (int collision = 0; collision < options_.most_collisions; ++collision) {
            depth -= d.z * std::log(random.uniform());
            if (depth <= 0) return {weight, 0};
            const TracedLayer& layer = layer_at(depth);
            weight *= layer.single_scattering_albedo;
            if (weight == 0) return {0, 0};
            look(layer.law, d, depth, weight);
            if (weight < kRouletteBelow) {
                if (random.uniform() > kSurvival) return {0, 0};
                weight /= kSurvival;
            }
            const double cos_theta = layer.law.sample(random.uniform());
            d = scattered(d, cos_theta, 2 * M_PI * random.uniform());
            const double norm = 1 / std::sqrt(d.x * d.x + d.y * d.y + d.z * d.z);
            d = {d.x * norm, d.y * norm, d.z * norm};
        }
        return {0, weight};
    }

    const TracedLayer& layer_at(double depth) const {
        std::size_t i = 0;
        while (depth > media_[i].end) ++i;
        return *media_[i].layer;
    }

    void look(const ScatteringLaw& law, const Direction& d, double depth, double weight) {
        for (std::size_t i = 0; i < eyes_.size(); ++i) {
            const Direction& eye = eyes_[i];
            const double cos_theta = std::clamp(d.x * eye.x + d.y * eye.y + d.z * eye.z, -1.0, 1.0);
            const double mu = -eye.z;
            seen_[i] += weight * law.value(cos_theta) * std::exp(-depth / mu) / (4 * mu);
        }
    }

    std::vector<Medium> media_;
    TracerOptions options_;
    double mu_in_;
    std::vector<Direction> eyes_;
    std::vector<double> seen_;
};

}  // namespace

bool Estimate::agrees_with(double truth, double sigmas, double allowance) const {
    const double missing = truth - value;
    const double noise = sigmas * standard_error + allowance;
    return missing >= -noise && missing <= noise + unfinished;
}

TracedReflection trace_photons(const TracedStack& stack, double mu_in,
                               const std::vector<Detector>& detectors,
                               const TracerOptions& options) {
    require(mu_in > 0 && mu_in <= 1, "mu_in", mu_in, "(0, 1]");
    require(options.photons >= 2, "number of photons", options.photons, "[2, inf)");
    require(options.most_collisions >= 1, "most collisions", options.most_collisions, "[1, inf)");
    return Tracer(stack, mu_in, detectors, options).trace();
}

}  // namespace miebrdf::bench
