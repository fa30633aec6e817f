// Derivatives by sizes and indices of spheres: of sums over fixed radii, against averages that
// choose theirs anew.
#include <miebrdf/brdf.h>
#include <miebrdf/database.h>
#include <miebrdf/ensemble.h>

#include <cmath>
#include <complex>
#include <string>
#include <utility>
#include <vector>

#include "tests/support/catch.h"

using namespace miebrdf;

namespace {

mie::EnsembleRequest spheres(const char* law, double radius_um, double variance, double n,
                             double k) {
    mie::EnsembleRequest request;
    request.sizes.kind = mie::parse_size_distribution(law);
    request.sizes.effective_radius_um = radius_um;
    request.sizes.effective_variance = variance;
    request.refractive_index = {n, k};
    request.highest_moment = 12;
    request.tolerance = 1e-8;
    return request;
}

}  // namespace

TEST_CASE("averages differ as those that choose their own radii", "[derivatives][mie]") {
    // Absorbing and small spheres, whose averages converge to rounding.
    const std::string law = GENERATE("power-law", "gamma", "log-normal", "mono");
    const int number = GENERATE(0, 1, 2, 3);
    if (law == "mono" && number == 1) return;
    const auto at = [&](double steps) {
        const double h = 2e-4 * steps;
        return spheres(law.c_str(), 0.4 * (number == 0 ? 1 + h : 1),
                       0.1 * (number == 1 ? 1 + h : 1), 1.5 * (number == 2 ? 1 + h : 1),
                       0.5 * (number == 3 ? 1 + h : 1));
    };
    const auto difference = mie::differences_of_averages(
        at(0), {{at(1e-2), at(-1e-2)}}, {.highest_moment = 12, .phase_table = nullptr})[0];
    const auto plus = mie::average_over_sizes(at(1)), minus = mie::average_over_sizes(at(-1));
    CAPTURE(law, number);
    // Their own second order and the tails that the laws leave out.
    const auto agrees = [](double small, double large, double scale) {
        CAPTURE(small, large);
        CHECK(std::abs(100 * small - large) <= 1e-4 * scale);
    };
    const double scale = 4e-4 * std::max(1.0, plus.q_ext);
    agrees(difference.q_ext, plus.q_ext - minus.q_ext, scale);
    agrees(difference.one_minus_albedo, plus.one_minus_albedo - minus.one_minus_albedo, scale);
    agrees(difference.single_scattering_albedo,
           plus.single_scattering_albedo - minus.single_scattering_albedo, scale);
    REQUIRE(difference.chi.size() == 13);
    for (std::size_t l = 0; l <= 12; ++l)
        agrees(difference.chi[l], plus.chi[l] - minus.chi[l], scale);
}

TEST_CASE("differences of several changes are those of each", "[derivatives][mie]") {
    // Rippling spheres in single precision: one pass serves all laws, waves are differenced.
    const std::string law = GENERATE("power-law", "gamma");
    const auto at = [&](double radius, double variance, double n, double k) {
        auto request = spheres(law.c_str(), 1.5 * radius, 0.1 * variance, 1.5 * n, 1e-3 * k);
        request.tolerance = 1e-4;
        request.with_phase_table = true;
        return request;
    };
    const auto middle = at(1, 1, 1, 1);
    const auto table = mie::average_over_sizes(middle).phase_table;
    constexpr double h = 1e-5;
    const std::vector<mie::EnsembleChange> changes{{at(1 + h, 1, 1, 1), at(1 - h, 1, 1, 1)},
                                                   {at(1, 1 + h, 1, 1), at(1, 1 - h, 1, 1)},
                                                   {at(1, 1, 1 + h, 1), at(1, 1, 1 - h, 1)},
                                                   {at(1, 1, 1, 1 + h), at(1, 1, 1, 1 - h)}};
    const mie::DifferenceDemand demand{.highest_moment = 12, .phase_table = table.get()};
    const auto together = mie::differences_of_averages(middle, changes, demand);
    for (std::size_t c = 0; c < changes.size(); ++c) {
        CAPTURE(law, c);
        const auto alone = mie::differences_of_averages(middle, {changes[c]}, demand).front();
        // Twice as large a change: products in single precision, and its second order.
        auto both = changes[c];
        const auto twice = [&](mie::EnsembleRequest& side) {
            side.sizes.effective_radius_um += side.sizes.effective_radius_um - 1.5;
            side.sizes.effective_variance += side.sizes.effective_variance - 0.1;
            side.refractive_index += side.refractive_index - middle.refractive_index;
        };
        twice(both.plus);
        twice(both.minus);
        const auto doubled = mie::differences_of_averages(middle, {both}, demand).front();
        const auto agree = [&](double a, double b, double c2, double scale) {
            CHECK(std::abs(a - b) <= 1e-6 * h * scale);
            CHECK(std::abs(2 * a - c2) <= 1e-4 * h * scale);
        };
        agree(together[c].q_ext, alone.q_ext, doubled.q_ext, 10);
        agree(together[c].one_minus_albedo, alone.one_minus_albedo, doubled.one_minus_albedo, 10);
        for (std::size_t l = 0; l <= 12; ++l)
            agree(together[c].chi[l], alone.chi[l], doubled.chi[l], 10);
        // P rises or falls with its moments.
        double mean = 0.0, first = 0.0;
        constexpr int nodes = 20000;
        for (int i = 0; i < nodes; ++i) {
            const double cosine = (i + 0.5) / nodes * 2 - 1;
            const double P = (*together[c].phase_table)(cosine);
            mean += P / nodes;
            first += P * cosine / nodes;
        }
        CHECK(std::abs(mean) <= 1e-3 * h * 10);
        CHECK(std::abs(first - together[c].chi[1]) <= 1e-3 * h * 10);
    }
}

