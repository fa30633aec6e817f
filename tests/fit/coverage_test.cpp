// How often 95 % intervals cover the truth, over 1,200 draws of noise in four kinds of problems.
// Takes minutes: `test_fit [coverage]` runs it.
#include <fmt/format.h>
#include <miebrdf/fit.h>

#include <cmath>
#include <random>

#include "tests/support/catch.h"
#include "tests/support/scenes.h"

using namespace miebrdf;

namespace {

constexpr int kDraws = 1200;

struct Kind {
    std::string name;
    FitProblem problem;                        ///< whose values are without noise
    std::vector<double> truth;                 ///< in the order of FitResult::values
    double sigma = 0.0, relative_sigma = 0.0;  ///< of the noise
    bool sigma_known = true;
};

MeasuredValue albedo_at(double mu_in) {
    MeasuredValue value;
    value.wavelength_nm = 550;
    value.mu_in = mu_in;
    value.geometry = MeasuredGeometry::directional;
    return value;
}

FitData albedos(const Scene& scene, const std::vector<double>& mu_in) {
    FitData data{.name = "albedos"};
    const AlbedoValues truth = solve(scene, {550}, {.tolerance = 1e-5}).albedo(mu_in);
    for (std::size_t i = 0; i < mu_in.size(); ++i) {
        data.values.push_back(albedo_at(mu_in[i]));
        data.values.back().value = truth.plane_albedo[0][i];
    }
    return data;
}

FitData reflectances(const Scene& scene) {
    FitData data{.name = "brdf"};
    const Directions directions{{0.5, 0.9}, {0.2, 0.4, 0.6, 0.8, 1.0}, {0, 90, 180}};
    const BrdfValues truth = solve(scene, {550}, {.tolerance = 1e-5}).evaluate(directions);
    for (std::size_t i = 0; i < 2; ++i) {
        for (std::size_t o = 0; o < 5; ++o) {
            for (std::size_t a = 0; a < 3; ++a) {
                MeasuredValue value = albedo_at(directions.mu_in[i]);
                value.quantity = MeasuredQuantity::brdf;
                value.geometry = MeasuredGeometry::directions;
                value.mu_out = directions.mu_out[o];
                value.azimuth_deg = directions.azimuth_deg[a];
                value.value = truth.at(0, i, o, a);
                data.values.push_back(value);
            }
        }
    }
    return data;
}

std::vector<Kind> kinds() {
    const std::vector<double> cosines = {0.1, 0.2, 0.4, 0.6, 0.8, 1.0};
    std::vector<Kind> all;
    all.push_back({"an albedo near 1, known errors",
                   {.scene = {{"base", {"hg:{w},0.8"}}},
                    .unknowns = {unknown("w", "0.99 in 0.1:0.999999 log1m")},
                    .data = {albedos(support::scene_of("hg:0.999,0.8"), cosines)}},
                   {0.999},
                   0.005});
    all.push_back(
        {"albedo and asymmetry of a measured BRDF, relative errors",
         {.scene = {{"base", {"hg:{w},{g}"}}},
          .unknowns = {unknown("w", "0.9 in 0.1:0.9999 log1m"), unknown("g", "0.2 in -0.8:0.9")},
          .data = {reflectances(support::scene_of("hg:0.97,0.6"))}},
         {0.97, 0.6},
         0.0,
         0.02});
    all.push_back(
        {"errors from the residuals",
         {.scene = {{"base", {"hg:{w},{g}"}}},
          .unknowns = {unknown("w", "0.9 in 0.1:0.9999 log1m"), unknown("g", "0.2 in -0.8:0.9")},
          .data = {reflectances(support::scene_of("hg:0.9,0.4"))}},
         {0.9, 0.4},
         0.002,
         0.0,
         false});
    Kind film{
        "a film over black and over white, values up to a factor",
        {.scene = {{"coat", {"hg:{w},0.5@{tau}[grey]"}}},
         .unknowns = {unknown("w", "0.9 in 0.1:0.9999 log1m"), unknown("tau", "1 in 0.05:50 log")},
         .data = {}},
        {0.97, 2.0, 1.0},
        0.005};
    for (const std::string ground : {"black", "lambert:0.8"}) {
        Scene scene;
        scene.substrate = substrate(ground);
        scene.layers = {layer("hg:0.97,0.5@2[grey]")};
        film.problem.data.push_back(albedos(scene, cosines));
        film.problem.data.back().name = ground;
        film.problem.data.back().scene = {{"substrate", {ground}}};
    }
    film.problem.data.front().free_scale = true;
    all.push_back(film);
    return all;
}

}  // namespace

