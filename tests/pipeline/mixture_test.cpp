// Amounts, mixtures, hosts and depths: against SNICAR's libraries, exact transfer by another
// program, and what must hold whatever the numbers are.
#include <miebrdf/brdf.h>
#include <miebrdf/error.h>

#include <algorithm>
#include <cmath>
#include <limits>

#include "pipeline/solve/resolved_scene.h"
#include "tests/support/catch.h"
#include "tests/support/reference_table.h"
#include "tests/support/scenes.h"

using namespace miebrdf;
using support::ReferenceTable;
using support::scene_of;

namespace {

// SNICAR's: log-normal with geometric standard deviation s, v_eff = exp(ln^2 s) - 1.
double variance_of(double geometric_deviation) {
    const double s = std::log(geometric_deviation);
    return std::expm1(s * s);
}

Species spheres(double n, double k, double radius_um, double variance, double density) {
    return {.kind = Species::Kind::index,
            .parameters = {n, k},
            .sizes = {radius_um, variance, mie::SizeDistributionKind::log_normal},
            .density_g_cm3 = density};
}

struct Index {
    double n, k;
};
Index ice_index(double wavelength_um) {
    const ReferenceTable table("mixture/snicar_ice_nk.csv");
    for (std::size_t r = 0; r < table.size(); ++r) {
        if (table.number(r, "wavelength_um") == wavelength_um)
            return {table.number(r, "n"), table.number(r, "k")};
    }
    throw std::runtime_error("no such wavelength");
}

Species ice(double wavelength_um, double radius_um) {
    const auto [n, k] = ice_index(wavelength_um);
    return spheres(n, k, radius_um, variance_of(1.5), 0.917);
}

Species black_carbon(double n, double k) {
    // Number median 40 nm: r_eff = r_n exp(5/2 ln^2 s).
    const double s = std::log(1.8);
    return spheres(n, k, 0.04 * std::exp(2.5 * s * s), variance_of(1.8), 1.27);
}

LayerOptics optics_of(const Species& species, double wavelength_nm) {
    Scene scene;
    scene.base = species;
    return solve(scene, {wavelength_nm}, {.tolerance = 1e-4}).layers().at(0);
}

double relative(double value, double truth) { return std::abs(value / truth - 1.0); }

/// Large clear spheres ripple: a smaller tolerance of the average over sizes takes minutes.
double plane_albedo(Scene scene, double nm, double mu_in) {
    scene.particles.tolerance = 5e-5;
    const auto values = solve(scene, {nm}, {.tolerance = 5e-4}).albedo({mu_in});
    CHECK(values.converged());
    return values.at(0, 0);
}

std::vector<double> total(const Scene& scene, double nm = 550) {
    return solve(scene, {nm}).evaluate(support::few_directions()).slices[0].total;
}

double largest_difference(const std::vector<double>& a, const std::vector<double>& b) {
    REQUIRE(a.size() == b.size());
    double largest = 0.0, difference = 0.0;
    for (std::size_t i = 0; i < a.size(); ++i) {
        largest = std::max(largest, std::abs(b[i]));
        difference = std::max(difference, std::abs(a[i] - b[i]));
    }
    return difference / largest;
}

}  // namespace

TEST_CASE("ice has SNICAR's mass extinction, albedo and asymmetry", "[pipeline][mixture]") {
    const ReferenceTable table("mixture/snicar_ice.csv");
    for (std::size_t r = 0; r < table.size(); ++r) {
        const double um = table.number(r, "wavelength_um"), radius = table.number(r, "r_um");
        if (radius > 100) continue;  // minutes
        CAPTURE(um, radius);
        const LayerOptics ours = optics_of(ice(um, radius), 1e3 * um);
        // Averages over sizes of both programs leave this (1.3e-4 and 2e-4 were measured).
        CHECK(relative(*ours.mass_extinction_m2_per_kg, table.number(r, "ext_m2_per_kg")) <= 3e-4);
        CHECK(std::abs(ours.asymmetry - table.number(r, "g")) <= 3e-4);
    }
}

