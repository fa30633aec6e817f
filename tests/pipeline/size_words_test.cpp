// Sizes as people have them: what the words say together, against sums over the distributions.
#include <miebrdf/brdf.h>
#include <miebrdf/error.h>
#include <miebrdf/sizes.h>

#include <cmath>
#include <numbers>

#include "pipeline/scene/species_keys.h"
#include "pipeline/solve/resolved_scene.h"
#include "tests/support/catch.h"
#include "tests/support/scenes.h"
#include "tests/support/temporary_folder.h"

using namespace miebrdf;

namespace {

mie::SizeDistribution sizes_in(const std::string& words) {
    return resolve(support::scene_of(words), {550}).media[0].species[0].sizes;
}

/// Shares below a radius, weighted by r^power against area, from shares of area.
double share_below(const mie::SizeDistribution& sizes, double radius_um, int power) {
    const auto [least, most] = mie::radius_range(sizes);
    constexpr int kSteps = 20000;
    double below = 0, all = 0, before = least;
    for (int i = 1; i <= kSteps; ++i) {
        const double here = least * std::pow(most / least, double(i) / kSteps);
        const double middle = std::sqrt(before * here);
        const double part = mie::area_share_within(sizes, {before, here}) * std::pow(middle, power);
        all += part;
        if (middle < radius_um) below += part;
        before = here;
    }
    return below / all;
}

}  // namespace

TEST_CASE("quantiles of diameters are those of the distribution", "[pipeline][size_words]") {
    const auto [by, power] = GENERATE(std::pair("number", -2), std::pair("area", 0),
                                      std::pair("volume", 1), std::pair("mass", 1));
    const std::string of = std::string(",by=") + by;
    for (const auto& sizes :
         {sizes_in("TiO2,d50=300nm,d90=450nm" + of), sizes_in("TiO2,d10=200nm,d50=0.3um" + of),
          sizes_in("TiO2,d10=200nm,d90=450nm" + of)}) {
        CHECK(std::abs(share_below(sizes, 0.15, power) - 0.5) <= 1e-3);
        CHECK(std::abs(share_below(sizes, 0.225, power) - 0.9) <= 1e-3);
    }
    const auto median = sizes_in("TiO2,median=0.15,sigma_g=1.5" + of);
    CHECK(std::abs(share_below(median, 0.15, power) - 0.5) <= 1e-3);
    // Without a word, medians are by number and quantiles by volume.
    CHECK(species("TiO2,d50=0.3,d90=0.4") == species("TiO2,d50=0.3,d90=0.4,by=volume"));
    CHECK(species("TiO2,median=0.3,sigma_g=2") == species("TiO2,median=0.3,sigma_g=2,by=number"));
}

TEST_CASE("Junge's law of exponent 3 is the paper's power law", "[pipeline][size_words]") {
    const std::string limits = ",from=20.485820375655,to=99.514179624345";
    CHECK(mie::effective_radius_of(sizes_in("TiO2,junge=3" + limits)) == Approx(50).epsilon(1e-12));
    const auto layer = [](const std::string& words) {
        return solve(support::scene_of(words), {2000}, {.tolerance = 1e-4}).layers().at(0);
    };
    const std::string ice = "index:1.3,0.01,volume=10%";
    const LayerOptics junge = layer(ice + ",junge=3" + limits), paper = layer(ice + ",radius=50");
    CHECK(junge.single_scattering_albedo == Approx(paper.single_scattering_albedo).epsilon(1e-4));
    CHECK(junge.asymmetry == Approx(paper.asymmetry).epsilon(1e-4));
    CHECK(*junge.scattering_per_um == Approx(*paper.scattering_per_um).epsilon(1e-4));

    // Any exponent: r_eff = <r^3>/<r^2> in closed form; a smaller radius at the steeper law.
    const auto ratio = [](double p) {
        const auto integral = [](double n) {
            return n == 0 ? std::log(10 / 0.1) : (std::pow(10, n) - std::pow(0.1, n)) / n;
        };
        return integral(4 - p) / integral(3 - p);
    };
    for (const double p : {0.0, 2.5, 3.0, 4.0, 5.5}) {
        const auto sizes = sizes_in("TiO2,from=0.1,to=10um,junge=" + std::to_string(p));
        CHECK(mie::effective_radius_of(sizes) == Approx(ratio(p)).epsilon(1e-9));
    }
    CHECK_THROWS_WITH(species("TiO2,junge=4,from=1"), Catch::Contains("two limits"));
    CHECK_THROWS_WITH(species("TiO2,junge=4,from=1,to=0.5"), Catch::Contains("larger one last"));
    CHECK_THROWS_WITH(species("TiO2,junge=40,from=1,to=2"), Catch::Contains("40"));
    CHECK(species(describe(species("TiO2,junge=4,from=1,to=2"))) ==
          species("TiO2,junge=4,from=1,to=2"));
}

