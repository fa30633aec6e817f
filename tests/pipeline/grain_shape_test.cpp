// Grains that are no spheres, and smooth phase functions: against the published formulas, moments
// that must be kept, and limits of weak absorption.
#include "pipeline/solve/grain_shape.h"

#include <miebrdf/brdf.h>
#include <miebrdf/error.h>

#include <cmath>
#include <numbers>

#include "pipeline/solve/resolved_scene.h"
#include "tests/support/catch.h"
#include "tests/support/reference_table.h"
#include "tests/support/scenes.h"

using namespace miebrdf;

namespace {

MediumOptics optics_in(const std::string& words, double nm, const OpticsDemand& demand = {}) {
    const ResolvedScene scene = resolve(support::scene_of(words), {nm});
    return compute_optics(scene.media[0].species[0], 0, demand);
}

}  // namespace

TEST_CASE("grains of ice have the asymmetry of He et al. (2017) in the middle of each band",
          "[pipeline][grains]") {
    using Grain = GrainShape::Kind;
    struct Row {
        Grain kind;
        double aspect, radius_um, wavelength_nm, albedo, asymmetry;
    };
    // Their equations 6 and 7 with Fu's (2007) geometric part, evaluated by hand in another
    // language; there is no interpolation in the middle of a band.
    for (const Row& row : {Row{Grain::hexagonal_plate, 2.5, 100, 475, 1, 0.797483803118},
                           {Grain::hexagonal_plate, 2.5, 1000, 1055, 0.98, 0.808409231941},
                           {Grain::hexagonal_plate, 0.2, 200, 1055, 0.9999, 0.664511938092},
                           {Grain::spheroid, 0.5, 100, 475, 1, 0.864560085456},
                           {Grain::spheroid, 2, 50, 2200, 0.7, 0.860058847355},
                           {Grain::koch, 2.5, 100, 475, 1, 0.756312709595},
                           {Grain::koch, 2.5, 500, 1655, 0.99, 0.821875735325},
                           {Grain::koch, 10, 300, 3000, 0.53, 0.956905837238}}) {
        CAPTURE(row.radius_um, row.wavelength_nm);
        const double g = grain_asymmetry({.kind = row.kind, .aspect = row.aspect},
                                         row.wavelength_nm, row.radius_um, row.albedo);
        CHECK(std::abs(g - row.asymmetry) <= 1e-11);
    }
    // Between the bands it never leaves the values around; beyond the middles it is held.
    const GrainShape plate{.kind = Grain::hexagonal_plate};
    const auto at = [&](double nm) { return grain_asymmetry(plate, nm, 100, 1); };
    for (double nm = 500; nm < 1055; nm += 50) {
        CHECK(at(nm) >= std::min(at(475), at(1055)));
        CHECK(at(nm) <= std::max(at(475), at(1055)));
    }
    CHECK(at(300) == at(475));
}

TEST_CASE("shapes keep what spheres absorb and have an asymmetry of their own",
          "[pipeline][grains]") {
    const std::string ice = "H2O_ice,radius=60,distribution=log-normal,variance=0.18";
    const MediumOptics spheres = optics_in(ice, 1300, {.highest_moment = 1});
    const MediumOptics plates = optics_in(ice + ",shape=hexagonal-plate", 1300);
    CHECK(plates.optics.one_minus_albedo == Approx(spheres.optics.one_minus_albedo).epsilon(1e-6));
    CHECK(*plates.q_ext == Approx(*spheres.q_ext).epsilon(1e-6));
    CHECK(plates.asymmetry < 0.95 * spheres.asymmetry);
    CHECK(plates.optics.chi[1] == Approx(plates.asymmetry).epsilon(1e-12));
    CHECK(optics_in(ice + ",shape=koch", 1300).asymmetry < plates.asymmetry);
    CHECK(optics_in(ice + ",shape=koch,asymmetry=0.7", 1300).asymmetry == 0.7);
}

