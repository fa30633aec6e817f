// Closed forms of derivatives against differences of the same discrete equations, over random
// stacks.
#include <algorithm>
#include <cmath>
#include <cstdint>
#include <optional>
#include <random>
#include <vector>

#include "rte/derivatives/frozen_stack.h"
#include "rte/derivatives/stack_derivatives.h"
#include "rte/stack/layered_reflection.h"
#include "tests/support/catch.h"

using namespace miebrdf;

namespace {

/// Numbers of a stack, and the stack that they make: half-spaces, grounds, nothing, metals or air
/// below one or two layers, bare or below smooth and rough boundaries of one host or two.
struct RandomStack {
    enum Below { half_space, ground, nothing, metal, film };
    static constexpr std::size_t kIndices = 9;  ///< of the first number that is a host's
    Below below;
    bool has_second_layer, is_conservative, is_polarised;
    std::optional<rte::Boundary> boundary;
    bool has_two_hosts;
    std::vector<double> numbers;

    explicit RandomStack(std::uint32_t seed, bool polarised = false)
        : below(Below(seed % 5)), is_polarised(polarised) {
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
                   0.3 * std::pow(10, 1.5 * uniform()),
                   1.2 + 0.5 * uniform(),
                   1.2 + 0.5 * uniform()};
        const double kind = uniform();
        has_two_hosts = uniform() < 0.4;
        if (kind < 0.35) return;
        boundary = rte::Boundary{};
        // 50 ms of facets for each index.
        if (!polarised && seed % 7 == 0) boundary->roughness = 0.1 + 0.4 * uniform();
    }

    rte::Optics medium(double albedo, double g) const {
        if (is_polarised) return rte::rayleigh_optics(albedo, 0.3 * (1.0 + g));
        return rte::henyey_greenstein_optics(albedo, g);
    }

    rte::Stack with(const std::vector<double>& v) const {
        rte::Stack stack;
        stack.boundary = boundary;
        const double lower = v[kIndices], upper = has_two_hosts ? v[kIndices + 1] : lower;
        if (below == half_space) {
            stack.base = medium(v[0], v[1]);
            stack.base_index = lower;
        } else if (below == metal || below == film) {
            stack.base_kind = rte::BaseKind::mirror;
            if (below == metal) stack.mirror_index = {1.2, 3.0 * v[5]};
        } else {
            stack.base_kind = below == ground ? rte::BaseKind::lambertian : rte::BaseKind::none;
            stack.ground_albedo = below == ground ? v[5] : 0.0;
        }
        stack.coats.push_back({medium(v[2], v[3]), v[4], has_second_layer ? lower : upper});
        if (!has_second_layer) return stack;
        const double albedo = is_conservative ? 1.0 : v[6];
        stack.coats.push_back({medium(albedo, v[7]), v[8], upper});
        return stack;
    }

    /// Differences by indices have more nodes then, and are not those of these equations.
    bool has_close_hosts() const {
        const auto [low, high] = std::minmax(numbers[kIndices], numbers[kIndices + 1]);
        return boundary && has_two_hosts && high < 1.06 * low;
    }

    /// Whether a number moves nodes or mirrors, whose derivatives are differences.
    bool is_differenced(std::size_t number) const {
        if (number >= kIndices) return boundary || below == metal || below == film;
        return number == 5 && below == metal;
    }
};

std::vector<double> slope(std::vector<double> plus, const std::vector<double>& minus,
                          double apart) {
    for (std::size_t k = 0; k < plus.size(); ++k) plus[k] = (plus[k] - minus[k]) / apart;
    return plus;
}

std::vector<double> all_of(const rte::AlbedoTable& table) {
    std::vector<double> all = table.plane_albedo;
    all.insert(all.end(), table.polarised_plane_albedo.begin(), table.polarised_plane_albedo.end());
    all.push_back(table.spherical_albedo);
    all.insert(all.end(), table.transmittance.begin(), table.transmittance.end());
    return all;
}

}  // namespace

namespace {

struct Truth {
    std::vector<double> value;
    std::vector<double> known_to;  ///< of each value; empty: all digits count
};

struct Worst {
    double error = 0.0, of_differences = 0.0, largest = 0.0, doubt = 0.0;