TEST_CASE("averages over Junge's law are sums over its sizes", "[pipeline][size_words]") {
    // A table of the same law, fine enough for 1e-4.
    const support::TemporaryFolder folder;
    std::string table = "radius_um,dn_dlnr\n";
    for (int i = 0; i <= 3000; ++i) {
        const double r = 0.05 * std::pow(200.0, i / 3000.0);
        table += std::to_string(r) + "," + std::to_string(std::pow(r, -3)) + "\n";
    }
    const std::string of = "index:1.53,0.008,volume=1%";
    const auto layer = [&](const std::string& sizes) {
        return solve(support::scene_of(of + sizes), {550}, {.tolerance = 1e-4}).layers().at(0);
    };
    const LayerOptics law = layer(",junge=4,from=0.05,to=10");
    const LayerOptics rows = layer(",sizes:" + folder.write("t.csv", table));
    CHECK(law.single_scattering_albedo == Approx(rows.single_scattering_albedo).epsilon(3e-4));
    CHECK(law.asymmetry == Approx(rows.asymmetry).epsilon(5e-4));
    CHECK(*law.scattering_per_um == Approx(*rows.scattering_per_um).epsilon(1e-3));
}

TEST_CASE("a specific surface is a radius", "[pipeline][size_words]") {
    CHECK(sizes_in("H2O_ice,ssa=20m2/kg").effective_radius_um ==
          Approx(3e3 / (0.917 * 20)).epsilon(1e-12));
    CHECK(sizes_in("H2O_ice,ssa=200cm2/g").effective_radius_um ==
          Approx(3e3 / (0.917 * 20)).epsilon(1e-12));
    CHECK(sizes_in("index:1.5,ssa=1m2/g,density=2").effective_radius_um ==
          Approx(1.5).epsilon(1e-12));
    CHECK_THROWS_WITH(sizes_in("index:1.5,ssa=20m2/kg"), Catch::Contains("density"));
    CHECK_THROWS_WITH(species("H2O_ice,ssa=0m2/kg"), Catch::Contains("0"));
    CHECK_THROWS_WITH(species("H2O_ice,ssa=20"), Catch::Contains("m2/kg"));
    CHECK(describe(species("H2O_ice,ssa=20m2/kg,variance=0.1")) ==
          "H2O_ice,ssa=20m2/kg,variance=0.1");
}

TEST_CASE("tables of sizes are read in the forms that instruments print",
          "[pipeline][size_words]") {
    // Classes around 1, 2 and 4 um meet at sqrt(2) and 2 sqrt(2): dN/dr = share / width / r^3.
    const support::TemporaryFolder folder;
    const auto sizes = sizes_in("TiO2,sizes=" + folder.write("classes.csv",
                                                             "diameter_um,volume_share\n"
                                                             "2,10\n4,30\n8,20\n"));
    REQUIRE(sizes.radii_um == std::vector<double>{1, 2, 4});
    const double root = std::sqrt(2.0);
    CHECK(sizes.number_density[0] == Approx(10 / (root - 1 / root)));
    CHECK(sizes.number_density[1] == Approx(30 / (2 * root - root) / 8));
    CHECK(sizes.number_density[2] == Approx(20 / (4 * root - 2 * root) / 64));
    const auto same = sizes_in("TiO2,sizes=" + folder.write("n.csv",
                                                            "radius_nm,number_density\n"
                                                            "1000,1\n2000,3\n4000,0.5\n"));
    CHECK(same.number_density == std::vector<double>{1, 3, 0.5});
    CHECK_THROWS_WITH(species("TiO2,sizes=" + folder.write("a.csv", "x,number_share\n1,1\n2,1\n")),
                      Catch::Contains("has no sizes") && Catch::Contains("diameter_um"));
    CHECK_THROWS_WITH(
        species("TiO2,sizes=" + folder.write("b.csv", "radius_um,dn_dlnr\n2,1\n1,1\n")),
        Catch::Contains("ascending"));
    CHECK_THROWS_WITH(species("TiO2,sizes=nowhere.csv"), Catch::Contains("nowhere.csv"));
}

TEST_CASE("words that say the sizes twice are refused", "[pipeline][size_words]") {
    for (const char* words :
         {"TiO2,radius=1,median=1,sigma_g=2", "TiO2,median=1,sigma_g=2,ssa=3m2/kg",
          "TiO2,d50=1,d90=2,variance=0.1", "TiO2,junge=4,from=1,to=2,radius=1",
          "TiO2,radius=1,ssa=20m2/kg", "TiO2,d50=1,d90=2,distribution=gamma"})
        CHECK_THROWS_WITH(species(words), Catch::Contains("say radius, variance"));
    CHECK_THROWS_WITH(species("TiO2,d50=1"), Catch::Contains("two of d10"));
    CHECK_THROWS_WITH(species("TiO2,d50=2,d90=1"), Catch::Contains("sigma_g"));
    CHECK_THROWS_WITH(species("TiO2,median=1,sigma_g=2,by=weight"), Catch::Contains("volume"));
    CHECK_THROWS_WITH(species("TiO2,d50=1,d50=2"), Catch::Contains("twice"));
}
