// Coated particles in the words of a scene: what is read, how much of them there is, and that every
// way through the pipeline sees the whole particle.
#include <miebrdf/brdf.h>
#include <miebrdf/ensemble.h>
#include <miebrdf/error.h>
#include <miebrdf/plan.h>
#include <miebrdf/sphere.h>

#include <cmath>
#include <numbers>
#include <set>

#include "pipeline/solve/resolved_scene.h"
#include "tests/support/catch.h"
#include "tests/support/scenes.h"

using namespace miebrdf;

namespace {

double apart(double value, double truth) { return std::abs(value / truth - 1); }

ResolvedSpecies resolved(const std::string& words, double nm = 550) {
    return resolve(support::scene_of(words), {nm}).media[0].species[0];
}

LayerOptics optics_of(const std::string& words, Packing packing = Packing::independent) {
    Scene scene = support::scene_of(words);
    scene.particles.packing = packing;
    return solve(scene, {550}, {.tolerance = 1e-4}).layers().at(0);
}

void check_same(const LayerOptics& a, const LayerOptics& b, double bound) {
    CHECK(apart(a.single_scattering_albedo, b.single_scattering_albedo) <= bound);
    CHECK(apart(a.asymmetry, b.asymmetry) <= bound);
    CHECK(apart(a.scattering_per_um.value(), b.scattering_per_um.value()) <= bound);
}

}  // namespace

TEST_CASE("coatings are read from inside out and written back", "[pipeline][coated]") {
    const Species s =
        species("TiO2,radius=0.12,coating=SiO2@5nm,coating=index:1.5,0.01@10%,volume=15%");
    REQUIRE(s.coatings.size() == 2);
    CHECK(s.coatings[0] == Coating{.material = {.name = "SiO2"}, .thickness_um = 0.005});
    CHECK(s.coatings[1] == Coating{.material = {.index = {1.5, 0.01}}, .share_of_radius = 0.1});
    CHECK(s.amount->value == 0.15);
    CHECK(species(describe(s)) == s);
    for (const char* share : {"7%", "0.1%", "33.3%", "250%"}) {
        const Species of_share = species(std::string("air,radius=1,coating=PS@") + share);
        CHECK(describe(of_share) == std::string("air,radius=1,coating=PS@") + share);
        CHECK(species(describe(of_share)) == of_share);
    }
    const Layer with_depth = layer("TiO2,radius=0.12,coating=SiO2@5nm,volume=9% in PMMA@40um");
    CHECK(with_depth.medium.species[0].coatings.size() == 1);
    CHECK(with_depth.depth.value == 40);
    CHECK(layer("TiO2,coating=SiO2@5nm@0.1").depth.value == 0.1);
}

TEST_CASE("a coating without thickness or unit is refused", "[pipeline][coated][errors]") {
    CHECK_THROWS_WITH(medium("TiO2,coating=SiO2"), Catch::Contains("coating 'SiO2' has no thick"));
    // The last @ of a layer would be its depth.
    for (const char* words : {"TiO2,coating=SiO2@40um", "TiO2,coating=SiO2@5nm,volume=15%",
                              "TiO2,radius=0.1,coating=index:1.5,0.01@5nm"})
        CHECK_THROWS_WITH(layer(words), Catch::Contains("has no thickness"));
    CHECK_THROWS_WITH(medium("TiO2,coating=SiO2@5"), Catch::Contains("nm"));
    CHECK_THROWS_WITH(medium("TiO2,coating=SiO2@-5nm"), Catch::Contains("-0.005"));
    CHECK_THROWS_WITH(medium("hg:0.9,0.5,coating=SiO2@5nm"), Catch::Contains("no particles"));
    CHECK_THROWS_WITH(resolved("TiO2,radius=0.1,coating=unobtainium@5nm"),
                      Catch::Contains("coating 'unobtainium"));
    CHECK_THROWS_WITH(resolved("index:1,radius=0.1,coating=index:1@5nm"),
                      Catch::Contains("without contrast"));
}