TEST_CASE("sharp ends of clear spheres are told without their ripple", "[derivatives][mie]") {
    const int number = GENERATE(0, 1);
    const auto at = [&](double change) {
        auto request = spheres("power-law", 100 * (number == 0 ? 1 + change : 1),
                               0.1 * (number == 1 ? 1 + change : 1), 1.3015, 2.1e-6);
        request.wavelength_nm = 1030;
        request.tolerance = 1e-4;
        return request;
    };
    const auto slope =
        mie::differences_of_averages(at(0), {{at(1e-5), at(-1e-5)}}, {.highest_moment = 12})[0];
    // So far apart averages do not see single resonances.
    const auto plus = mie::average_over_sizes(at(0.02)), minus = mie::average_over_sizes(at(-0.02));
    const double change = std::log(plus.one_minus_albedo / minus.one_minus_albedo) / 0.04;
    const double share =
        slope.one_minus_albedo / 2e-5 / mie::average_over_sizes(at(0)).one_minus_albedo;
    CAPTURE(number, change, share);
    CHECK(std::abs(share - change) <= 5e-3);
}

TEST_CASE("large spheres of many sizes differ as their rays do", "[derivatives][mie]") {
    // Averages of 1e-3 are over rays, those of 1e-7 over thousands of spheres.
    const int number = GENERATE(0, 1, 2, 3);
    const auto at = [&](double change, double tolerance) {
        const auto times = [&](int which) { return number == which ? 1 + change : 1; };
        auto request =
            spheres("log-normal", 20 * times(0), 0.2 * times(1), 1.31 * times(2), 1e-4 * times(3));
        request.wavelength_nm = 1000;
        request.tolerance = tolerance;
        return request;
    };
    const auto difference =
        mie::differences_of_averages(at(0, 1e-3), {{at(1e-5, 1e-3), at(-1e-5, 1e-3)}},
                                     {.highest_moment = 12, .phase_table = nullptr})[0];
    constexpr double step = 1e-3;
    const auto plus = mie::average_over_sizes(at(step, 1e-7)),
               minus = mie::average_over_sizes(at(-step, 1e-7));
    CAPTURE(number);
    // Truth has errors of 1e-7 over its step.
    const auto agrees = [&](double small, double plus_side, double minus_side) {
        const double slope = small / 2e-5, truth = (plus_side - minus_side) / (2 * step);
        CAPTURE(slope, truth);
        CHECK(std::abs(slope - truth) <= 2e-4);
    };
    agrees(difference.one_minus_albedo, plus.one_minus_albedo, minus.one_minus_albedo);
    agrees(difference.q_ext, plus.q_ext, minus.q_ext);
    for (std::size_t l = 0; l <= 12; ++l) agrees(difference.chi[l], plus.chi[l], minus.chi[l]);
}

