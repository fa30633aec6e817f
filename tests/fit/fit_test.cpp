// Fits of values whose scene is known.
#include <miebrdf/colour.h>
#include <miebrdf/error.h>
#include <miebrdf/fit.h>

#include <atomic>
#include <cmath>
#include <numbers>
#include <random>

#include "pipeline/fit/least_squares.h"
#include "tests/support/catch.h"
#include "tests/support/scenes.h"

using namespace miebrdf;
using Catch::Contains;

namespace {

/// Grey albedos of `scene` with noise of `sigma`, at these cosines and 550 nm.
FitData albedos_of(const Scene& scene, const std::vector<double>& mu_in, double sigma,
                   unsigned seed = 1) {
    const AlbedoValues truth = solve(scene, {550}, {.tolerance = 1e-5}).albedo(mu_in);
    std::mt19937 engine(seed);
    std::normal_distribution<double> noise(0.0, sigma);
    FitData data{.name = "albedos"};
    for (std::size_t i = 0; i < mu_in.size(); ++i)
        data.values.push_back({.wavelength_nm = 550,
                               .mu_in = mu_in[i],
                               .value = truth.plane_albedo[0][i] + (sigma > 0 ? noise(engine) : 0),
                               .sigma = sigma > 0 ? sigma : 1e-3});
    return data;
}

const std::vector<double> kCosines = {0.1, 0.2, 0.4, 0.6, 0.8, 1.0};

const FittedValue& value_of(const FitResult& result, const std::string& name) {
    for (const FittedValue& value : result.values) {
        if (value.unknown == name) return value;
    }
    throw std::runtime_error("no unknown " + name);
}

bool has_line(const std::vector<std::string>& lines, const std::string& part) {
    for (const std::string& line : lines) {
        if (line.find(part) != std::string::npos) return true;
    }
    return false;
}

void require_fit() {
    if (!has_fit()) {
        std::puts("skipped: no Ceres");
        std::exit(0);
    }
}

}  // namespace

TEST_CASE("the minimiser keeps to bounds", "[fit]") {
    require_fit();
    // Rosenbrock's valley has its minimum at (1, 1); below x = 0.5 the best is
    // (0.5, 0.25).
    fitting::LeastSquares valley;
    valley.start = {-1.2, 1.0};
    valley.low = {-2.0, -2.0};
    valley.high = {2.0, 2.0};
    valley.residuals = 2;
    valley.evaluate = [](std::span<const double> x, std::span<double> r, std::span<double> j) {
        r[0] = 10.0 * (x[1] - x[0] * x[0]);
        r[1] = 1.0 - x[0];
        if (!j.empty()) {
            const double values[] = {-20.0 * x[0], 10.0, -1.0, 0.0};
            std::copy(std::begin(values), std::end(values), j.begin());
        }
        return true;
    };
    const auto free = fitting::minimise(valley);
    CHECK(free.converged);
    CHECK(std::abs(free.x[0] - 1.0) <= 1e-4);
    CHECK(std::abs(free.x[1] - 1.0) <= 1e-4);
    valley.high[0] = 0.5;
    const auto bounded = fitting::minimise(valley);
    CHECK(std::abs(bounded.x[0] - 0.5) <= 1e-6);
    CHECK(std::abs(bounded.x[1] - 0.25) <= 1e-4);
}

TEST_CASE("albedos at several cosines give back the medium they were computed of", "[fit]") {
    require_fit();
    const FitProblem problem{
        .scene = {{"base", {"hg:{w},{g}"}}},
        .unknowns = {unknown("w", "0.9 in 0.1:0.9999 log1m"), unknown("g", "0.1 in -0.5:0.9")},
        .data = {albedos_of(support::scene_of("hg:0.97,0.6"), kCosines, 0.0)}};
    const FitResult result = fit(problem);
    CAPTURE(result.reason);
    CHECK(result.converged);
    // Both scenes are solved to a tolerance of 1e-4 and 1e-5; the shape tells g
    // ten times less.
    CHECK(std::abs(value_of(result, "w").value - 0.97) <= 1e-3);
    CHECK(std::abs(value_of(result, "g").value - 0.6) <= 1e-2);
    CHECK(result.degrees_of_freedom == 4);
    CHECK(result.chi_squared <= 1e-2);
    CHECK(value_of(result, "w").standard_error > 0.0);
    CHECK(result.correlation[1] == result.correlation[2]);
    CHECK(std::abs(result.correlation[0] - 1.0) <= 1e-12);
}