TEST_CASE("95 % intervals cover 95 % of 1,200 draws in each kind of problem", "[.][coverage]") {
    if (!has_fit()) return;
    for (const Kind& kind : kinds()) {
        std::vector<int> covered(kind.truth.size(), 0);
        double per_degree = 0.0;
        for (unsigned draw = 1; draw <= kDraws; ++draw) {
            std::mt19937 engine(draw);
            std::normal_distribution<double> normal;
            FitProblem problem = kind.problem;
            for (FitData& data : problem.data) {
                for (MeasuredValue& value : data.values) {
                    const double sigma = kind.sigma + kind.relative_sigma * value.value;
                    value.value += sigma * normal(engine);
                    if (kind.sigma_known) value.sigma = sigma;
                }
            }
            const FitResult result = fit(problem);
            REQUIRE(result.converged);
            per_degree += result.chi_squared / result.degrees_of_freedom / kDraws;
            for (std::size_t i = 0; i < kind.truth.size(); ++i)
                covered[i] += result.values[i].interval_low <= kind.truth[i] &&
                              kind.truth[i] <= result.values[i].interval_high;
        }
        for (std::size_t i = 0; i < covered.size(); ++i) {
            const double share = double(covered[i]) / kDraws;
            fmt::print("{}, {}: {:.3f} covered, chi squared per degree {:.3f}\n", kind.name,
                       i < kind.problem.unknowns.size() ? kind.problem.unknowns[i].name : "scale",
                       share, per_degree);
            // The count has a standard deviation of 0.63 %; of the eight numbers asked for one lies
            // beyond three of them in 2 of 100 runs.
            CHECK(share >= 0.95 - 3 * 0.0063);
            CHECK(share <= 0.95 + 3 * 0.0063);
        }
    }
}

TEST_CASE("the grain radius of synthetic snow is within its stated error", "[.][coverage]") {
    if (!has_fit()) return;
    // Near-infrared albedos as SNICAR has them (Warren's ice by way of Picard 2016), noise of 1 %.
    const std::vector<double> nm = {900, 950, 1000, 1030, 1060, 1100, 1150, 1200, 1250, 1300};
    const std::string words = "H2O_ice/SNICAR-Pic16,variance=0.2,distribution=log-normal,radius=";
    int covered = 0, draws = 0;
    double squares = 0.0;
    for (const double radius : {60.0, 150.0, 400.0, 900.0}) {
        const AlbedoValues truth =
            solve(support::scene_of(words + std::to_string(radius)), nm, {.tolerance = 1e-4})
                .albedo({0.6});
        for (unsigned draw = 1; draw <= 10; ++draw, ++draws) {
            std::mt19937 engine(draw);
            std::normal_distribution<double> normal;
            FitProblem problem{.scene = {{"base", {words + "{r}"}}},
                               .unknowns = {unknown("r", "200 in 20:2000 log")},
                               .data = {{.name = "snow"}}};
            for (std::size_t w = 0; w < nm.size(); ++w) {
                const double albedo = truth.plane_albedo[w][0];
                problem.data[0].values.push_back({.geometry = MeasuredGeometry::directional,
                                                  .wavelength_nm = nm[w],
                                                  .mu_in = 0.6,
                                                  .value = albedo * (1.0 + 0.01 * normal(engine)),
                                                  .sigma = 0.01 * albedo});
            }
            const FitResult result = fit(problem);
            REQUIRE(result.converged);
            const FittedValue& r = result.values[0];
            covered += r.interval_low <= radius && radius <= r.interval_high;
            squares += std::pow(std::log(r.value / radius) * r.value / r.standard_error, 2);
        }
    }
    fmt::print("radius of synthetic snow: {} of {} covered, rms {:.3f} standard errors\n", covered,
               draws, std::sqrt(squares / draws));
    // Fewer than 34 of 40 are covered once in 500 times where 95 % should be.
    CHECK(covered >= 34);
}