TEST_CASE("scenes of spheres have derivatives by radius, variance, n and k", "[derivatives][mie]") {
    Scene scene;
    say(scene, "substrate", {"lambert:0.2"});
    say(scene, "coat",
        {"index:{n=2.4},{k=0.002},radius={r=0.13},variance={v=0.2},distribution=log-normal,"
         "volume={c=5}% in index:1.5@{d=20}um"});
    const Directions directions{{0.5}, {0.7}, {30.0}};
    SolverOptions options;
    options.tolerance = 1e-5;
    options.streams = 16;
    const std::vector<NamedNumber> numbers = named_numbers(scene);
    std::vector<std::string> names;
    for (const NamedNumber& number : numbers) names.push_back(number.name);
    const auto derivatives = solve(scene, {600}, options).derivatives(names);
    const auto albedos = derivatives.albedo({0.5});
    const auto values = derivatives.evaluate(directions);
    for (std::size_t p = 0; p < numbers.size(); ++p) {
        const double h = 5e-3 * numbers[p].value;
        const auto at = [&](double steps) {
            const Brdf brdf = solve(with_values(scene, {{names[p], numbers[p].value + steps * h}}),
                                    {600}, options);
            return std::pair(brdf.albedo({0.5}).at(0, 0), brdf.evaluate(directions).at(0, 0, 0, 0));
        };
        const auto [albedo_plus, value_plus] = at(1);
        const auto [albedo_minus, value_minus] = at(-1);
        CAPTURE(names[p]);
        const auto agrees = [&](double derivative, double plus, double minus, double scale) {
            const double truth = (plus - minus) / (2 * h);
            CAPTURE(derivative, truth);
            CHECK(std::abs(numbers[p].value * (derivative - truth)) <= 2e-3 * scale);
        };
        // The error of such differences: averages of 1e-6 over steps of .5 %, and third orders.
        agrees(albedos.derivatives[p].at(0, 0), albedo_plus, albedo_minus, albedos.values.at(0, 0));
        agrees(values.derivatives[p].at(0, 0, 0, 0), value_plus, value_minus,
               values.values.at(0, 0, 0, 0));
    }
}

TEST_CASE("scenes of grains have derivatives by sizes, indices and shapes", "[derivatives][mie]") {
    // Absorbing enough for averages that converge to rounding: those of clear spheres do not, and
    // differences of such averages err by as much as the derivatives (docs/derivatives.md).
    const std::string shape = GENERATE("shape=hexagonal-plate,aspect={a=2.5},absorption={b=1.6}",
                                       "phase=double-henyey-greenstein,asymmetry={g=0.8}");
    Scene scene;
    say(scene, "substrate", {"lambert:0.2"});
    say(scene, "coat",
        {"index:{n=1.6},{k=0.03},radius={r=2},variance={v=0.2},distribution=log-normal," + shape +
         ",volume={c=5}%@{d=60}um"});
    SolverOptions options;
    options.tolerance = 1e-6;
    options.streams = 16;
    scene.particles.tolerance = 1e-7;
    const std::vector<NamedNumber> numbers = named_numbers(scene);
    std::vector<std::string> names;
    for (const NamedNumber& number : numbers) names.push_back(number.name);
    REQUIRE(names.size() == (shape.front() == 's' ? 8 : 7));
    const auto albedos = solve(scene, {900}, options).derivatives(names).albedo({0.5});
    for (std::size_t p = 0; p < numbers.size(); ++p) {
        const double h = 2e-3 * numbers[p].value;
        const auto at = [&](double steps) {
            return solve(with_values(scene, {{names[p], numbers[p].value + steps * h}}), {900},
                         options)
                .albedo({0.5})
                .at(0, 0);
        };
        const double truth = (at(1) - at(-1)) / (2 * h);
        CAPTURE(names[p], truth);
        // Two averages of 1e-7 over twice a step of .2 % are 5e-5; third orders 4e-6.
        CHECK(std::abs(numbers[p].value * (albedos.derivatives[p].at(0, 0) - truth)) <=
              1e-4 * albedos.values.at(0, 0));
    }
}

TEST_CASE("n(NAME) and k(NAME) are those of the material at the wavelength", "[derivatives][mie]") {
    Scene named, numbers;
    say(named, "base", {"AlGaAs7,radius=0.5,variance=0.1"});
    const materials::Database database = materials::Database::embedded();
    const std::complex<double> index = database.refractive_index("AlGaAs7").at(500);
    const auto digits = [](double value) { return std::to_string(value); };
    say(numbers, "base",
        {"index:{n=" + digits(index.real()) + "},{k=" + digits(index.imag()) +
         "},radius=0.5,variance=0.1"});
    const auto by_name = solve(named, {450, 500}).derivatives({"n(AlGaAs7)", "k(AlGaAs7)"});
    const auto by_number = solve(numbers, {500}).derivatives({"n", "k"});
    const auto a = by_name.albedo({0.5}), b = by_number.albedo({0.5});
    for (std::size_t p = 0; p < 2; ++p) {
        // The numbers have six digits after the point.
        CHECK(a.derivatives[p].at(1, 0) == Approx(b.derivatives[p].at(0, 0)).epsilon(1e-4));
    }
}