TEST_CASE("the density of one layer is fitted from its own words", "[fit]") {
    require_fit();
    const std::string snow = "index:1.31,1e-8,radius=5,density=0.917,layer-density=";
    Scene truth;
    truth.substrate = substrate("black");
    truth.layers = {layer(snow + "300@0.2mm")};
    const FitProblem problem{.scene = {{"substrate", {"black"}}, {"coat", {snow + "{rho}@0.2mm"}}},
                             .unknowns = {unknown("rho", "150 in 50:600")},
                             .data = {albedos_of(truth, kCosines, 0.0)}};
    const FitResult result = fit(problem);
    CHECK(result.converged);
    // Both scenes are solved to a tolerance of 1e-4 and 1e-5; the albedo .6 moves by .2 % per 1 %.
    CHECK(std::abs(value_of(result, "rho").value - 300) <= 0.5);
}

TEST_CASE("what a single albedo cannot tell is said as the combination that it does", "[fit]") {
    require_fit();
    // Similar media have one (1 - albedo) / (1 - albedo g): from the spherical
    // albedo alone, both numbers are open along a line.
    FitProblem problem{
        .scene = {{"base", {"hg:{w},{g}"}}},
        .unknowns = {unknown("w", "0.9 in 0.1:0.9999 log1m"), unknown("g", "0.1 in -0.5:0.9")},
        .data = {{.name = "sky",
                  .values = {{.geometry = MeasuredGeometry::hemispherical,
                              .wavelength_nm = 500,
                              .value = 0.6,
                              .sigma = 0.01},
                             {.geometry = MeasuredGeometry::hemispherical,
                              .wavelength_nm = 600,
                              .value = 0.6,
                              .sigma = 0.01}}}}};
    const FitResult result = fit(problem);
    REQUIRE(result.undetermined.size() == 1);
    CHECK_THAT(result.undetermined[0], Contains("determined only as") && Contains("(1 - w)"));
    // Of two numbers one may move a little only: it is named all the same.
    problem.unknowns[1].start = 0.05;
    const FitResult near_isotropic = fit(problem);
    REQUIRE(near_isotropic.undetermined.size() == 1);
    CHECK_THAT(near_isotropic.undetermined[0],
               Contains("determined only as") && Contains("(1 - w)"));
    problem.data[0].values.pop_back();
    CHECK_THROWS_WITH(fit(problem), Contains("1 values cannot tell 2 unknown numbers"));
}

TEST_CASE("a value at its bound, and a measurement out of reach, are said", "[fit]") {
    require_fit();
    const FitProblem problem{.scene = {{"base", {"hg:{w},0"}}},
                             .unknowns = {unknown("w", "0.5 in 0.1:0.9")},
                             .data = {albedos_of(support::scene_of("hg:0.99,0"), kCosines, 1e-3)}};
    const FitResult result = fit(problem);
    CHECK(value_of(result, "w").at_bound);
    CHECK(value_of(result, "w").value == 0.9);
    CHECK_THAT(value_of(result, "w").note, Contains("upper bound"));
    CHECK(std::isnan(value_of(result, "w").standard_error));
    CHECK(has_line(result.notes, "widen the bounds"));
    CHECK(has_line(result.notes, "chi_squared per degree of freedom"));
}