TEST_CASE("absorption goes with B where it is weak, and saturates", "[pipeline][grains]") {
    CHECK(enhanced_absorption(1.25, 1e-3) == Approx(1e-3).epsilon(1e-12));
    CHECK(enhanced_absorption(1.6, 1e-7) == Approx(1.28e-7).epsilon(1e-6));
    for (const double of_spheres : {1e-3, 0.1, 0.4, 0.469}) {
        const double grains = enhanced_absorption(1.6, of_spheres);
        CHECK(grains >= of_spheres);
        CHECK(grains <= 0.47);
    }
    CHECK(enhanced_absorption(1.6, 0.48) == 0.48);
    // Large weakly absorbing spheres have B = 1.25: 1 - albedo = B/2 gamma V / A with V / A = 4/3 r
    // (Libois et al. 2013); Mie theory agrees to a few per cent, edges of the spheres included.
    const ResolvedScene scene = resolve(support::scene_of("H2O_ice,radius=100"), {900});
    const double k = scene.media[0].species[0].particles[0].index.imag();
    const double gamma_per_um = 4e3 * std::numbers::pi * k / 900;
    const double b = optics_in("H2O_ice,radius=100", 900).optics.one_minus_albedo /
                     (0.5 * gamma_per_um * 4.0 / 3 * 100);
    CHECK(std::abs(b - 1.25) <= 0.05);
    // Asymptotic theory: -ln of the spherical albedo goes with the root of the absorption.
    const auto albedo = [](const std::string& words) {
        return solve(support::scene_of(words), {900}).albedo({1.0}).spherical_albedo.at(0);
    };
    const std::string grains = "H2O_ice,radius=100,asymmetry=0.86";
    const double ratio = std::log(albedo(grains + ",absorption=1.6")) / std::log(albedo(grains));
    CHECK(std::abs(ratio - std::sqrt(1.6 / 1.25)) <= 0.01);
}

TEST_CASE("snow of plates has the broadband albedo that SNICAR-ADv3 publishes",
          "[pipeline][grains]") {
    // The output of its demonstration (mflanner/SNICARv3, snicar_demo): hexagonal plates of aspect
    // 2.5 and effective radius 100 um, sun at 60 degrees. It solves two streams, we all of
    // transfer, which leaves 0.0008; spheres are at 0.827, Koch flakes at 0.853.
    const support::ReferenceTable flux("mixture/snicar_flux_sza60.csv");
    std::vector<double> wavelengths_nm;
    for (std::size_t r = 0; r < flux.size(); ++r)
        wavelengths_nm.push_back(flux.number(r, "wavelength_nm"));
    const std::string ice =
        "H2O_ice/SNICAR-Pic16,radius=100,variance=0.1787,distribution=log-normal";
    const auto broadband = [&](const std::string& shape) {
        Scene scene = support::scene_of(ice + shape);
        scene.particles.tolerance = 1e-3;
        const auto albedo = solve(scene, wavelengths_nm, {.tolerance = 2e-3}).albedo({0.5});
        double sum = 0, all = 0;
        for (std::size_t r = 0; r < flux.size(); ++r) {
            sum += flux.number(r, "share") * albedo.at(r, 0);
            all += flux.number(r, "share");
        }
        return sum / all;
    };
    CHECK(std::abs(broadband(",shape=hexagonal-plate") - 0.8483) <= 0.0025);
}

