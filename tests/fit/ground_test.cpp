// Grounds by their BRDF, fitted to measured directions.
#include <miebrdf/brdf.h>
#include <miebrdf/fit.h>

#include <cmath>
#include <random>
#include <string>

#include "tests/support/catch.h"
#include "tests/support/temporary_folder.h"

using namespace miebrdf;

TEST_CASE("numbers of a ground are found, shared or one for each wavelength", "[fit][ground]") {
    if (!has_fit()) return;
    const double nm[] = {550, 670, 865}, rho0[] = {0.05, 0.11, 0.24};
    const double k = 0.82, theta = -0.12, noise = 0.02;
    const Directions directions{{0.5, 0.8}, {0.4, 0.6, 0.9}, {0, 90, 170}};
    std::mt19937 engine(7);
    std::normal_distribution<double> error(0.0, noise);
    std::string text = "wavelength_nm,mu_in,mu_out,azimuth_deg,brdf\n";
    for (std::size_t w = 0; w < 3; ++w) {
        Scene ground;
        ground.substrate = substrate("rpv:" + std::to_string(rho0[w]) + "," + std::to_string(k) +
                                     "," + std::to_string(theta));
        const BrdfValues values = solve(ground, {nm[w]}).evaluate(directions);
        for (std::size_t i = 0; i < 2; ++i)
            for (std::size_t o = 0; o < 3; ++o)
                for (std::size_t a = 0; a < 3; ++a)
                    text += std::to_string(nm[w]) + "," + std::to_string(directions.mu_in[i]) +
                            "," + std::to_string(directions.mu_out[o]) + "," +
                            std::to_string(directions.azimuth_deg[a]) + "," +
                            std::to_string(values.at(0, i, o, a) * (1.0 + error(engine))) + "\n";
    }
    const support::TemporaryFolder folder;
    folder.write("soil.csv", text);
    const FitResult found = fit(read_fit_text(R"(
[scene]
substrate = "rpv:{rho0},{k},{theta}"
[unknowns]
rho0 = "per wavelength, 0.1 in 0.001:1"
k = "1 in 0.2:1.5"
theta = "0 in -0.5:0.5"
[[measured]]
file = "soil.csv"
quantity = "brdf"
relative_sigma = 0.02
)",
                                              folder.path().string(), "fit.toml"));
    CHECK(found.converged);
    CHECK(found.undetermined.empty());
    REQUIRE(found.values.size() == 5);
    for (const FittedValue& value : found.values) {
        CAPTURE(value.unknown, value.value, value.standard_error);
        double truth = value.unknown == "k" ? k : theta;
        for (std::size_t w = 0; w < 3; ++w)
            if (value.wavelength_nm == nm[w]) truth = rho0[w];
        CHECK(std::abs(value.value - truth) <= 4 * value.standard_error);
        CHECK(value.standard_error <= 0.05);
        CHECK(value.standard_error > 0.0);
    }
    // 54 values, 5 unknowns: 49 +- 10.
    CHECK(std::abs(found.chi_squared - 49) <= 40);
}