TEST_CASE("unknowns of each wavelength are found there", "[fit]") {
    require_fit();
    // Reflectance and transmittance of a free film tell scattering and
    // absorption.
    const std::vector<double> nm = {500, 600}, albedo = {0.9, 0.99}, depth = {2.0, 4.0};
    FitData data{.name = "film"};
    for (std::size_t w = 0; w < nm.size(); ++w) {
        Scene film;
        film.substrate = substrate("none");
        film.layers = {
            Layer{Species{.kind = Species::Kind::henyey_greenstein, .parameters = {albedo[w], 0.7}},
                  grey(depth[w])}};
        const AlbedoValues values = solve(film, {nm[w]}, {.tolerance = 1e-5}).albedo({0.99});
        data.values.push_back({.wavelength_nm = nm[w],
                               .mu_in = 0.99,
                               .value = values.plane_albedo[0][0],
                               .sigma = 1e-3});
        data.values.push_back({.quantity = MeasuredQuantity::transmittance,
                               .wavelength_nm = nm[w],
                               .mu_in = 0.99,
                               .value = values.plane_transmittance[0][0],
                               .sigma = 1e-3});
    }
    const FitProblem problem{
        .scene = {{"substrate", {"none"}}, {"coat", {"hg:{w},0.7@{tau}[grey]"}}},
        .unknowns = {unknown("w", "per wavelength, 0.8 in 0.1:0.9999 log1m"),
                     unknown("tau", "per wavelength, 1 in 0.1:50 log")},
        .data = {data}};
    const FitResult result = fit(problem);
    CHECK(result.converged);
    REQUIRE(result.values.size() == 4);
    for (std::size_t w = 0; w < nm.size(); ++w) {
        CHECK(result.values[w].wavelength_nm == nm[w]);
        CHECK(std::abs(result.values[w].value - albedo[w]) <= 2e-3);
        CHECK(std::abs(result.values[2 + w].value / depth[w] - 1.0) <= 2e-3);
    }
    // With a number that they share, all of them are one problem.
    FitProblem shared = problem;
    shared.scene[1].values = {"hg:{w},{g}@{tau}[grey]"};
    shared.unknowns.push_back(unknown("g", "0.7 in 0.5:0.8"));
    shared.data[0].values.push_back(shared.data[0].values[0]);
    shared.data[0].values.back().geometry = MeasuredGeometry::hemispherical;
    shared.data[0].values.back().value = 0.35;
    const FitResult together = fit(shared);
    CHECK(together.values.size() == 5);
}

TEST_CASE("a radius is found from a spectrum, a share from a colour", "[fit]") {
    require_fit();
    Scene spheres = support::scene_of("index:1.5,0.002,radius=0.6,variance=0.1");
    const std::vector<double> nm = {400, 500, 600, 800, 1000};
    const AlbedoValues truth = solve(spheres, nm, {.tolerance = 1e-5}).albedo({0.7});
    FitData spectrum{.name = "spectrum"};
    for (std::size_t w = 0; w < nm.size(); ++w)
        spectrum.values.push_back({.wavelength_nm = nm[w],
                                   .mu_in = 0.7,
                                   .value = truth.plane_albedo[w][0],
                                   .sigma = 2e-3});
    const FitResult sizes = fit({.scene = {{"base", {"index:1.5,0.002,radius={r},variance=0.1"}}},
                                 .unknowns = {unknown("r", "1 in 0.3:3 log")},
                                 .data = {spectrum}});
    CAPTURE(sizes.reason);
    CHECK(sizes.converged);
    CHECK(std::abs(value_of(sizes, "r").value / 0.6 - 1.0) <=
          3.0 * value_of(sizes, "r").standard_error / 0.6);
    CHECK(value_of(sizes, "r").standard_error <= 0.03);

    std::vector<double> visible;
    for (int i = 400; i <= 700; i += 10) visible.push_back(i);
    Scene paint = support::scene_of("hg:0.95,0.3");
    const double albedo = solve(paint, {550}, {.tolerance = 1e-5}).albedo({0.9}).plane_albedo[0][0];
    const Lab lab = Colorimeter(visible)(std::vector<double>(visible.size(), albedo)).lab;
    FitData colour{.name = "colour"};
    const MeasuredQuantity parts[] = {MeasuredQuantity::lab_l, MeasuredQuantity::lab_a,
                                      MeasuredQuantity::lab_b};
    const double values[] = {lab.l, lab.a, lab.b};
    for (int i = 0; i < 3; ++i)
        colour.values.push_back(
            {.quantity = parts[i], .mu_in = 0.9, .value = values[i], .sigma = 0.1});
    const FitResult share = fit({.scene = {{"base", {"hg:{w},0.3"}}},
                                 .unknowns = {unknown("w", "0.8 in 0.1:0.9999 log1m")},
                                 .data = {colour}});
    CHECK(share.converged);
    CHECK(std::abs(value_of(share, "w").value - 0.95) <= 1e-3);
}

