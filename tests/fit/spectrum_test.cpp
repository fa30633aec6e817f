// Spectra whose axis is off, whose values are means over bands, whose errors are correlated, and
// with more wavelengths than are solved.
#include <miebrdf/fit.h>

#include <cmath>

#include "tests/support/catch.h"
#include "tests/support/scenes.h"

using namespace miebrdf;

namespace {

/// A film of haematite, whose edge of absorption lies at 560 nm, over white.
Scene film_of(double depth_um) {
    Scene film;
    film.substrate = substrate("lambert:0.9");
    film.layers = {layer("Fe2O3,radius=0.1,variance=0.1,volume=1% in index:1.5@" +
                         std::to_string(depth_um) + "um")};
    return film;
}

/// Its albedos at wavelengths, solved one by one.
std::vector<double> albedos_at(const std::vector<double>& nm) {
    std::vector<double> albedo;
    const AlbedoValues solved =
        solve(film_of(20.0), nm, {.tolerance = 1e-4, .stokes = 1}).albedo({0.7});
    for (const std::vector<double>& at : solved.plane_albedo) albedo.push_back(at[0]);
    return albedo;
}

FitData data_of(const std::vector<double>& nm, const std::vector<double>& albedo) {
    FitData data{.name = "film"};
    for (std::size_t i = 0; i < nm.size(); ++i)
        data.values.push_back(
            {.wavelength_nm = nm[i], .mu_in = 0.7, .value = albedo[i], .sigma = 0.01 * albedo[i]});
    return data;
}

FitProblem problem_of(FitData data) {
    return {.scene = {{"coat", {"Fe2O3,radius=0.1,variance=0.1,volume=1% in index:1.5@{d}um"}},
                      {"substrate", {"lambert:0.9"}},
                      {"stokes", {"1"}}},
            .unknowns = {unknown("d", "10 in 1:100 log")},
            .data = {std::move(data)}};
}

std::vector<double> every(double first, double last, double step) {
    std::vector<double> nm;
    for (double at = first; at <= last; at += step) nm.push_back(at);
    return nm;
}

bool can_fit() {
    if (!has_fit()) std::puts("skipped: no Ceres");
    return has_fit();
}

}  // namespace

TEST_CASE("a wavelength axis that is off by 8 nm is found with the depth of a film", "[fit]") {
    if (!can_fit()) return;
    const std::vector<double> nm = every(480, 680, 10);
    std::vector<double> true_nm = nm;
    for (double& each : true_nm) each += 8.0;
    FitData data = data_of(nm, albedos_at(true_nm));
    const FitResult as_said = fit(problem_of(data));
    data.free_wavelength_shift = true;
    const FitResult free = fit(problem_of(data));
    REQUIRE(free.values.size() == 2);
    CAPTURE(free.reason, free.values[0].value, free.values[1].value, as_said.values[0].value);
    CHECK(free.converged);
    CHECK(free.values[1].unknown == "wavelength shift of film");
    // Values err by 1e-4, cubics between them by up to 1e-3 of themselves, a tenth of their sigma.
    CHECK(std::abs(free.values[1].value - 8.0) <= 0.1 * free.values[1].standard_error);
    CHECK(std::abs(free.values[0].value - 20.0) <= 0.1 * free.values[0].standard_error);
    CHECK(std::abs(as_said.values[0].value - 20.0) >= 3.0 * as_said.values[0].standard_error);
    data.free_wavelength_shift = false;
    data.wavelength_shift_nm = 8.0;
    const FitResult known = fit(problem_of(data));
    CHECK(std::abs(known.values[0].value - 20.0) <= 0.1 * known.values[0].standard_error);
}

TEST_CASE("values that are means over a band are compared with means over it", "[fit]") {
    if (!can_fit()) return;
    // Means by a sum over each nanometre: a Gaussian of full width 40 nm at half maximum.
    const double width = 40.0;
    const std::vector<double> nm = every(500, 660, 20), fine = every(420, 740, 2);
    const std::vector<double> albedo = albedos_at(fine);
    std::vector<double> means;
    for (const double centre : nm) {
        double sum = 0.0, weights = 0.0;
        for (std::size_t i = 0; i < fine.size(); ++i) {
            const double weight = std::exp2(-4.0 * std::pow((fine[i] - centre) / width, 2));
            sum += weight * albedo[i];
            weights += weight;
        }
        means.push_back(sum / weights);
    }
    FitData data = data_of(nm, means);
    data.band_width_nm = width;
    const FitResult found = fit(problem_of(data));
    CHECK(found.converged);
    // The band's ends beyond 1.5 widths, 0.2 % of its centre, are left out.
    CHECK(std::abs(found.values[0].value - 20.0) <= 0.2 * found.values[0].standard_error);
    CHECK(std::sqrt(found.chi_squared / double(nm.size())) <= 0.2);
}

