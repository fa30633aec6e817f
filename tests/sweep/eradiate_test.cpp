// Eradiate's layout of a BRDF: order, azimuths, and what it refuses.
#include "pipeline/sweep/eradiate.h"

#include <miebrdf/error.h>

#include <cmath>
#include <numbers>

#include "pipeline/sweep/layout.h"
#include "pipeline/sweep/sweep_file.h"
#include "tests/support/catch.h"
#include "tests/support/temporary_folder.h"

using namespace miebrdf;
using Catch::Contains;

namespace {

std::string eradiate_sweep(const std::string& axes) {
    return R"(outputs = ["brdf"]
layout = "eradiate"
[scene]
base = "hg:0.9,0.3"
[axes]
wavelength_nm = [500, 600]
)" + axes;
}

constexpr char kAxes[] =
    "mu_in = \"0:1:3 linear\"\nmu_out = \"0:1:2 linear\"\nazimuth_deg = \"0:270:90\"\n";

}  // namespace

TEST_CASE("Eradiate's order is outgoing cosine, azimuth from the source, incident cosine",
          "[sweep]") {
    const support::TemporaryFolder folder;
    const auto sweep = sweep::read_sweep_file(folder.write("s.toml", eradiate_sweep(kAxes)));
    // Values that say where they are: wavelength, incidence, reflection, azimuth.
    std::vector<double> brdf;
    for (int w = 0; w < 2; ++w)
        for (int i = 0; i < 3; ++i)
            for (int o = 0; o < 2; ++o)
                for (int a = 0; a < 4; ++a) brdf.push_back(1000 * w + 100 * i + 10 * o + a);
    const auto ordered = sweep::in_eradiate_order(sweep, brdf.data());
    const auto phi = sweep::eradiate_azimuths(sweep.azimuth);
    REQUIRE(ordered.size() == brdf.size());
    std::size_t k = 0;
    for (int o = 0; o < 2; ++o) {
        for (int p = 0; p < 4; ++p) {
            // cos(azimuth) = -cos(phi_d)
            CHECK(std::abs(phi[std::size_t(p)] - p * std::numbers::pi / 2) <= 1e-14);
            for (int i = 0; i < 3; ++i) {
                for (int w = 0; w < 2; ++w) {
                    const int a = int(ordered[k]) % 10;
                    CHECK(ordered[k++] - a == 1000 * w + 100 * i + 10 * o);
                    CHECK(std::abs(std::cos(a * std::numbers::pi / 2) +
                                   std::cos(phi[std::size_t(p)])) <= 1e-14);
                }
            }
        }
    }
    CHECK(sweep.directions().mu_in[0] == sweep::kGrazingStep * 0.5);
    CHECK(sweep.directions().mu_in[1] == 0.5);
}

TEST_CASE("Eradiate's layout refuses other axes with those that it takes", "[sweep][errors]") {
    const support::TemporaryFolder folder;
    const auto refused = [&](const std::string& axes, const std::string& reason) {
        CHECK_THROWS_WITH(sweep::read_sweep_file(folder.write("b.toml", eradiate_sweep(axes))),
                          Contains(reason));
    };
    refused("mu_in = [0.5, 1]\nmu_out = \"0:1:2 linear\"\nazimuth_deg = [0, 180]\n",
            "mu_in = \"0:1:11 linear\"");
    refused("mu_in = \"0:1:3 linear\"\nmu_out = [0, 0.2, 1]\nazimuth_deg = [0, 180]\n", "mu_out");
    refused("mu_in = \"0:1:3 linear\"\nmu_out = [0, 1]\nazimuth_deg = \"0:360:90\"\n",
            "without 360");
    refused("mu_in = \"0:1:3 linear\"\nmu_out = [0, 1]\nazimuth_deg = [0, 120, 240]\n", "even");
    CHECK_THROWS_WITH(
        sweep::read_sweep_file(folder.write("c.toml", "layout = \"merl\"\noutputs = [\"brdf\"]\n")),
        Contains("cf, eradiate"));
    // Elsewhere a cosine of 0 is none.
    CHECK_THROWS_WITH(sweep::read_sweep_file(folder.write(
                          "d.toml",
                          "outputs = [\"plane_albedo\"]\n[scene]\nbase = \"hg:0.9,0.3\"\n"
                          "[axes]\nmu_in = [0, 1]\nwavelength_nm = 500\n")),
                      Contains("(0, 1]"));
}