TEST_CASE("values known up to a factor give the factor, too", "[fit]") {
    require_fit();
    FitData data = albedos_of(support::scene_of("hg:0.9,0"), kCosines, 0.0);
    for (MeasuredValue& point : data.values) point.value *= 0.8;
    data.free_scale = true;
    const FitProblem problem{.scene = {{"base", {"hg:{w},0"}}},
                             .unknowns = {unknown("w", "0.5 in 0.1:0.99")},
                             .data = {data}};
    const FitResult result = fit(problem);
    CHECK(std::abs(value_of(result, "w").value - 0.9) <= 2e-3);
    CHECK(std::abs(value_of(result, "scale of albedos").value - 0.8) <= 2e-3);
}

TEST_CASE("data sets share unknowns and differ in the words of their scene", "[fit]") {
    require_fit();
    std::vector<FitData> sets;
    for (const std::string ground : {"black", "lambert:0.8"}) {
        Scene paint;
        paint.substrate = substrate(ground);
        paint.layers = {layer("hg:0.95,0.5@1.5[grey]")};
        FitData data = albedos_of(paint, {0.5, 1.0}, 0.0);
        data.name = ground;
        data.scene = {{"substrate", {ground}}};
        sets.push_back(data);
    }
    const FitProblem problem{
        .scene = {{"substrate", {"none"}}, {"coat", {"hg:{w},0.5@{tau}[grey]"}}},
        .unknowns = {unknown("w", "0.8 in 0.1:0.9999 log1m"), unknown("tau", "1 in 0.1:50 log")},
        .data = sets};
    const FitResult result = fit(problem);
    CHECK(result.converged);
    CHECK(std::abs(value_of(result, "w").value - 0.95) <= 1e-3);
    CHECK(std::abs(value_of(result, "tau").value / 1.5 - 1.0) <= 2e-3);
    CHECK_THAT(result.scene_file, Contains("lambert:0.8") && Contains("[[result]]"));
}

TEST_CASE("95 % intervals cover the truth as often as they say", "[fit]") {
    require_fit();
    // With 95 % for each, 50 or fewer of 60 draws are covered once in 10,000 times where 95 %
    // should be.
    const Scene scene = support::scene_of("hg:0.95,0.5");
    int covered = 0;
    for (unsigned seed = 1; seed <= 60; ++seed) {
        const FitProblem problem{.scene = {{"base", {"hg:{w},0.5"}}},
                                 .unknowns = {unknown("w", "0.9 in 0.1:0.9999 log1m")},
                                 .data = {albedos_of(scene, kCosines, 0.005, seed)}};
        const FitResult result = fit(problem);
        const FittedValue w = value_of(result, "w");
        covered += w.interval_low <= 0.95 && 0.95 <= w.interval_high;
    }
    CHECK(covered > 50);
}

TEST_CASE("an interrupted fit keeps the best so far", "[fit]") {
    require_fit();
    const FitProblem problem{
        .scene = {{"base", {"hg:{w},{g}"}}},
        .unknowns = {unknown("w", "0.5 in 0.1:0.9999 log1m"), unknown("g", "0.1 in -0.5:0.9")},
        .data = {albedos_of(support::scene_of("hg:0.97,0.6"), kCosines, 0.0)}};
    std::atomic<bool> is_enough = false;
    Control control;
    control.threads = 1;
    control.progress = [&](const std::string&, std::size_t iteration, std::size_t) {
        if (iteration >= 2) is_enough = true;
    };
    control.is_cancelled = [&] { return is_enough.load(); };
    const FitResult result = fit(problem, control);
    CHECK(result.interrupted);
    CHECK_FALSE(result.converged);
    CHECK_THAT(result.reason, Contains("interrupted"));
    // It is better than the start, and its residuals are there.
    CHECK(value_of(result, "w").value != 0.5);
    CHECK(std::isfinite(result.chi_squared));
}