TEST_CASE("black carbon has SNICAR's mass extinction, albedo and asymmetry",
          "[pipeline][mixture]") {
    const ReferenceTable table("mixture/snicar_bc.csv");
    for (std::size_t r = 0; r < table.size(); ++r) {
        const double um = table.number(r, "wavelength_um");
        CAPTURE(um);
        const LayerOptics ours =
            optics_of(black_carbon(table.number(r, "n"), table.number(r, "k")), 1e3 * um);
        CHECK(relative(*ours.mass_extinction_m2_per_kg, table.number(r, "ext_m2_per_kg")) <= 3e-4);
        CHECK(std::abs(ours.asymmetry - table.number(r, "g")) <= 3e-4);
        CHECK(relative(ours.single_scattering_albedo, table.number(r, "ssa")) <= 3e-4);
    }
}

TEST_CASE("snow with soot by mass has the albedo of exact transfer", "[pipeline][mixture]") {
    const ReferenceTable table("mixture/snow.csv"), soot("mixture/snicar_bc.csv");
    for (std::size_t r = 0; r < table.size(); ++r) {
        const double um = table.number(r, "wavelength_um"), radius = table.number(r, "radius_um");
        if (radius > 100 || um == 0.855) continue;  // minutes
        Medium snow = ice(um, radius);
        const double ppb = table.number(r, "soot_ppb");
        CAPTURE(um, radius, ppb);
        for (std::size_t s = 0; s < soot.size() && ppb > 0; ++s) {
            if (soot.number(s, "wavelength_um") != um) continue;
            snow.species.push_back(black_carbon(soot.number(s, "n"), soot.number(s, "k")));
            snow.species.back().amount = {Amount::Kind::mass_fraction, 1e-9 * ppb};
        }
        if (ppb > 0 && snow.species.size() == 1) continue;  // an index that the table lacks
        Scene scene;
        scene.base = snow;
        CHECK(std::abs(plane_albedo(scene, 1e3 * um, 0.65) - table.number(r, "plane_albedo")) <=
              1e-4);
    }
}

TEST_CASE("a given thickness of snow on soil has the depth and albedo of exact transfer",
          "[pipeline][mixture]") {
    const ReferenceTable table("mixture/snow_depth.csv");
    Scene scene;
    scene.substrate = substrate("lambert:0.25");
    scene.particles.layer_density_kg_m3 = 250;
    scene.particles.tolerance = 1e-4;
    Medium snow = ice(0.505, 100);
    snow.species[0].amount = {Amount::Kind::mass_fraction, 1.0};
    for (std::size_t r = 0; r < table.size(); ++r) {
        const double mm = table.number(r, "thickness_mm");
        CAPTURE(mm);
        scene.layers = {{snow, depth(std::to_string(mm) + "mm")}};
        const auto values = solve(scene, {505}, {.tolerance = 5e-4}).albedo({0.65});
        CHECK(values.converged());
        CHECK(std::abs(values.at(0, 0) - table.number(r, "plane_albedo")) <= 1e-4);
        // Four digits after the point; the mass extinction within what SNICAR's check allows.
        const double tau = values.wavelengths[0].optical_depths.at(0);
        CHECK(relative(tau, table.number(r, "optical_depth")) <= 3e-4);
        // A mass over a unit of area is as much, without any density of the layer.
        Scene by_mass = scene;
        by_mass.particles.layer_density_kg_m3.reset();
        by_mass.layers = {{ice(0.505, 100), {Depth::Kind::mass_kg_per_m2, 0.25 * mm}}};
        const auto same = solve(by_mass, {505}, {.tolerance = 5e-4}).albedo({0.65});
        CHECK(relative(same.wavelengths[0].optical_depths.at(0), tau) <= 1e-14);
    }
}

TEST_CASE("a layer's own density counts before the scene's", "[pipeline][mixture]") {
    const std::string snow = "index:1.31,1e-8,radius=20,density=0.917";
    const auto depths = [&](const std::vector<std::string>& layers, double of_scene) {
        Scene scene;
        scene.substrate = substrate("black");
        for (const std::string& words : layers) scene.layers.push_back(layer(words));
        scene.particles.layer_density_kg_m3 = of_scene;
        return solve(scene, {550}).albedo({1}).wavelengths[0].optical_depths;
    };
    const auto two = depths({snow + "@1cm", snow + ",layer-density=300@1cm"}, 150);
    CHECK(std::abs(two.at(1) / two.at(0) - 2) <= 1e-12);
    const auto units = depths({snow + ",layer-density=0.3g/cm3@1cm"}, 150);
    CHECK(std::abs(units.at(0) / two.at(1) - 1) <= 1e-12);
    const Medium own = medium(snow + ",layer-density=300");
    CHECK(medium(describe(own)) == own);
    CHECK_THROWS_WITH(depths({snow + ",mass=0.9,layer-density=300 + index:1.8,0.6,radius=0.1,"
                                     "density=1.5,mass=0.1,layer-density=200@1cm"},
                             150),
                      Catch::Contains("300 and 200"));
    CHECK_THROWS_WITH(medium(snow + ",layer-density=0"), Catch::Contains("layer-density 0"));
}