TEST_CASE("volume, density and number count the whole particle", "[pipeline][coated]") {
    // A hollow sphere of one size: all in closed form.
    const double inner = 0.2, outer = 0.25, whole = std::pow(outer / inner, 3);
    const ResolvedSpecies hollow =
        resolved("air,radius=0.2,distribution=mono,coating=PS@50nm,number=1e12/cm3");
    CHECK(apart(hollow.volume_per_core, whole) <= 1e-13);
    CHECK(hollow.outer_radius_um == Approx(outer));
    const double air = 0.001225, polystyrene = 1.05;
    CHECK(apart(*hollow.density_g_cm3, (air + polystyrene * (whole - 1)) / whole) <= 1e-13);
    CHECK(apart(hollow.volume_fraction, 4.0 / 3 * std::numbers::pi * std::pow(outer, 3)) <= 1e-12);

    // Log-normal cores: <r^p> = r_g^p exp(p^2 s^2 / 2).
    const double s2 = std::pow(std::log(1.5), 2), t = 0.02, share = 1.1;
    const auto power = [&](int p) { return std::pow(0.1, p) * std::exp(0.5 * p * p * s2); };
    const double first = std::pow(share, 3) * power(3);
    const double both =
        first + 3 * share * share * t * power(2) + 3 * share * t * t * power(1) + t * t * t;
    const ResolvedSpecies coated =
        resolved("TiO2,median=0.1,sigma_g=1.5,coating=SiO2@10%,coating=Al2O3@20nm");
    CHECK(apart(coated.volume_per_core, both / power(3)) <= 1e-6);
    const ResolvedSpecies titania = resolved("TiO2,radius=1"), silica = resolved("SiO2,radius=1"),
                          alumina = resolved("Al2O3,radius=1");
    const double mass = *titania.density_g_cm3 * power(3) +
                        *silica.density_g_cm3 * (first - power(3)) +
                        *alumina.density_g_cm3 * (both - first);
    CHECK(apart(*coated.density_g_cm3, mass / both) <= 1e-6);
    CHECK(*resolved("TiO2,radius=1,coating=SiO2@10%,density=3").density_g_cm3 == 3);

    // Shares need no mean radius; thicknesses of cores without number have no volume.
    CHECK_NOTHROW(resolved("TiO2,radius=1,variance=0.6,distribution=gamma,coating=SiO2@10%"));
    CHECK_THROWS_WITH(resolved("TiO2,radius=1,variance=0.6,distribution=gamma,coating=SiO2@5nm"),
                      Catch::Contains("no limit") && Catch::Contains("shares"));
}

TEST_CASE("a shell that is no shell changes nothing", "[pipeline][coated]") {
    const std::string core = "index:2.7,0.01,radius=0.2,variance=0.05,distribution=gamma";
    const std::string number = ",number=2e11/cm3 in index:1.5";
    // A coating of no thickness asks for the very same work.
    CHECK(resolved(core + ",coating=SiO2@0nm").key == resolved(core).key);
    // With a coating of the host's index as many cores scatter as much, though more volume is
    // filled.
    const LayerOptics plain = optics_of(core + number);
    check_same(optics_of(core + ",coating=index:1.5@30nm" + number), plain, 1e-9);
    // Thin: of the order of the volume that is added.
    check_same(optics_of(core + ",coating=index:1.7,0.3@1e-6um" + number), plain, 1e-3);
    // Coatings of the core's index, as shares, make larger spheres.
    const std::string large = "index:2.7,0.01,radius=0.22,variance=0.05,distribution=gamma";
    check_same(optics_of(core + ",coating=index:2.7,0.01@4%,coating=index:2.7,0.01@6%" + number),
               optics_of(large + number), 1e-9);
}

TEST_CASE("layers of one index are the plain sphere to rounding", "[pipeline][coated]") {
    const auto [core, whole] =
        GENERATE(std::pair("index:1.5,radius=0.2,distribution=mono,coating=index:1.5@50%",
                           "index:1.5,radius=0.3,distribution=mono"),
                 std::pair("index:1.33,0.1,radius=10,distribution=mono,coating=index:1.33,0.1@10%",
                           "index:1.33,0.1,radius=11,distribution=mono"));
    check_same(optics_of(std::string(core) + ",volume=10%"),
               optics_of(std::string(whole) + ",volume=10%"), 1e-12);
}

TEST_CASE("an average over coated sizes is the sum over single ones", "[pipeline][coated]") {
    // Trapezium in ln r, which converges exponentially for these smooth damped spheres; thick
    // shells on the smallest cores weigh more than their cores do.
    const double r_g = 0.05, s = std::log(1.6), nm = 550, t = 0.03;
    const std::complex<double> core(2.0, 0.4), shell(1.5, 0.05);
    double ext = 0, sca = 0, g = 0, volume = 0;
    for (int i = -700; i <= 700; ++i) {
        const double away = i * 0.01, r = r_g * std::exp(s * away);
        const double weight = std::exp(-0.5 * away * away);
        const double k = 2e3 * std::numbers::pi / nm;
        const std::vector<mie::SphereLayer> layers = {{core, k * r}, {shell, k * (r + t)}};
        const auto one = mie::scatter_by_sphere(layers);
        const double area = std::numbers::pi * (r + t) * (r + t) * weight;
        ext += area * one.q_ext;
        sca += area * one.q_sca;
        g += area * one.q_sca * one.asymmetry;
        volume += weight * 4.0 / 3 * std::numbers::pi * std::pow(r + t, 3);
    }
    const LayerOptics average =
        optics_of("index:2,0.4,median=0.05,sigma_g=1.6,coating=index:1.5,0.05@30nm,volume=10%");
    CHECK(apart(average.single_scattering_albedo, sca / ext) <= 1e-4);
    CHECK(apart(average.asymmetry, g / sca) <= 1e-4);
    CHECK(apart(*average.scattering_per_um + *average.absorption_per_um, 0.1 * ext / volume) <=
          2e-4);
}