TEST_CASE("sizes from a lattice give the radius that averages of their own give", "[fit]") {
    require_fit();
    const std::string shape = GENERATE("", ",phase=henyey-greenstein,absorption=1.6");
    const std::string grains = "index:1.5,0.002,variance=0.1" + shape;
    CAPTURE(grains);
    const std::vector<double> nm = {450, 550, 650, 800, 1000};
    const AlbedoValues truth =
        solve(support::scene_of(grains + ",radius=0.6"), nm, {.tolerance = 1e-5}).albedo({0.7});
    FitData data{.name = "spectrum"};
    for (std::size_t w = 0; w < nm.size(); ++w)
        data.values.push_back({.wavelength_nm = nm[w],
                               .mu_in = 0.7,
                               .value = truth.plane_albedo[w][0],
                               .sigma = 5e-3});
    const auto radius_of = [&](const std::string& law) {
        return fit({.scene = {{"base", {grains + ",radius={r}" + law}}},
                    .unknowns = {unknown("r", "0.9 in 0.3:3 log")},
                    .data = {data}});
    };
    const FitResult smooth = radius_of("");
    REQUIRE(smooth.interpolation_shift);
    CHECK(*smooth.interpolation_shift <= 0.1);
    CHECK(smooth.converged);
    // Both the data's tolerance and the scene's are well below a standard error.
    CHECK(std::abs(value_of(smooth, "r").value - 0.6) <=
          0.5 * value_of(smooth, "r").standard_error);
    // Particles of one size have no lattice.
    CHECK_FALSE(radius_of(",distribution=mono").interpolation_shift);
}

TEST_CASE("scattered directions give back the medium that they were computed of", "[fit]") {
    require_fit();
    // 60 values at directions of their own: 216,000 combinations, which are not solved.
    const Brdf truth = solve(support::scene_of("hg:0.95,0.5"), {550}, {.tolerance = 1e-5});
    FitData data{.name = "scattered"};
    for (int i = 0; i < 60; ++i) {
        const double in = 0.1 + 0.9 * std::fmod(0.7548 * i, 1.0),
                     out = 0.1 + 0.9 * std::fmod(0.5698 * i, 1.0),
                     azimuth = 180.0 * std::fmod(0.618 * i, 1.0);
        MeasuredValue value{.quantity = MeasuredQuantity::brdf,
                            .geometry = MeasuredGeometry::directions,
                            .wavelength_nm = 550,
                            .mu_in = in,
                            .mu_out = out,
                            .azimuth_deg = azimuth};
        value.value = truth.evaluate({{in}, {out}, {azimuth}}).at(0, 0, 0, 0);
        value.sigma = 0.01 * value.value;
        data.values.push_back(value);
    }
    const FitResult result =
        fit({.scene = {{"base", {"hg:{w},{g}"}}},
             .unknowns = {unknown("w", "0.8 in 0.1:0.9999 log1m"), unknown("g", "0.2 in -0.5:0.9")},
             .data = {data}});
    CHECK(result.converged);
    // A table interpolates to its tolerance, a tenth of the sigmas.
    CHECK(std::abs(value_of(result, "w").value - 0.95) <= value_of(result, "w").standard_error);
    CHECK(std::abs(value_of(result, "g").value - 0.5) <= value_of(result, "g").standard_error);
    CHECK(result.chi_squared <= 60 * 0.01);
}