    /// What the truth itself is not known to is no error.
    void compare(double number, const std::vector<double>& found, const Truth& truth,
                 bool is_differenced) {
        double& worst = is_differenced ? of_differences : error;
        REQUIRE(found.size() == truth.value.size());
        for (std::size_t k = 0; k < found.size(); ++k) {
            largest = std::max(largest, std::abs(number * truth.value[k]));
            const double unknown = truth.known_to.empty() ? 0.0 : truth.known_to[k];
            doubt = std::max(doubt, std::abs(number) * unknown);
            const double here = std::abs(number) * (std::abs(found[k] - truth.value[k]) - unknown);
            if (!(here <= worst)) worst = here;
        }
    }
};

void compare_with_differences(const RandomStack& random, const rte::SolvedLight& light,
                              const rte::SolverReport& solved, Worst& of_reflections,
                              Worst& of_albedos) {
    rte::SolverOptions options;
    options.streams = solved.streams;
    const rte::Directions directions{{0.3, 1.0, 0.62}, {0.2, 0.9, 0.3}, {0.0, 70.0, 180.0}};
    const rte::Stack stack = random.with(random.numbers);
    const bool transmits = random.below != RandomStack::half_space;
    const rte::AlbedoQuestion question{{0.3, 1.0}, light.components > 1 ? 3 : 1, transmits};
    const auto moved = [&](std::size_t p, double by) {
        std::vector<double> numbers = random.numbers;
        numbers[p] += by * std::abs(numbers[p]);
        return random.with(numbers);
    };
    std::vector<rte::StackChange> changes;
    for (std::size_t p = 0; p < random.numbers.size(); ++p) {
        changes.push_back(
            {moved(p, 1e-5), moved(p, -1e-5), 2e-5 * std::abs(random.numbers[p]), {}, {}});
    }
    const rte::FrozenStack frozen(stack, {}, options, solved);
    const auto reflections =
        rte::reflection_derivatives(stack, changes, directions, light, options, solved);
    const auto albedos = rte::albedo_derivatives(stack, changes, question, {}, options, solved);
    const bool is_rough = random.boundary && random.boundary->is_rough();
    const bool has_beams = frozen.scaled().has_mirrors(), is_polarised = light.components > 1;
    const double step = has_beams ? 5e-4 : 1e-5;
    for (std::size_t p = 0; p < changes.size(); ++p) {
        // Facets are samples, and others for another index.
        if (is_rough && p >= RandomStack::kIndices) continue;
        // Those that are differences themselves against better ones, of steps as small: nodes of
        // several media go in steps. Beams of mirrors are extrapolated from cosines 3e-5 apart,
        // which costs digits.
        const bool again = random.is_differenced(p);
        if (again && random.has_close_hosts()) continue;
        const auto truth_of = [&](const auto& ask) -> Truth {
            const auto at = [&](double by) {
                const rte::ScaledStack scaled = frozen.scaled_like(moved(p, by));
                return ask(scaled, frozen.grids_of(scaled));
            };
            const auto symmetric = [&](double h) {
                return slope(at(h), at(-h), 2 * h * std::abs(random.numbers[p]));
            };
            const auto extrapolated = [&](double h) {
                std::vector<double> near = symmetric(h);
                const std::vector<double> far = symmetric(2 * h);
                for (std::size_t k = 0; k < near.size(); ++k) near[k] = (4 * near[k] - far[k]) / 3;
                return near;
            };
            if (again) return {extrapolated(1e-5), {}};
            if (!is_polarised) return {has_beams ? extrapolated(step) : symmetric(step), {}};
            // Some elements of matrices are smooth to seven digits only, and wide steps err where
            // little is absorbed: the middle of five, known to half the way between its neighbours.
            std::vector<std::vector<double>> several;
            for (const double h : {1e-4, 3e-4, 1e-3, 2e-3, 4.9e-3})
                several.push_back(extrapolated(h));
            Truth middle;
            for (std::size_t k = 0; k < several[0].size(); ++k) {
                std::vector<double> here;
                for (const std::vector<double>& one : several) here.push_back(one[k]);
                std::sort(here.begin(), here.end());
                middle.value.push_back(here[2]);
                middle.known_to.push_back(0.5 * (here[3] - here[1]));
            }
            return middle;
        };
        const auto reflection = [&](const rte::ScaledStack& scaled, const rte::StackGrids& grids) {
            return rte::elements_last(
                rte::frozen_reflection(frozen, scaled, grids, directions, light),
                std::size_t(light.shown() * light.shown()), directions.azimuth_deg.size());
        };
        const auto albedo = [&](const rte::ScaledStack& scaled, const rte::StackGrids& grids) {
            return all_of(rte::frozen_albedo(frozen, scaled, grids, question, {}));
        };
        of_reflections.compare(random.numbers[p], reflections[p].reflection, truth_of(reflection),
                               again);
        of_albedos.compare(random.numbers[p], all_of(albedos[p]), truth_of(albedo), again);
    }
}

}  // namespace

TEST_CASE("closed forms are the derivatives of the discrete equations", "[derivatives][rte]") {
    rte::SolverReport solved;
    solved.streams = 12;
    solved.moments = 24;
    solved.fourier_orders = 4;
    for (std::uint32_t seed = 1; seed <= 200; ++seed) {
        const RandomStack random(seed);
        Worst reflections, albedos;
        compare_with_differences(random, {}, solved, reflections, albedos);
        CAPTURE(seed, reflections.of_differences, albedos.of_differences, int(random.below),
                random.boundary.has_value(), random.has_two_hosts, random.has_second_layer,
                reflections.error, reflections.largest, albedos.error, albedos.largest);
        CHECK(reflections.error <= 1e-6 * reflections.largest);
        CHECK(albedos.error <= 1e-6 * albedos.largest);
        // Differences over 2e-5, of values with ten digits.
        CHECK(reflections.of_differences <= 1e-5 * reflections.largest);
        CHECK(albedos.of_differences <= 1e-5 * albedos.largest);
    }
}

TEST_CASE("closed forms are the derivatives of polarised light", "[derivatives][rte]") {
    rte::SolverReport solved;
    solved.streams = 8;
    solved.moments = 3;
    solved.fourier_orders = 3;
    const int components = GENERATE(3, 4);
    for (std::uint32_t seed = 1; seed <= 30; ++seed) {
        const RandomStack random(seed, true);
        // Boundaries and mirrors couple V to U: no closed forms.
        const bool couples = random.boundary || random.below == RandomStack::metal ||
                             random.below == RandomStack::film;
        if (components == 4 && couples) continue;
        Worst reflections, albedos;
        compare_with_differences(random, {components, seed % 2 == 0}, solved, reflections, albedos);
        CAPTURE(seed, reflections.of_differences, albedos.of_differences, int(random.below),
                random.boundary.has_value(), random.has_two_hosts, random.has_second_layer,
                reflections.error, reflections.largest, albedos.error, albedos.largest);
        CHECK(reflections.doubt <= 1e-5 * reflections.largest);
        CHECK(reflections.error <= 1e-6 * reflections.largest);
        CHECK(albedos.error <= 1e-6 * albedos.largest);
        CHECK(albedos.of_differences <= 1e-5 * albedos.largest);
    }
}