TEST_CASE("crowding, polarisation, mixtures and plans see the whole particle",
          "[pipeline][coated]") {
    const std::string coated =
        "index:1.8,radius=0.1,distribution=mono,coating=index:1.8@25%,volume=20%";
    const std::string plain = "index:1.8,radius=0.125,distribution=mono,volume=20%";
    // Their phase tables are interpolated on panels of their own.
    check_same(optics_of(coated, Packing::percus_yevick), optics_of(plain, Packing::percus_yevick),
               1e-6);
    const std::string soot = " + index:1.8,0.8,radius=0.04,distribution=mono,volume=1%";
    check_same(optics_of(coated + soot), optics_of(plain + soot), 1e-12);

    const Directions directions = {{0.5}, {0.7}, {40}};
    const auto polarised = [&](const std::string& words) {
        return solve(support::scene_of(words), {550}, {.stokes = 3}).mueller(directions).mueller[0];
    };
    const std::vector<double> a = polarised(coated), b = polarised(plain);
    for (std::size_t i = 0; i < a.size(); ++i) CHECK(std::abs(a[i] - b[i]) <= 1e-9 * b[0]);

    const Plan of_coated = plan_evaluate(solve(support::scene_of(coated), {550}), directions);
    const Plan of_plain = plan_evaluate(solve(support::scene_of(plain), {550}), directions);
    CHECK(of_coated.seconds() > of_plain.seconds());
}

TEST_CASE("every number of a coating is part of the key", "[pipeline][coated]") {
    const std::string core = "TiO2,radius=0.12";
    std::set<std::string> keys;
    for (const char* coating :
         {"", ",coating=SiO2@5nm", ",coating=SiO2@6nm", ",coating=SiO2@5%", ",coating=Al2O3@5nm",
          ",coating=SiO2@5nm,coating=Al2O3@5nm", ",coating=Al2O3@5nm,coating=SiO2@5nm"})
        CHECK(keys.insert(resolved(core + coating).key[0]).second);
    // Indices are looked up at every wavelength.
    const ResolvedScene two = resolve(support::scene_of(core + ",coating=SiO2@5nm"), {450, 650});
    const auto& particles = two.media[0].species[0].particles;
    CHECK(particles[0].coatings[0].refractive_index != particles[1].coatings[0].refractive_index);
}

TEST_CASE("spheroids by the T-matrix scatter as their average does, and are written back",
          "[pipeline][coated]") {
    const std::string words =
        "index:1.53,0.01,radius=0.2,distribution=mono,shape=spheroid,aspect=2,method=t-matrix";
    CHECK(species(describe(species(words))) == species(words));
    mie::EnsembleRequest request;
    request.sizes.kind = mie::SizeDistributionKind::mono;
    request.sizes.effective_radius_um = 0.2;
    request.refractive_index = {1.53, 0.01};
    request.wavelength_nm = 550;
    request.aspect = 2;
    const mie::EnsembleOptics truth = mie::average_over_sizes(request);
    const LayerOptics layer = optics_of(words + ",volume=1%");
    CHECK(apart(layer.single_scattering_albedo, truth.single_scattering_albedo) <= 1e-4);
    CHECK(apart(layer.asymmetry, truth.asymmetry) <= 1e-4);
    // 3 f Q / (4 r): amounts are volumes, sizes those of spheres of the same volume.
    CHECK(apart(layer.scattering_per_um.value(), 0.75 * 0.01 * truth.q_sca / 0.2) <= 1e-4);
    CHECK_THROWS_WITH(species("index:1.5,shape=koch,method=t-matrix"),
                      Catch::Contains("shape=spheroid"));
    CHECK_THROWS_WITH(species("index:1.5,shape=spheroid,aspect=2,asymmetry=0.8,method=t-matrix"),
                      Catch::Contains("has its own"));
}