TEST_CASE("a smooth phase function has the albedo and asymmetry of Mie theory",
          "[pipeline][grains]") {
    const std::string grit = "index:1.6,0.001,radius=3,variance=0.1,distribution=log-normal";
    OpticsDemand demand{.highest_moment = 6, .angles_deg = {0, 60, 140, 180}, .tolerance = 1e-5};
    const MediumOptics mie = optics_in(grit, 550, demand);
    const MediumOptics one = optics_in(grit + ",phase=henyey-greenstein", 550, demand);
    const MediumOptics two = optics_in(grit + ",phase=double-henyey-greenstein", 550, demand);
    for (const MediumOptics* smooth : {&one, &two}) {
        CHECK(smooth->optics.single_scattering_albedo ==
              Approx(mie.optics.single_scattering_albedo).epsilon(1e-4));
        CHECK(smooth->asymmetry == Approx(mie.asymmetry).epsilon(1e-4));
        CHECK(smooth->phase.size() == 4);
    }
    for (std::size_t l = 0; l < 4; ++l) {
        CAPTURE(l);
        CHECK(one.optics.chi[l] == Approx(std::pow(mie.asymmetry, l)).epsilon(1e-3));
        CHECK(two.optics.chi[l] == Approx(mie.optics.chi[l]).epsilon(1e-3));
    }
    CHECK(one.phase[2] > one.phase[3]);        // no glory
    CHECK(mie.phase[3] > 1.5 * mie.phase[2]);  // there is one
    CHECK(two.phase[3] > 0);
    CHECK_THROWS_WITH(double_lobe(0.5, 0.2, 0.1), Catch::Contains("no two lobes"));
    const DoubleLobe known =
        double_lobe(0.7 * 0.9 - 0.3 * 0.4, 0.7 * 0.81 + 0.3 * 0.16, 0.7 * 0.729 - 0.3 * 0.064);
    CHECK(known.forward == Approx(0.9));
    CHECK(known.backward == Approx(-0.4));
    CHECK(known.share == Approx(0.7));
}

TEST_CASE("grains pass through the whole pipeline", "[pipeline][grains]") {
    // With polarisation asked for, they scatter unpolarised light; in a mixture with spheres too.
    const std::string plates = "H2O_ice,radius=40,shape=hexagonal-plate";
    const auto polarised = solve(support::scene_of(plates), {650}, {.stokes = 3});
    CHECK(std::abs(polarised.mueller({{0.5}, {0.6}, {30}}).mueller[0][1]) <= 1e-12);
    const auto mixed = support::scene_of(plates + " + soot_diesel,radius=0.1,mass=100ppb");
    CHECK(solve(mixed, {650}).albedo({0.5}).converged());
    // Smaller asymmetry: a brighter snow.
    const auto albedo = [](const std::string& words) {
        return solve(support::scene_of(words), {1000}).albedo({0.5}).at(0, 0);
    };
    CHECK(albedo("H2O_ice,radius=40,shape=koch") > albedo("H2O_ice,radius=40") + 0.02);
    CHECK(species(describe(species(plates + ",aspect=4,absorption=1.6,phase=henyey-greenstein"))) ==
          species(plates + ",aspect=4,absorption=1.6,phase=henyey-greenstein"));
}

TEST_CASE("shapes are refused where nothing is known of them", "[pipeline][grains][errors]") {
    const auto refuses = [](const std::string& words, const std::string& why) {
        CHECK_THROWS_WITH(resolve(support::scene_of(words), {550}), Catch::Contains(why));
    };
    refuses("TiO2,radius=1,shape=koch", "of ice");
    refuses("H2O_ice,shape=cube", "hexagonal-plate");
    refuses("H2O_ice,aspect=2", "no aspect");
    refuses("H2O_ice,shape=koch,aspect=50", "50");
    refuses("H2O_ice,shape=koch,phase=mie", "no phase function of Mie");
    refuses("H2O_ice,shape=koch,coating=H2O@5nm", "without coatings");
    refuses("H2O_ice,absorption=9", "9");
    refuses("H2O_ice,asymmetry=1", "below 1");
    refuses("hg:0.9,0.5,shape=koch", "no particles");
    CHECK_THROWS_WITH(resolve(support::scene_of("H2O_ice,shape=koch"), {8000}),
                      Catch::Contains("5000"));
}
