// Averages at some of many wavelengths, and what lies between, against averages of their own.
#include <cmath>
#include <memory>
#include <vector>

#include "pipeline/solve/optics_memo.h"
#include "pipeline/solve/resolved_scene.h"
#include "pipeline/solve/resolver.h"
#include "pipeline/solve/sampled_line.h"
#include "pipeline/solve/sampled_spectrum.h"
#include "tests/support/catch.h"
#include "tests/support/scenes.h"

using namespace miebrdf;

namespace {

using Doubles = std::vector<double>;

Doubles every(double first, double last, double step) {
    Doubles all;
    for (double at = first; at <= last; at += step) all.push_back(at);
    return all;
}

/// Counts what is computed.
class Counter : public OpticsStore {
  public:
    std::optional<Doubles> find(const std::string&) override { return std::nullopt; }
    void store(const std::string&, const Doubles&) override { ++computed; }

    int computed = 0;
};

OpticsDemand demand(double tolerance) {
    OpticsDemand demand;
    demand.highest_moment = 32;
    demand.tolerance = tolerance;
    return demand;
}

mie::EnsembleOptics numbers_of(const MediumOptics& of) {
    mie::EnsembleOptics optics;
    optics.single_scattering_albedo = of.optics.single_scattering_albedo;
    optics.one_minus_albedo = of.optics.one_minus_albedo;
    optics.q_ext = *of.q_ext;
    optics.asymmetry = of.asymmetry;
    optics.chi = of.optics.chi;
    return optics;
}

/// Sampled spectra beside averages to a tenth of the tolerance, at every wavelength.
struct Judged {
    double beyond = 0.0;  ///< the largest error over what it may be
    int computed = 0;
};

/// Errors of averages come through between their places with Lagrange's weights, whose magnitudes
/// add up to 1.25 at most; what they really are, not what they state, is measured here. The rest is
/// what is stated.
Judged judge(const ResolvedSpecies& species, double tolerance) {
    const auto counter = std::make_shared<Counter>();
    Control control;
    control.threads = 1;
    control.memo = std::make_shared<OpticsMemo>(std::size_t{1} << 28, counter);
    double of_averages = 0.0;
    std::vector<double> errors, stated;
    for (std::size_t w = 0; w < species.particles.size(); ++w) {
        const auto truth = numbers_of(compute_optics(species, w, demand(0.1 * tolerance)));
        const auto error = [&](const MediumOptics& of) {
            return mie::difference_between(numbers_of(of), truth);
        };
        of_averages = std::max(of_averages, error(compute_optics(species, w, demand(tolerance))));
        const MediumOptics sampled =
            averaged_optics(control, species, w, demand(tolerance), mie::run_in_order);
        errors.push_back(error(sampled));
        stated.push_back(sampled.error_estimate);
    }
    Judged judged;
    for (std::size_t w = 0; w < errors.size(); ++w)
        judged.beyond = std::max(judged.beyond, errors[w] / (1.25 * of_averages + stated[w]));
    judged.computed = counter->computed;
    return judged;
}

ResolvedSpecies species_of(const std::string& words, const Doubles& nm) {
    return resolve(support::scene_of(words), nm).media.front().species.front();
}

}  // namespace

TEST_CASE("optics between the wavelengths that are computed err by what they state",
          "[pipeline][spectrum]") {
    const std::pair<const char*, double> scene =
        GENERATE(std::pair("Fe2O3,radius=0.5,variance=0.3,distribution=log-normal", 500),
                 std::pair("TiO2,radius=0.13,variance=0.2", 430),
                 std::pair("SiO2,radius=0.4,variance=0.2,coating=Fe2O3@20nm", 500),
                 std::pair("H2O_ice,radius=20,variance=0.2", 1450));
    CAPTURE(scene.first);
    const Doubles nm = every(scene.second, scene.second + 120, 1.0);
    const Judged judged = judge(species_of(scene.first, nm), 1e-3);
    CHECK(judged.beyond <= 1.0);
    CHECK(judged.computed <= 60);  // of 121
}

