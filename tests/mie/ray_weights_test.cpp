// Sizes weighted for what is known to interfere.
#include "mie/ensemble/ray_weights.h"

#include <cmath>
#include <complex>
#include <numbers>
#include <optional>
#include <vector>

#include <miebrdf/ensemble.h>
#include "mie/ensemble/ray_columns.h"
#include "mie/ensemble/ray_phase.h"
#include "mie/sphere/radial_functions.h"
#include "tests/support/catch.h"

using namespace miebrdf;
using Complex = std::complex<double>;
using Kind = mie::SizeDistributionKind;

namespace {

constexpr double kWaveNumberPerUm = 2 * std::numbers::pi / 0.55;

struct RaysOfSizes {
    mie::Ensemble ensemble;
    std::optional<mie::RayWindow> window;

    RaysOfSizes(Kind kind, double index, bool windowed) {
        ensemble.scatterer = std::complex<double>(index);
        ensemble.sizes.effective_radius_um = 40;
        ensemble.sizes.effective_variance = 0.15;
        ensemble.sizes.kind = kind;
        ensemble.range = mie::radius_range(ensemble.sizes);
        ensemble.wave_number_per_um = kWaveNumberPerUm;
        if (windowed) window.emplace(index, ensemble.smallest_x(), ensemble.largest_x());
    }
    mie::RaySizes sizes() const { return {ensemble, window}; }
};

// |S+|^2 + |S-|^2 of rays of some ways, with weights of their own at each angle or without.
Eigen::VectorXd intensity_of(Complex m, int way, const mie::WeightedSizes& sizes,
                             const mie::AngularFunctionsOf<float>& angular,
                             const std::vector<Eigen::VectorXd>* factors) {
    using Angular = mie::AngularFunctionsOf<float>;
    const mie::RayGroup group{way, way};
    const auto count = static_cast<int>(sizes.parameters.size());
    mie::SphereBlockOf<float> block;
    mie::RayColumns columns{&group, &block};
    mie::put_rays(m, sizes, 0, count, {&columns, 1});
    Eigen::VectorXd sum = Eigen::VectorXd::Zero(angular.angle_count());
    if (block.size == 0) return sum;
    if (factors == nullptr) {
        angular.add_intensity(block, sum);
        return sum;
    }
    Angular::Factors all = Angular::Factors::Zero(angular.angle_count(), block.size);
    for (int angle = 0; angle < angular.angle_count(); ++angle)
        all.row(angle).head(count) = (*factors)[angle].cast<float>();
    angular.add_intensity(block, all, sum);
    return sum;
}

}  // namespace

TEST_CASE("weights for rays give interference the mean that it has over all sizes", "[mie][rays]") {
    const Kind kind = GENERATE(Kind::power_law, Kind::gamma, Kind::log_normal);
    const bool windowed = GENERATE(false, true);
    if (windowed && kind != Kind::power_law) return;
    const double index = 2.9;
    const RaysOfSizes rays(kind, index, windowed);
    const mie::RaySizes sizes = rays.sizes();
    const mie::RayInterference interference(index, sizes);
    const mie::WeightedSizes few = sizes.of(mie::RayGroup{4, 4}.sizes_at(1), 1);
    int rates = 0;
    for (double theta_deg = 160; theta_deg <= 180; theta_deg += 2.5) {
        const auto terms = interference.terms(4, theta_deg * std::numbers::pi / 180);
        const Eigen::VectorXd factors = interference.factors(terms, interference.sampled(few));
        for (const double rate : terms.rates) {
            // Midpoints, many to a period.
            Complex exact = 0, sampled = 0;
            double area = 0, sampled_area = 0;
            constexpr int steps = 100000;
            const double width = sizes.largest_x() - sizes.smallest_x();
            for (int i = 0; i < steps; ++i) {
                const double x = sizes.smallest_x() + width * (i + 0.5) / steps;
                const double share = sizes.area_at(x);
                exact += share * std::polar(1.0, rate * x);
                area += share;
            }
            for (std::size_t i = 0; i < few.parameters.size(); ++i) {
                const double x = few.parameters[i], share = few.weights[i] * x * x;
                sampled += share * factors[i] * std::polar(1.0, rate * x);
                sampled_area += share;
            }
            CAPTURE(mie::name_of(kind), windowed, theta_deg, rate);
            // Conditions may be missed by so much, and the second of two rates that are nearly one.
            CHECK(std::abs(sampled / sampled_area - exact / area) <= 3e-3);
            ++rates;
        }
    }
    CHECK(rates >= 9);
}

TEST_CASE("weights for rays give P of few sizes what many sizes give it", "[mie][rays]") {
    struct Case {
        double index;
        int way;
        double first_deg, last_deg;
    };
    // Bows and what lies behind them, glories, light reflected beside the diffracted one.
    const Case c = GENERATE(Case{2.9, 4, 158, 180}, Case{1.5, 2, 155, 180}, Case{2.6, 0, 2, 20},
                            Case{2.2, 3, 0.5, 30});
    const Kind kind = GENERATE(Kind::power_law, Kind::gamma);
    const RaysOfSizes rays(kind, c.index, false);
    const mie::RaySizes sizes = rays.sizes();
    const mie::RayInterference interference(c.index, sizes);
    std::vector<double> angles_deg;
    for (int i = 0; i <= 40; ++i)
        angles_deg.push_back(c.first_deg + (c.last_deg - c.first_deg) * i / 40);
    const mie::AngularFunctionsOf<float> angular(angles_deg,
                                                 mie::number_of_terms(sizes.largest_x()));
    const auto of = [&](int level, int family, bool weighted) {
        const mie::WeightedSizes own =
            sizes.of(mie::RayGroup{c.way, c.way}.sizes_at(level), family);
        std::vector<Eigen::VectorXd> factors;
        for (const double angle : angles_deg)
            factors.push_back(
                interference.factors(interference.terms(c.way, angle * std::numbers::pi / 180),
                                     interference.sampled(own)));
        return intensity_of(c.index, c.way, own, angular, weighted ? &factors : nullptr);
    };
    // 24 sizes against 768 without weights.
    const Eigen::VectorXd exact = of(6, 0, false);
    const Eigen::VectorXd plain = of(1, 0, false), weighted = of(1, 0, true);
    // P of all rays is of the order of 1; the area of all sizes is 1.
    const Eigen::VectorXd scale = exact.cwiseMax(0.5);
    const double without = (plain - exact).cwiseQuotient(scale).norm() / std::sqrt(41.0);
    const double with = (weighted - exact).cwiseQuotient(scale).norm() / std::sqrt(41.0);
    CAPTURE(c.index, c.way, mie::name_of(kind), without, with);
    CHECK(with <= 1e-2);
    CHECK(with <= 0.35 * without);
}