TEST_CASE("reflectance factors under sun and sky give back the medium", "[fit]") {
    require_fit();
    const double share = 0.3;
    const Sky above = sky(GENERATE("uniform", "cie-clear"));
    const Directions directions{{0.6}, {0.4, 0.7, 1.0}, {0, 90, 180}};
    const HdrfValues truth = solve(support::scene_of("hg:0.97,0.6"), {550}, {.tolerance = 1e-4})
                                 .hdrf(directions, share, above);
    FitData data{.name = "field", .diffuse_fraction = share, .sky = above};
    for (std::size_t o = 0; o < 3; ++o) {
        for (std::size_t a = 0; a < 3; ++a)
            data.values.push_back({.quantity = MeasuredQuantity::reflectance_factor,
                                   .geometry = MeasuredGeometry::hdrf,
                                   .wavelength_nm = 550,
                                   .mu_in = 0.6,
                                   .mu_out = directions.mu_out[o],
                                   .azimuth_deg = directions.azimuth_deg[a],
                                   .value = truth.hdrf[0][o * 3 + a],
                                   .sigma = 0.005});
    }
    FitProblem problem{
        .scene = {{"base", {"hg:{w},{g}"}}},
        .unknowns = {unknown("w", "0.9 in 0.1:0.9999 log1m"), unknown("g", "0.3 in -0.5:0.9")},
        .data = {data}};
    const FitResult result = fit(problem);
    CHECK(result.converged);
    CHECK(std::abs(value_of(result, "w").value - 0.97) <= 2e-3);
    CHECK(std::abs(value_of(result, "g").value - 0.6) <= 1e-2);
    // The sky belongs to the data: under the sun alone other numbers meet them worse.
    problem.data[0].diffuse_fraction = 0.0;
    CHECK(fit(problem).chi_squared > 10.0 * result.chi_squared + 1.0);
    if (above.kind == Sky::Kind::uniform) return;
    problem.data[0].diffuse_fraction = share;
    problem.data[0].sky = {};
    CHECK(fit(problem).chi_squared > 10.0 * result.chi_squared + 1.0);
}

TEST_CASE("a start where nothing seems to depend on a number is left", "[fit]") {
    require_fit();
    // At g = 0 the phase function has a single moment, and none that g could change.
    const FitProblem problem{
        .scene = {{"base", {"hg:{w},{g}"}}},
        .unknowns = {unknown("w", "0.9 in 0.1:0.9999 log1m"), unknown("g", "0 in -0.5:0.9")},
        .data = {albedos_of(support::scene_of("hg:0.97,0.6"), kCosines, 0.0)}};
    CHECK(std::abs(value_of(fit(problem), "g").value - 0.6) <= 1e-2);
}

TEST_CASE("intervals have the digits that show their width, and doubts of files are repeated",
          "[fit]") {
    require_fit();
    FitProblem problem{.scene = {{"base", {"hg:{w},0"}}},
                       .unknowns = {unknown("w", "0.999 in 0.1:0.99999999 log1m")},
                       .data = {albedos_of(support::scene_of("hg:0.99999,0"), kCosines, 1e-4)}};
    problem.data[0].doubts = {"a value is missing"};
    const FitResult result = fit(problem);
    CHECK_THAT(value_of(result, "w").note, Contains("0.99999") && !Contains("to 1"));
    CHECK(has_line(result.notes, "a value is missing"));
}

TEST_CASE("several starts list their minima", "[fit]") {
    require_fit();
    FitProblem problem{.scene = {{"base", {"hg:{w},0"}}},
                       .unknowns = {unknown("w", "0.5 in 0.1:0.99")},
                       .data = {albedos_of(support::scene_of("hg:0.9,0"), kCosines, 0.0)},
                       .starts = 4};
    const FitResult result = fit(problem);
    REQUIRE(result.minima.size() == 1);  // there is but one
    CHECK(result.minima[0].starts == 4);
}

namespace {

/// A made BRDF of two lobes, of which one has a share of .01 as in sintered PTFE: six angles of
/// incidence, noise of 1.5 %.
FitProblem two_lobes(const std::string& start_g1, const std::string& start_g2,
                     const std::string& start_share) {
    Scene scene = support::scene_of("dhg:0.9999,0.15,-0.8,0.99");
    const std::vector<double> out = {0.15, 0.3, 0.5, 0.7, 0.85, 0.95, 1.0},
                              in = {0.26, 0.5, 0.71, 0.87, 0.97, 1.0},
                              azimuth = {0, 45, 90, 135, 180};
    const BrdfValues truth = solve(scene, {532}, {.tolerance = 1e-4}).evaluate({in, out, azimuth});
    std::mt19937 engine(3);
    std::normal_distribution<double> noise(0.0, 0.015);
    FitData data{.name = "brdf"};
    for (std::size_t i = 0; i < in.size(); ++i) {
        for (std::size_t o = 0; o < out.size(); ++o) {
            for (std::size_t a = 0; a < azimuth.size(); ++a) {
                const double value = truth.at(0, i, o, a);
                data.values.push_back({.quantity = MeasuredQuantity::brdf,
                                       .wavelength_nm = 532,
                                       .mu_in = in[i],
                                       .mu_out = out[o],
                                       .azimuth_deg = azimuth[a],
                                       .value = value * (1.0 + noise(engine)),
                                       .sigma = 0.015 * value});
            }
        }
    }
    return {.scene = {{"base", {"dhg:{w},{g1},{g2},{share}"}}},
            .unknowns = {unknown("w", "0.999 in 0.5:0.9999999 log1m"),
                         unknown("g1", start_g1 + " in 0:0.95"),
                         unknown("g2", start_g2 + " in -0.9:0.5"),
                         unknown("share", start_share + " in 0:1")},
            .data = {data}};
}

}  // namespace