TEST_CASE("a band of absorption between the first wavelengths is not missed",
          "[pipeline][spectrum]") {
    ResolvedSpecies species = species_of(
        "index:1.5,1e-4,radius=2,variance=0.3,distribution=log-normal", every(600, 720, 0.5));
    for (std::size_t w = 0; w < species.particles.size(); ++w) {
        Particles& at = species.particles[w];
        const double off = (at.wavelength_nm - 653.0) / 2.0;
        at.index = {1.5, 1e-3 + 0.05 * std::exp(-off * off)};
    }
    species.spectrum = spectrum_of(species);
    for (std::size_t w = 0; w < species.particles.size(); ++w)
        species.key[w] = species_key(species, w);
    const Judged judged = judge(species, 1e-3);
    CHECK(judged.beyond <= 1.0);
    CHECK(judged.computed <= 180);  // of 241
}

TEST_CASE("few wavelengths, sizes without a width and phase functions are not interpolated",
          "[pipeline][spectrum]") {
    CHECK_FALSE(species_of("Fe2O3,radius=0.5", every(500, 599, 1.0)).spectrum);
    const Doubles many = every(500, 601, 1.0);
    CHECK(species_of("Fe2O3,radius=0.5", many).spectrum);
    CHECK_FALSE(species_of("Fe2O3,radius=0.5,distribution=mono", many).spectrum);
    const ResolvedSpecies species = species_of("Fe2O3,radius=0.5", many);
    Control control;
    CHECK_FALSE(is_sampled(control, species, demand(1e-3)));  // nowhere to keep it
    control.memo = make_optics_memo();
    CHECK(is_sampled(control, species, demand(1e-3)));
    OpticsDemand whole = demand(1e-3);
    whole.whole_phase_function = true;
    CHECK_FALSE(is_sampled(control, species, whole));
    // A value that may be interpolated is another one for the cache.
    CHECK(species.key[0] != species_of("Fe2O3,radius=0.5", {500}).key[0]);
}

TEST_CASE("spectra have the same bits for any number of threads and any order of wavelengths",
          "[pipeline][spectrum]") {
    Scene scene = support::scene_of("Fe2O3,radius=0.5,variance=0.3");
    Doubles nm = every(600, 720, 1.0);
    const auto albedos = [&](int threads) {
        Control control;
        control.threads = threads;
        return solve(scene, nm, {.tolerance = 1e-2, .stokes = 1}, control).albedo({0.7});
    };
    const AlbedoValues one = albedos(1), two = albedos(2);
    CHECK(one.spherical_albedo == two.spherical_albedo);
    std::reverse(nm.begin(), nm.end());
    Doubles back = albedos(2).spherical_albedo;
    std::reverse(back.begin(), back.end());
    CHECK(back == one.spherical_albedo);
}

TEST_CASE("a sampled line is as fine as its function asks, and noise has all of it computed",
          "[pipeline][spectrum]") {
    const Doubles line = every(0.0, 10.0, 0.01);
    const auto sampled = [&](double (*function)(double), double allowed) {
        const auto compute = [&](const std::vector<std::size_t>& places) {
            Doubles values;
            for (const std::size_t place : places) values.push_back(function(line[place]));
            return values;
        };
        const auto misfit = [&](const CubicStencil& stencil, std::span<const std::size_t>,
                                std::span<const double> around, std::size_t, double computed) {
            double expected = 0.0;
            for (std::size_t i = 0; i < stencil.count; ++i)
                expected += stencil.weight[i] * around[i];
            return std::abs(expected - computed) / allowed;
        };
        return sample_line<double>(line, {0, 250, 500, 750, line.size() - 1}, compute, misfit);
    };
    const auto worst = [&](const SampledLine<double>& of, double (*function)(double)) {
        Doubles known;
        for (const std::size_t place : of.places) known.push_back(line[place]);
        double largest = 0.0;
        for (const double x : line) {
            const CubicStencil s = cubic_at(known, x);
            double value = 0.0;
            for (std::size_t i = 0; i < s.count; ++i) value += s.weight[i] * of.values[s.first + i];
            largest = std::max(largest, std::abs(value - function(x)));
        }
        return largest;
    };
    double (*const wave)(double) = [](double x) { return std::sin(x); };
    const auto of_wave = sampled(wave, 1e-4);
    CHECK(worst(of_wave, wave) <= 0.5e-4);
    // In the middle of a gap h cubics miss by 9/384 h^4: 2.5 / 16 is small enough, and is halved.
    CHECK(of_wave.places.size() <= 129);
    double (*const bend)(double) = [](double x) { return std::abs(x - 3.337); };
    CHECK(worst(sampled(bend, 1e-2), bend) <= 0.5e-2);
    double (*const noise)(double) = [](double x) { return std::sin(1e6 * x * x); };
    CHECK(sampled(noise, 1e-2).places.size() == line.size());
}