TEST_CASE("a half-space knows neither density nor thickness", "[pipeline][mixture]") {
    const std::string dirty =
        "index:1.31,1e-8,radius=20,density=0.917 + index:1.8,0.6,radius=0.1,density=1.5,mass=1ppm";
    const Scene plain = scene_of(dirty);
    Scene dense = plain;
    dense.particles.layer_density_kg_m3 = 300;
    CHECK(largest_difference(total(dense), total(plain)) <= 1e-14);
}

TEST_CASE("a species in two halves is the same as whole", "[pipeline][mixture]") {
    const std::string host = " in index:1.5";
    Scene whole = scene_of("index:2.6,0.001,radius=0.3,volume=10%" + host,
                           {"index:1.8,0.1,radius=0.2,volume=0.04" + host + "@3um"});
    Scene halves = scene_of(
        "index:2.6,0.001,radius=0.3,volume=5% + index:2.6,0.001,radius=0.3,volume=5%" + host,
        {"index:1.8,0.1,radius=0.2,volume=0.02 + index:1.8,0.1,radius=0.2,volume=0.02" + host +
         "@3um"});
    // With tables that leave no point of P to be computed anew: what is asked of one follows the
    // number of species.
    whole.particles.tolerance = halves.particles.tolerance = 1e-6;
    CHECK(largest_difference(total(halves), total(whole)) <= 1e-14);
}

TEST_CASE("layers of 1 mm and 4 mm are one of 5 mm", "[pipeline][mixture]") {
    const std::string paint = "index:2.6,0.0001,radius=0.3,volume=0.1% in index:1.5";
    Scene one, two;
    one.substrate = two.substrate = substrate("lambert:0.3");
    one.layers = {layer(paint + "@5mm")};
    two.layers = {layer(paint + "@4mm"), layer(paint + "@1mm")};
    // Points of P are computed anew where the noise of a scene's layers together asks for it, so
    // values agree within the tolerance; what is smooth agrees to rounding.
    CHECK(largest_difference(total(two), total(one)) <= 1e-3);
    Scene smooth_one = one, smooth_two = two;
    smooth_one.layers = {layer("hg:0.99,0.7@5")};
    smooth_two.layers = {layer("hg:0.99,0.7@4"), layer("hg:0.99,0.7@1")};
    // Equations are solved to a hundredth of the tolerance.
    CHECK(largest_difference(total(smooth_two), total(smooth_one)) <= 1e-5);
    // Averages of light with polarisation are others: which are taken follows what it would change.
    const auto thick = solve(one, {550}, {.streams = 24, .stokes = 1}).albedo({0.3, 1.0});
    const auto thin = solve(two, {550}, {.streams = 24, .stokes = 1}).albedo({0.3, 1.0});
    CHECK(relative(thin.at(0, 0), thick.at(0, 0)) <= 1e-12);
    CHECK(relative(thin.plane_transmittance[0][1], thick.plane_transmittance[0][1]) <= 1e-11);
}

