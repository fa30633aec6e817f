// Importance sampling: densities, directions, estimates.
#include <miebrdf/brdf_source.h>
#include <miebrdf/error.h>
#include <miebrdf/sampling.h>

#include <cmath>
#include <numbers>
#include <random>

#include "tests/support/catch.h"

using namespace miebrdf;

namespace {

constexpr double kPi = std::numbers::pi;

/// f = (1 + a mu_out cos(azimuth)) / pi, of albedo 1 for every a: its part with the azimuth
/// integrates to zero.
class Tilted : public BrdfSource {
  public:
    explicit Tilted(double a) : a_(a) {}
    const std::vector<std::string>& channels() const override { return channels_; }
    const std::vector<double>& wavelength_nm() const override { return wavelength_nm_; }
    const Provenance& provenance() const override { return provenance_; }
    void evaluate(std::span<const Direction> directions, std::span<double> values) const override {
        for (std::size_t d = 0; d < directions.size(); ++d)
            values[d] =
                (1 + a_ * directions[d].mu_out * std::cos(directions[d].azimuth_deg * kPi / 180)) /
                kPi;
    }

  private:
    double a_;
    std::vector<std::string> channels_ = {"550 nm"};
    std::vector<double> wavelength_nm_ = {550};
    Provenance provenance_;
};

}  // namespace

TEST_CASE("a white Lambertian surface is sampled by the cosine", "[pipeline][sampling]") {
    const DirectionSampler sampler(Tilted(0.0));
    std::mt19937 random(1);
    std::uniform_real_distribution<double> uniform(0, 1);
    for (int i = 0; i < 1000; ++i) {
        const SampledDirection to =
            sampler.sample(0.01 + 0.99 * uniform(random), uniform(random), uniform(random));
        // All cells have the same probability, to the rounding of their running sum.
        CHECK(to.density == Approx(to.mu_out / kPi).epsilon(1e-9));
        CHECK((to.mu_out > 0 && to.mu_out <= 1 && to.azimuth_deg >= 0 && to.azimuth_deg < 360));
    }
}

TEST_CASE("the density integrates to 1, whatever it was made of", "[pipeline][sampling]") {
    const double a = GENERATE(0.0, 0.9, -3.0);  // the last one has negative values: taken as 0
    const double mu_in = GENERATE(1e-6, 0.3, 1.0);
    const DirectionSampler sampler(Tilted(a), {.incidences = 5, .zeniths = 7, .azimuths = 9});
    // Constant in cells of (mu^2, azimuth) but for mu itself: midpoints are exact.
    constexpr int kZeniths = 70, kAzimuths = 180;
    double sum = 0;
    for (int z = 0; z < kZeniths; ++z) {
        const double mu = std::sqrt((z + 0.5) / kZeniths);
        for (int k = 0; k < kAzimuths; ++k)
            sum += sampler.density(mu_in, mu, (k + 0.5) * 360 / kAzimuths) / (2 * mu);
    }
    CHECK(sum * 2 * kPi / (kZeniths * kAzimuths) == Approx(1.0).epsilon(1e-12));
}

TEST_CASE("estimates by sampling have the right mean and less spread", "[pipeline][sampling]") {
    const Tilted source(0.95);
    const DirectionSampler sampler(source);
    std::mt19937 random(5);
    std::uniform_real_distribution<double> uniform(0, 1);
    constexpr int kCount = 100000;
    double sum = 0, squares = 0;
    for (int i = 0; i < kCount; ++i) {
        const SampledDirection to = sampler.sample(0.5, uniform(random), uniform(random));
        const Direction direction{0.5, to.mu_out, to.azimuth_deg};
        double f = 0;
        source.evaluate({&direction, 1}, {&f, 1});
        const double estimate = f * to.mu_out / to.density;
        sum += estimate;
        squares += estimate * estimate;
    }
    const double mean = sum / kCount;
    const double deviation = std::sqrt(squares / kCount - mean * mean);
    // By the cosine alone it would be 0.95 sqrt(<mu^2> / 2) = 0.475.
    CHECK(deviation <= 0.05);
    CHECK(std::abs(mean - 1) <= 6 * deviation / std::sqrt(double(kCount)));
}

TEST_CASE("sampling refuses what is no direction and no weight", "[pipeline][sampling][errors]") {
    const Tilted source(0.0);
    const DirectionSampler sampler(source);
    const double nan = std::nan("");
    CHECK_THROWS_AS(sampler.sample(0.0, 0.5, 0.5), UsageError);
    CHECK_THROWS_AS(sampler.sample(0.5, 1.0, 0.5), UsageError);
    CHECK_THROWS_AS(sampler.sample(0.5, 0.5, nan), UsageError);
    CHECK_THROWS_AS(sampler.density(0.5, nan, 0), UsageError);
    CHECK_THROWS_AS(sampler.density(0.5, 0.5, nan), UsageError);
    CHECK_THROWS_AS(DirectionSampler(source, {.weights = {1, 1}}), UsageError);
    CHECK_THROWS_AS(DirectionSampler(source, {.weights = {0}}), UsageError);
    CHECK_THROWS_AS(DirectionSampler(source, {.incidences = 1}), UsageError);
}
