// Closed forms of derivatives against differences of the same discrete equations, over random
// stacks.
#include <algorithm>
#include <cmath>
#include <random>
#include <vector>

#include "rte/derivatives/frozen_stack.h"
#include "rte/derivatives/stack_derivatives.h"
#include "tests/support/catch.h"

using namespace miebrdf;

namespace {

/// Numbers of a stack, and the stack that they make.
struct RandomStack {
    int kind;  ///< of what lies below: a half-space, a ground, nothing
    bool has_second_layer, is_conservative;
    std::vector<double> numbers;

    explicit RandomStack(std::uint32_t seed) : kind(int(seed % 3)) {
        std::mt19937 random(seed);
        const auto uniform = [&] { return double(random()) / 4294967296.0; };
        has_second_layer = uniform() < 0.5;
        is_conservative = uniform() < 0.3;
        numbers = {0.3 + 0.69 * uniform(),
                   -0.3 + 1.1 * uniform(),
                   0.2 + 0.79 * uniform(),
                   0.8 * uniform(),
                   std::pow(10, -2 + 3 * uniform()),
                   0.1 + 0.8 * uniform(),
                   0.5 + 0.49 * uniform(),
                   -0.5 + 1.2 * uniform(),
                   0.3 * std::pow(10, 1.5 * uniform())};
    }

    rte::Stack with(const std::vector<double>& v) const {
        rte::Stack stack;
        if (kind == 0) {
            stack.base = rte::henyey_greenstein_optics(v[0], v[1]);
        } else {
            stack.base_kind = kind == 1 ? rte::BaseKind::lambertian : rte::BaseKind::none;
            stack.ground_albedo = kind == 1 ? v[5] : 0.0;
        }
        stack.coats.push_back({rte::henyey_greenstein_optics(v[2], v[3]), v[4], 1.0});
        if (!has_second_layer) return stack;
        const double albedo = is_conservative ? 1.0 : v[6];
        stack.coats.push_back({rte::henyey_greenstein_optics(albedo, v[7]), v[8], 1.0});
        return stack;
    }
};

std::vector<double> slope(std::vector<double> plus, const std::vector<double>& minus,
                          double apart) {
    for (std::size_t k = 0; k < plus.size(); ++k) plus[k] = (plus[k] - minus[k]) / apart;
    return plus;
}

std::vector<double> all_of(const rte::AlbedoTable& table) {
    std::vector<double> all = table.plane_albedo;
    all.push_back(table.spherical_albedo);
    all.insert(all.end(), table.transmittance.begin(), table.transmittance.end());
    return all;
}

}  // namespace

TEST_CASE("closed forms are the derivatives of the discrete equations", "[derivatives][rte]") {
    rte::SolverReport solved;
    solved.streams = 12;
    solved.moments = 24;
    solved.fourier_orders = 5;
    rte::SolverOptions options;
    options.streams = 12;
    const rte::Directions directions{{0.3, 1.0, 0.62}, {0.2, 0.9}, {0.0, 70.0, 180.0}};
    for (std::uint32_t seed = 1; seed <= 200; ++seed) {
        const RandomStack random(seed);
        const rte::Stack stack = random.with(random.numbers);
        std::vector<rte::StackChange> changes;
        for (std::size_t p = 0; p < random.numbers.size(); ++p) {
            std::vector<double> more = random.numbers, less = more;
            const double h = 1e-5 * std::abs(random.numbers[p]);
            more[p] += h;
            less[p] -= h;
            changes.push_back({random.with(more), random.with(less), 2 * h, {}, {}});
        }
        const rte::FrozenStack frozen(stack, {}, options, solved);
        const rte::AlbedoQuestion question{{0.3, 1.0}, 1, random.kind != 0};
        const auto reflections =
            rte::reflection_derivatives(stack, changes, directions, {}, options, solved);
        const auto albedos = rte::albedo_derivatives(stack, changes, question, {}, options, solved);
        double of_reflections = 0.0, of_albedos = 0.0, largest = 0.0, largest_albedo = 0.0;
        for (std::size_t p = 0; p < changes.size(); ++p) {
            const rte::ScaledStack plus = frozen.scaled_like(changes[p].plus),
                                   minus = frozen.scaled_like(changes[p].minus);
            const auto reflection = [&](const rte::ScaledStack& scaled) {
                return rte::frozen_reflection(frozen, scaled, frozen.grids_of(scaled), directions,
                                              {});
            };
            const auto albedo = [&](const rte::ScaledStack& scaled) {
                return all_of(
                    rte::frozen_albedo(frozen, scaled, frozen.grids_of(scaled), question, {}));
            };
            const auto compare = [&](const std::vector<double>& closed,
                                     const std::vector<double>& truth, double& worst,
                                     double& scale) {
                REQUIRE(closed.size() == truth.size());
                for (std::size_t k = 0; k < truth.size(); ++k) {
                    scale = std::max(scale, std::abs(random.numbers[p] * truth[k]));
                    const double error = std::abs(random.numbers[p] * (closed[k] - truth[k]));
                    if (!(error <= worst)) worst = error;
                }
            };
            compare(reflections[p].reflection,
                    slope(reflection(plus), reflection(minus), changes[p].apart), of_reflections,
                    largest);
            compare(all_of(albedos[p]), slope(albedo(plus), albedo(minus), changes[p].apart),
                    of_albedos, largest_albedo);
        }
        CAPTURE(seed, random.kind, of_reflections, largest, of_albedos, largest_albedo);
        CHECK(of_reflections <= 1e-6 * largest);
        CHECK(of_albedos <= 1e-6 * largest_albedo);
    }
}
