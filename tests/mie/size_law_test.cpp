// Laws of size distributions: the list that everyone reads, and one from outside the library.
#include "mie/sizes/size_law.h"

#include <cmath>
#include <numbers>

#include <miebrdf/ensemble.h>
#include <miebrdf/error.h>
#include <miebrdf/sphere.h>
#include "tests/support/catch.h"

using namespace miebrdf;

namespace {

// Gives all radii one geometric cross-section, from a (1 - w) to a (1 + w): effective radius a,
// effective variance w^2 / 3.
double half_width(const mie::SizeDistribution& d) {
    return d.effective_radius_um * std::sqrt(3 * d.effective_variance);
}

class UniformDensity : public mie::AreaDensity {
  public:
    explicit UniformDensity(double half_width) : density_(0.5 / half_width) {}
    double at(double) const override { return density_; }

  private:
    double density_;
};

const mie::SizeLaw kUniform{
    .name = "uniform",
    .help = "n(r) r^2 constant between two ends",
    .range = [](const mie::SizeDistribution& d, double, double) -> mie::RadiusRange {
        return {d.effective_radius_um - half_width(d), d.effective_radius_um + half_width(d)};
    },
    .area_density = [](const mie::SizeDistribution& d) -> std::unique_ptr<const mie::AreaDensity> {
        return std::make_unique<UniformDensity>(half_width(d));
    },
};

}  // namespace

TEST_CASE("a law from outside the library is averaged over like those of the list",
          "[mie][sizes]") {
    mie::EnsembleRequest request;
    request.sizes = {kUniform.kind(), 1.0, 0.1};
    request.refractive_index =
        GENERATE(std::complex<double>(1.5, 0.0), std::complex<double>(1.5, 0.3));
    request.tolerance = 1e-5;
    const auto optics = mie::average_over_sizes(request);
    CHECK(optics.converged);

    // Midpoints, sphere by sphere.
    constexpr int count = 40'000;
    const auto [smallest, largest] = mie::radius_range(request.sizes);
    double extinction = 0, scattering = 0, asymmetry = 0;
    for (int i = 0; i < count; ++i) {
        const double radius = smallest + (largest - smallest) * (i + 0.5) / count;
        const auto sphere =
            mie::scatter_by_sphere(request.refractive_index, 2 * std::numbers::pi * radius / 0.55);
        extinction += sphere.q_ext / count;
        scattering += sphere.q_sca / count;
        asymmetry += sphere.q_sca * sphere.asymmetry / count;
    }
    CAPTURE(request.refractive_index, optics.error_estimate);
    const double bound = 3 * optics.error_estimate + 1e-6;
    CHECK(std::abs(optics.q_ext / extinction - 1) <= bound);
    CHECK(std::abs(optics.single_scattering_albedo / (scattering / extinction) - 1) <= bound);
    CHECK(std::abs(optics.asymmetry - asymmetry / scattering) <= bound);
}

TEST_CASE("laws are known by name, and an unknown name lists them all", "[mie][sizes]") {
    const auto forms = mie::size_distribution_forms();
    REQUIRE(forms.size() >= 4);
    std::string refusal;
    try {
        mie::parse_size_distribution("cubic");
    } catch (const UsageError& error) {
        refusal = error.what();
    }
    CHECK_THAT(refusal, Catch::Contains("'cubic'"));
    for (const auto& form : forms) {
        CAPTURE(form.name);
        CHECK(name_of(mie::parse_size_distribution(form.name)) == form.name);
        CHECK_THAT(refusal, Catch::Contains(form.name));
        CHECK_FALSE(form.help.empty());
    }
    CHECK(mie::parse_size_distribution("gamma") == mie::SizeDistributionKind::gamma);
    CHECK_THROWS_AS(mie::parse_size_distribution("tabulated"), UsageError);
    CHECK_FALSE(has_variance(mie::SizeDistributionKind::mono));
    CHECK_FALSE(has_variance(mie::SizeDistributionKind::tabulated));
}

TEST_CASE("beyond its forward radius a law without ends has the share of n r^4 asked for",
          "[mie][sizes]") {
    const char* name = GENERATE("gamma", "log-normal", "rosin-rammler");
    const double variance = GENERATE(0.05, 0.8), share = GENERATE(1e-2, 1e-5);
    const mie::SizeDistribution sizes{mie::parse_size_distribution(name), 1.0, variance};
    const double radius = mie::SizeLaw::of(sizes.kind).forward_radius_um(sizes, share);
    const auto density = mie::area_density(sizes);
    // Midpoints in ln r, from the radius downwards and upwards: what is left out errs by step^2.
    constexpr double step = 1e-3;
    const auto sum = [&](double sign) {
        double total = 0;
        for (int i = 0; i < 30'000; ++i) {
            const double r = radius * std::exp(sign * step * (i + 0.5));
            total += step * r * r * r * density->at(r);
        }
        return total;
    };
    const double above = sum(1), below = sum(-1);
    CAPTURE(name, variance, radius);
    CHECK(std::abs(above / (above + below) / share - 1) <= 1e-3);
}