TEST_CASE("an optical depth follows the extinction from where it is given",
          "[pipeline][mixture][depth]") {
    const std::string gold = "Au,radius=0.03,distribution=gamma";
    const auto depths = [&](const std::string& at) {
        Scene scene = scene_of("hg:0.9,0.5", {gold + "@0.5" + at});
        scene.particles.host.index = 1.5;
        const auto values = solve(scene, {450, 550, 650}).albedo({1.0});
        std::vector<double> list;
        for (const auto& w : values.wavelengths) list.push_back(w.optical_depths.at(0));
        return list;
    };
    const std::vector<double> at_550 = depths(""), at_450 = depths("[450nm]");
    CHECK(at_550[1] == 0.5);
    CHECK(at_450[0] == 0.5);
    CHECK(depths("[grey]") == std::vector<double>{0.5, 0.5, 0.5});
    // The plasmon: by the ratios of the extinction that Mie theory alone says.
    Scene alone = scene_of(gold);
    alone.particles.host.index = 1.5;
    const auto optics = solve(alone, {450, 550, 650}).layers();
    const auto extinction = [&](std::size_t w) { return *optics[w].mass_extinction_m2_per_kg; };
    // Both averages have the Mie share of the tolerance.
    CHECK(relative(at_550[2] / at_550[1], extinction(2) / extinction(1)) <= 4e-4);
    CHECK(relative(at_450[1] / at_450[0], extinction(1) / extinction(0)) <= 4e-4);
    CHECK(at_550[2] < 0.6 * at_550[1]);  // far from grey: the plasmon is at 540 nm
}

TEST_CASE("a host that absorbs is a species of albedo 0", "[pipeline][mixture]") {
    const std::string pigment = "index:2.6,0,radius=0.2,volume=10% in index:1.5,";
    const auto layer_of = [&](const std::string& k) {
        return solve(scene_of(pigment + k), {500}).layers().at(0);
    };
    const LayerOptics clear = layer_of("0"), tinted = layer_of("1e-4");
    CHECK(*clear.absorption_per_um == 0.0);
    // 4 pi k / lambda of nine tenths of the volume.
    CHECK(relative(*tinted.absorption_per_um, 4 * M_PI * 1e-4 / 0.5 * 0.9) <= 1e-12);
    CHECK(relative(*tinted.scattering_per_um, *clear.scattering_per_um) <= 1e-14);
}

TEST_CASE("amounts in other words are the same amounts", "[pipeline][mixture]") {
    const auto depth_of = [](const std::string& words) {
        Scene scene;
        scene.substrate = substrate("black");
        scene.layers = {layer(words)};
        return solve(scene, {550}).layers().at(0).optical_depth;
    };
    const std::string ball = "index:1.6,0.1,distribution=mono,radius=0.5,density=2";
    // Spheres of 0.5236 um3: 1e9 in a cm3 fill 5.236e-4 of it.
    const double volume = 4.0 / 3.0 * M_PI * 0.125 * 1e9 * 1e-12;
    const double by_volume = depth_of(ball + ",volume=" + std::to_string(volume * 100) + "%@100um");
    CHECK(relative(depth_of(ball + ",number=1e9/cm3@100um"), by_volume) <= 1e-5);  // to_string
    CHECK(depth_of(ball + ",number=1e15/m3@0.1mm") == Approx(depth_of(ball + ",number=1e9@100um")));
    CHECK(depth_of(ball + ",volume=1%@1cm") == Approx(100 * depth_of(ball + ",volume=0.01@100um")));
    // 20 kg of pigment in 100 kg: f = (0.2 / 2) / (0.2 / 2 + 0.8 / 1.25).
    Scene by_mass;
    by_mass.substrate = substrate("black");
    by_mass.particles.layer_density_kg_m3 = 1351.3513513513513;  // 1 / (0.2 / 2 + 0.8 / 1.25)
    by_mass.layers = {layer(ball + ",mass=20%@10um")};
    const double tau = solve(by_mass, {550}).layers().at(0).optical_depth;
    CHECK(relative(tau, depth_of(ball + ",volume=13.513513513513514%@10um")) <= 1e-12);
}