TEST_CASE("a fit finds its minimum from starts that lead to side minima", "[fit]") {
    require_fit();
    // A lobe whose share goes to 0, or to 1, leaves the asymmetry of the other one where it is.
    double least = 1e300;
    std::vector<double> ends;
    for (const auto& start : std::vector<std::vector<std::string>>{{"0.15", "-0.8", "0.99"},
                                                                   {"0.6", "-0.2", "0.8"},
                                                                   {"0.1", "0.4", "0.9"},
                                                                   {"0.9", "0.1", "0.1"}}) {
        const FitResult found = fit(two_lobes(start[0], start[1], start[2]));
        CAPTURE(start, found.chi_squared);
        CHECK(found.converged);
        ends.push_back(found.chi_squared);
        least = std::min(least, found.chi_squared);
    }
    // The first start is the truth; one sigma is a chi squared of 1.
    CHECK(ends[0] <= least + 0.1);
    for (const double end : ends) CHECK(end <= least + 0.1);
}

TEST_CASE("minima that are equally good are said with what they disagree about", "[fit]") {
    require_fit();
    // Both lobes may have either name.
    FitProblem problem = two_lobes("0.15", "-0.8", "0.99");
    problem.unknowns[1].low = -0.95;
    problem.unknowns[2].low = -0.95;
    problem.unknowns[2].high = 0.95;
    problem.starts = 12;
    const FitResult found = fit(problem);
    REQUIRE(found.minima.size() >= 2);
    CHECK(has_line(found.notes, "disagree about"));
    CHECK(has_line(found.notes, "g1 ("));
}

TEST_CASE("robust losses hold where a value is wrong", "[fit]") {
    require_fit();
    FitData data = albedos_of(support::scene_of("hg:0.9,0"), kCosines, 0.0);
    data.values[2].value += 0.2;
    FitProblem problem{.scene = {{"base", {"hg:{w},0"}}},
                       .unknowns = {unknown("w", "0.5 in 0.1:0.99")},
                       .data = {data}};
    const double plain = value_of(fit(problem), "w").value;
    problem.loss = FitLoss::cauchy;
    const double robust = value_of(fit(problem), "w").value;
    CHECK(std::abs(plain - 0.9) >= 0.01);
    CHECK(std::abs(robust - 0.9) <= 1e-3);
}

TEST_CASE("a fit that ends at the edge of what can be computed says so and gives no interval",
          "[fit]") {
    require_fit();
    // Grains reflect the less the larger they are, and no size that can be computed is as dark.
    FitProblem problem{
        .scene = {{"base", {"index:1.31,1e-7,radius={r},variance=0.2,distribution=log-normal"}}},
        .unknowns = {unknown("r", "2000 in 200:30000 log")},
        .data = {FitData{
            .name = "dark",
            .values = {{.wavelength_nm = 450, .mu_in = 0.7, .value = 0.02, .sigma = 1e-3}}}}};
    const FitResult found = fit(problem);
    CAPTURE(found.reason, value_of(found, "r").value, value_of(found, "r").note);
    CHECK_FALSE(found.converged);
    CHECK_THAT(found.reason, Contains("edge of what can be computed"));
    CHECK(std::isnan(value_of(found, "r").standard_error));
    CHECK_THAT(value_of(found, "r").note, Contains("no interval"));
    // A start beyond is refused with one that would work.
    problem.unknowns = {unknown("r", "25000 in 200:30000 log")};
    CHECK_THROWS_WITH(fit(problem), Contains("the fit cannot start from r = 25000, but"));
}