TEST_CASE("correlated errors tell less, by a closed form", "[fit]") {
    if (!can_fit()) return;
    // The mean of n values with correlation q of neighbours: 1' C^-1 1 = (n - (n - 2) q) / (1 + q).
    const std::vector<double> nm = every(500, 690, 10);
    FitProblem problem{.scene = {{"base", {"hg:{w},0.5"}}},
                       .unknowns = {unknown("w", "0.8 in 0.1:0.999 log1m")},
                       .data = {{.name = "grey"}}};
    for (const double each : nm)
        problem.data[0].values.push_back(
            {.wavelength_nm = each, .mu_in = 0.6, .value = 0.4, .sigma = 0.01});
    const double independent = fit(problem).values[0].standard_error;
    problem.data[0].correlation_length_nm = 30.0;
    const FitResult tied = fit(problem);
    const double n = double(nm.size()), q = std::exp(-10.0 / 30.0);
    CAPTURE(independent, tied.values[0].standard_error);
    CHECK(std::abs(tied.values[0].standard_error / independent /
                       std::sqrt(n * (1.0 + q) / (n - (n - 2.0) * q)) -
                   1.0) <= 1e-3);  // both minima are found to this
    CHECK(tied.residuals.size() == nm.size());
    for (const FitResidual& residual : tied.residuals)
        CHECK(std::abs(residual.model - 0.4) <= 1e-3);
}

TEST_CASE("of many wavelengths those are solved that interpolation needs", "[fit]") {
    if (!can_fit()) return;
    const std::vector<double> nm = every(440, 700, 2);
    const std::vector<double> albedo = albedos_at(nm);
    const FitResult found = fit(problem_of(data_of(nm, albedo)));
    CHECK(found.converged);
    double worst = 0.0;
    for (std::size_t i = 0; i < nm.size(); ++i)
        worst = std::max(worst, std::abs(found.residuals[i].model / albedo[i] - 1.0));
    CAPTURE(found.values[0].value, worst);
    // The tolerance of a fit is a tenth of the smallest sigma, here 1e-3; the depth moves all.
    CHECK(worst <= 3e-3);
    CHECK(std::abs(found.values[0].value - 20.0) <= 0.1 * found.values[0].standard_error + 0.02);
}

TEST_CASE("wavelengths that are tied together need spectra", "[fit]") {
    FitData data = data_of({500, 550}, {0.2, 0.3});
    data.band_width_nm = -1.0;
    CHECK_THROWS_WITH(fit(problem_of(data)), Catch::Contains("band_width in nm"));
    data.band_width_nm = 0.0;
    data.wavelength_shift_nm = 30.0;
    CHECK_THROWS_WITH(fit(problem_of(data)), Catch::Contains("within +-20"));
    data.wavelength_shift_nm = 2.0;
    FitProblem apart = problem_of(data);
    apart.unknowns[0].per_wavelength = true;
    CHECK_THROWS_WITH(fit(apart), Catch::Contains("tie wavelengths"));
}

TEST_CASE("a power law over wavelengths is found from films of a turbid medium", "[fit]") {
    if (!can_fit()) return;
    // mu_s' = 2 (nm / 500)^-1.3 and mu_a = 0.05 per mm, solved at each wavelength by itself.
    const std::vector<double> nm = every(450, 750, 50);
    FitData data{.name = "film"};
    for (const double each : nm) {
        const double mu_s = 2.0 * std::pow(each / 500.0, -1.3);
        Scene film;
        film.substrate = substrate("black");
        film.layers = {layer("turbid:0.05," + std::to_string(mu_s) + ",0.7@1mm")};
        const AlbedoValues solved = solve(film, {each}, {.tolerance = 1e-5}).albedo({0.8});
        for (const bool passes : {false, true})
            data.values.push_back(
                {.quantity =
                     passes ? MeasuredQuantity::transmittance : MeasuredQuantity::reflectance,
                 .wavelength_nm = each,
                 .mu_in = 0.8,
                 .value = (passes ? solved.plane_transmittance : solved.plane_albedo)[0][0],
                 .sigma = 1e-3});
    }
    FitProblem problem{
        .scene = {{"coat", {"turbid:{mua},{mus},0.7@1mm"}}, {"substrate", {"black"}}},
        .unknowns = {unknown("a", "1 in 0.1:10 log"), unknown("b", "0.5 in -1:4"),
                     unknown("mua", "0.1 in 0.001:1 log")},
        .derived = {{"mus", "a*(wavelength_nm/5e2)^-b"}},
        .data = {data},
        .starts = 1};
    const FitResult found = fit(problem);
    CAPTURE(found.reason);
    CHECK(found.converged);
    // mu_s is written with six decimals, and solved to 1e-4.
    CHECK(std::abs(found.values[0].value - 2.0) <= 0.2 * found.values[0].standard_error);
    CHECK(std::abs(found.values[1].value - 1.3) <= 0.2 * found.values[1].standard_error);
    CHECK(std::abs(found.values[2].value - 0.05) <= 0.2 * found.values[2].standard_error);
    CHECK(found.scene_file.find("{") == std::string::npos);
    problem.derived[0].formula = "a*(wavelength_nm/500)^-b + c";
    CHECK_THROWS_WITH(fit(problem), Catch::Contains("'c'"));
    problem.derived[0].formula = "a*(wavelength_nm/500)^-b + (";
    CHECK_THROWS_WITH(fit(problem), Catch::Contains("formula"));
}