TEST_CASE("where all amounts are 0 there is the host alone, on to which few particles join",
          "[pipeline][mixture]") {
    const auto scene_with = [](const std::string& coat, const std::string& below) {
        Scene scene;
        scene.substrate = substrate(below);
        scene.boundary = boundary("smooth");
        scene.layers = {layer(coat)};
        return scene;
    };
    const std::string ball = "index:2.6,0,radius=0.1,distribution=mono,";
    const SolverOptions fixed{.streams = 16};
    const auto albedos = [&](const Scene& scene) {
        return solve(scene, {450, 550}, fixed).albedo({0.4, 1.0});
    };
    struct Case {
        std::string none, few, host;
    };
    for (const Case& c : {Case{"volume=0", "volume=1e-12", "index:1.5"},
                          Case{"volume=0", "volume=1e-12", "index:1.5,0.003"},
                          Case{"number=0/cm3", "number=1/cm3", "index:1.5,0.003"},
                          Case{"mass=0,density=4", "volume=1e-12", "index:1.5,0.003"}}) {
        CAPTURE(c.none, c.host);
        const std::string in_host = " in " + c.host + "@10um";
        for (const char* below : {"lambert:0.8", "none", "mirror:index:0.2,3"}) {
            CAPTURE(below);
            const auto none = albedos(scene_with(ball + c.none + in_host, below));
            const auto few = albedos(scene_with(ball + c.few + in_host, below));
            for (std::size_t w : {0, 1}) {
                for (std::size_t i : {0, 1}) CHECK(std::abs(none.at(w, i) - few.at(w, i)) <= 1e-9);
                CHECK(std::abs(none.plane_transmittance[w][1] - few.plane_transmittance[w][1]) <=
                      1e-9);
                const double k = c.host == "index:1.5" ? 0.0 : 0.003;
                const double tau = 4 * M_PI * k / (w == 0 ? 0.45 : 0.55) * 10.0;
                CHECK(std::abs(none.wavelengths[w].optical_depths.at(0) - tau) <= 1e-14 * tau);
            }
        }
    }
    // The other species stays, and order does not matter.
    const std::string other = "index:1.9,0.01,radius=0.2,distribution=mono,volume=10%";
    const auto alone = albedos(scene_with(other + " in index:1.5@10um", "lambert:0.8"));
    for (const std::string& words :
         {ball + "volume=0 + " + other, other + " + " + ball + "volume=0"})
        CHECK(albedos(scene_with(words + " in index:1.5@10um", "lambert:0.8")).at(1, 0) ==
              alone.at(1, 0));
    // A half-space of an absorbing host is black below its boundary: Fresnel's ((n-1)/(n+1))^2.
    Scene black = scene_of(ball + "volume=0 in index:1.5,0.003");
    black.boundary = boundary("smooth");
    CHECK(std::abs(albedos(black).at(0, 1) - 0.04) <= 1e-12);
    CHECK_THROWS_WITH(solve(scene_of(ball + "volume=0 in index:1.5"), {550}),
                      Catch::Contains("never comes back"));
    const LayerOptics layer_of =
        solve(scene_with(ball + "volume=0 in index:1.5,0.003@10um", "black"), {550}).layers().at(0);
    CHECK(*layer_of.scattering_per_um == 0.0);
    CHECK(relative(*layer_of.absorption_per_um, 4 * M_PI * 0.003 / 0.55) <= 1e-14);
}

TEST_CASE("amounts that cannot be are refused with the reason", "[pipeline][mixture][errors]") {
    struct Case {
        std::string coat, complaint;
    };
    const auto wrong = GENERATE(
        Case{"index:1.6,0,volume=80%@1um", "0.74"}, Case{"index:1.6,0,volume=-1%@1um", "-0.01"},
        Case{"index:1.6,0,volume=5kg@1um", "%"}, Case{"index:1.6,0,volume=nan@1um", "nan"},
        Case{"index:1.6,0,volume=60% + index:1.7,0,volume=50%@1um", "1.1"},
        Case{"index:1.6,0 + index:1.7,0,volume=50%@1um", "without an amount"},
        Case{"index:1.6,0,mass=60%,density=2 + index:1.7,0,mass=50%,density=2@1um", "1.1"},
        Case{"index:1.6,0,mass=10% + index:1.7,0@1", "density"}, Case{"index:1.6,0@1um", "amounts"},
        Case{"index:1.6,0,volume=5%@1kg/m2", "density"}, Case{"hg:0.9,0.5@1um", "optical depth"},
        Case{"hg:0.9,0.5,volume=5%@1", "volume"},
        Case{"hg:0.9,0.5 + index:1.6,0,volume=5%@1", "hg:0.9,0.5"},
        Case{"index:1.6,0,volume=5%,mass=5%@1um", "more than one amount"},
        Case{"index:1.6,0,density=-1@1", "-1"}, Case{"index:1.6,0,number=0@1", "above 0"},
        Case{"index:1.6,0,mass=0,density=2 in index:1.5@2kg/m2", "above 0"},
        Case{"index:1.6,0,volume=0 in index:1.5@inf", "never comes back"},
        Case{"index:1.6,0,volume=1% in nosuchhost@1um", "nosuchhost"},
        Case{"index:1.6,0 in index:1.5,0.01@1", "absorbs"},
        Case{"index:1.6,0,volume=1% in index:0@1um", "> 0"}, Case{"index:1.6,0@-1um", "-1"},
        Case{"index:1.6,0@1[green]", "green"}, Case{"index:1.6,0@1parsec", "1parsec"},
        Case{"index:1.6,0,volume=1%@nanum", "nan"},
        Case{"index:1.6,0,variance=2,distribution=gamma,number=5@1um", "volume or mass"});
    CAPTURE(wrong.coat);
    const auto ask = [&] {
        Scene scene = scene_of("hg:0.9,0.5");
        scene.layers = {layer(wrong.coat)};
        solve(scene, {550});
    };
    CHECK_THROWS_AS(ask(), Error);
    CHECK_THROWS_WITH(ask(), Catch::Contains(wrong.complaint));
}

TEST_CASE("words of mixtures, depths and grounds read back to what they were",
          "[pipeline][mixture]") {
    for (const char* text :
         {"TiO2,radius=0.13,volume=0.15 + C_graphite,radius=0.04,volume=0.001 in PMMA",
          "H2O_ice,radius=200 + index:1.8,0.6,radius=0.1,density=1.3,mass=1e-07",
          "Au,radius=0.03,number=1000000/cm3 in index:1.5", "TiO2 in index:1.4,0.001"}) {
        CHECK(describe(medium(text)) == text);
    }
    for (const char* text : {"0.1", "0.1[450nm]", "0.1[grey]", "40um", "2kg/m2", "inf"})
        CHECK(describe(depth(text)) == text);
    CHECK(depth("2mm") == Depth(Depth::Kind::thickness_um, 2000));
    CHECK(depth("30g/m2") == Depth(Depth::Kind::mass_kg_per_m2, 0.03));
    for (const char* text : {"black", "none", "lambert:0.25"})
        CHECK(describe(substrate(text)) == text);
}

TEST_CASE("without amounts a host that hardly absorbs is left out, and said so",
          "[pipeline][mixture]") {
    // 4 pi k / lambda = 2.3e-6 per um for k = 1e-7 at 550 nm, of a layer of 1.5 um at 10 %: 1e-6.
    Scene scene;
    scene.substrate = substrate("black");
    const auto resolved_over = [&](const std::string& coat) {
        scene.layers = {layer(coat)};
        return resolve(scene, {550.0});
    };
    const ResolvedScene weak = resolved_over("index:2.5,radius=0.1 in index:1.5,1e-7@0.6");
    CHECK(weak.media.back().host_absorption.front() == 0.0);
    REQUIRE(weak.notes.size() == 2);
    CHECK_THAT(weak.notes.front(), Catch::Contains("left out") && Catch::Contains("1e-07"));
    // Where it could matter: in a thick layer, among large particles, with a larger k.
    for (const char* coat :
         {"index:2.5,radius=0.1 in index:1.5,1e-7@1000",
          "index:2.5,radius=0.1 in index:1.5,1e-7@inf", "index:2.5,radius=50 in index:1.5,1e-7@0.6",
          "index:2.5,radius=0.1 in index:1.5,1e-4@0.6"}) {
        CAPTURE(coat);
        CHECK_THROWS_WITH(resolved_over(coat), Catch::Contains("give amounts"));
    }
}

TEST_CASE("a host that absorbs within a particle's size is said, and refused beyond",
          "[pipeline][mixture]") {
    // k x = 2 pi r k / lambda: at 500 nm and r = 0.5 um it is 6.283 k.
    const auto notes = [](const std::string& host) {
        return resolve(scene_of("TiO2,radius=0.5,volume=10% in " + host), {500}).notes;
    };
    const auto says = [](const std::vector<std::string>& all, const std::string& what) {
        return std::any_of(all.begin(), all.end(), [&](const std::string& note) {
            return note.find(what) != std::string::npos;
        });
    };
    CHECK_FALSE(says(notes("index:1.5,0.001"), "absorbs noticeably"));
    CHECK(says(notes("index:1.5,0.008"), "about 8 % more"));  // 1.6 * 0.0503
    CHECK_THROWS_WITH(notes("index:1.33,0.3"),
                      Catch::Contains("1.88") && Catch::Contains("up to 0.1"));
}
