// Crowded spheres: the structure factor and what it does to single scattering.
#include <algorithm>

#include <miebrdf/brdf.h>
#include <miebrdf/error.h>

#include <cmath>
#include <numbers>
#include <string>

#include <Eigen/LU>

#include "pipeline/solve/named_index.h"
#include "pipeline/solve/packing.h"
#include "pipeline/solve/resolved_scene.h"
#include "tests/support/catch.h"
#include "tests/support/scenes.h"

using namespace miebrdf;
using support::scene_of;

namespace {

double relative_error(double value, double truth) { return std::abs(value / truth - 1.0); }

/// Wertheim's closed form; a few of its digits cancel where y is small.
double wertheim(double f, double y) {
    const double gap = std::pow(1 - f, 4), y2 = y * y;
    const double a = std::pow(1 + 2 * f, 2) / gap, b = -6 * f * std::pow(1 + f / 2, 2) / gap;
    const double sine = std::sin(y), cosine = std::cos(y);
    const double third =
        (-y2 * y2 * cosine + 4 * ((3 * y2 - 6) * cosine + (y2 * y - 6 * y) * sine + 6)) /
        (y2 * y2 * y2);
    return 1 /
           (1 + 24 * f *
                    (a * (sine - y * cosine) / (y2 * y) +
                     b * (2 * y * sine + (2 - y2) * cosine - 2) / (y2 * y2) + f / 2 * a * third));
}

Eigen::MatrixXd partial_structure(const HardSpheres& spheres, double q) {
    const Eigen::MatrixXcd Q = baxter_factor(spheres, q);
    const Eigen::MatrixXcd S = (Q.adjoint() * Q).inverse();
    REQUIRE(S.imag().norm() <= 1e-12 * S.norm());
    return S.real();
}

}  // namespace

TEST_CASE("the structure factor of hard spheres has its closed forms", "[pipeline][packing]") {
    for (const double f : {0.01, 0.1, 0.3, 0.45}) {
        // S(0) = (1 - f)^4 / (1 + 2 f)^2.
        const double at_zero = std::pow(1 - f, 4) / ((1 + 2 * f) * (1 + 2 * f));
        CHECK(relative_error(percus_yevick(f, 0.0), at_zero) <= 1e-12);
        // Where the series ends and the closed form begins.
        CHECK(relative_error(percus_yevick(f, 1.0 - 1e-9), percus_yevick(f, 1.0 + 1e-9)) <= 1e-8);
        for (const double y : {2.0, 6.0, 11.0})
            CHECK(relative_error(percus_yevick(f, y), wertheim(f, y)) <= 1e-10);
        CHECK(std::abs(percus_yevick(f, 200.0) - 1) <= 0.01);
    }
    CHECK(relative_error(percus_yevick(1e-9, 3.0), 1.0) <= 1e-7);
}

TEST_CASE("crowded pigments scatter as the tables of dense binders say", "[pipeline][packing]") {
    struct Case {
        std::string species;
        double volume, ratio, scattering, asymmetry;
    };
    // reference/mixture/dense.txt: mu_s' and Q_sca over independent scattering, g; 550 nm.
    const std::string latex = "index:1.59,0,radius=0.05,distribution=mono";
    const std::string silica = "index:1.6,0,radius=0.1,distribution=mono";
    const auto c = GENERATE_COPY(
        Case{latex, 0.01, 0.9587, 0.9478, 0.0899}, Case{latex, 0.1, 0.6154, 0.5622, 0.0151},
        Case{latex, 0.3, 0.1560, 0.1340, -0.0479}, Case{silica, 0.05, 0.9554, 0.8522, 0.4351},
        Case{silica, 0.2, 0.8141, 0.5161, 0.2052});
    CAPTURE(c.species, c.volume);
    const std::string host = c.species == latex ? " in index:1.33" : " in index:1.5";
    Scene scene = scene_of(c.species + ",volume=" + std::to_string(c.volume) + host);
    const auto layer_of = [&](Packing packing) {
        scene.particles.packing = packing;
        return solve(scene, {550}, {.tolerance = 1e-4}).layers().at(0);
    };
    const LayerOptics alone = layer_of(Packing::independent);
    const LayerOptics crowded = layer_of(Packing::percus_yevick);
    // Four digits after the point.
    CHECK(std::abs(*crowded.reduced_scattering_per_um / *alone.reduced_scattering_per_um -
                   c.ratio) <= 2e-4);
    CHECK(std::abs(*crowded.scattering_per_um / *alone.scattering_per_um - c.scattering) <= 2e-4);
    CHECK(std::abs(crowded.asymmetry - c.asymmetry) <= 2e-4);
    // The note of independent scattering says the same.
    scene.particles.packing = Packing::independent;
    const auto said = [](const std::vector<std::string>& notes) {
        return std::count_if(notes.begin(), notes.end(), [](const std::string& note) {
            return note.find("independent") != std::string::npos;
        });
    };
    REQUIRE(said(solve(scene, {550}).albedo({1.0}).notes) == (c.volume > 0.05 ? 1 : 0));
    // Fits, which show no notes, do not compute it.
    NamedIndexMemo memo;
    memo.tells_crowding = false;
    CHECK(said(resolve(scene, {550}, &memo).notes) == 0);
}

TEST_CASE("pigments see the others dissolved in the host", "[pipeline][packing]") {
    struct Case {
        double volume, effective_host, both;
    };
    // Reduced scattering per volume over that of few particles, of rutile at 550 nm computed with
    // a host of Maxwell Garnett's index in place of 1.5: three digits after the point.
    const auto c =
        GENERATE(Case{0.01, 0.981, 0.976}, Case{0.05, 0.908, 0.882}, Case{0.1, 0.819, 0.768},
                 Case{0.2, 0.650, 0.558}, Case{0.3, 0.496, 0.379}, Case{0.4, 0.360, 0.239});
    CAPTURE(c.volume);
    const std::string rutile = "index:2.75,0,radius=0.125,variance=0.05,distribution=log-normal";
    const auto per_volume = [&](double volume, Packing packing) {
        Scene scene = scene_of(rutile + ",volume=" + std::to_string(volume) + " in index:1.5");
        scene.particles.packing = packing;
        const LayerOptics layer = solve(scene, {550}, {.tolerance = 1e-4}).layers().at(0);
        return *layer.reduced_scattering_per_um / volume;
    };
    const double dilute = per_volume(1e-6, Packing::independent);
    CHECK(std::abs(per_volume(c.volume, Packing::effective_host) / dilute - c.effective_host) <=
          1e-3);
    CHECK(std::abs(per_volume(c.volume, Packing::percus_yevick_effective_host) / dilute - c.both) <=
          1e-3);
}

TEST_CASE("the host that particles see is that of the closed form, coatings included",
          "[pipeline][packing]") {
    // Maxwell Garnett by hand for two species: e 4 and 6.25 in 2.25, 10 and 20 %.
    const double beta = 0.1 * (4 - 2.25) / (4 + 4.5) + 0.2 * (6.25 - 2.25) / (6.25 + 4.5);
    const double n = std::sqrt(2.25 * (1 + 2 * beta) / (1 - beta));
    const std::string words =
        "index:2,0,radius=0.1,distribution=mono,volume=10% + "
        "index:2.5,0,radius=0.1,distribution=mono,volume=20%";
    const auto scattering = [](Scene scene, Packing packing) {
        scene.particles.packing = packing;
        return *solve(scene, {550}, {.tolerance = 1e-4}).layers().at(0).scattering_per_um;
    };
    const double truth =
        scattering(scene_of(words + " in index:" + std::to_string(n)), Packing::independent);
    CHECK(relative_error(scattering(scene_of(words + " in index:1.5"), Packing::effective_host),
                         truth) <= 1e-5);
    // A coating of the host's index adds volume and no dipole; one of the core's is a larger
    // sphere.
    const std::string large = "index:2,0,radius=0.1,distribution=mono,volume=10% in index:1.5",
                      small =
                          "index:2,0,radius=0.09,coating=index:2,0@0.01um,distribution=mono,"
                          "volume=10% in index:1.5";
    CHECK(relative_error(scattering(scene_of(small), Packing::effective_host),
                         scattering(scene_of(large), Packing::effective_host)) <= 1e-6);
    // The boundary to the air keeps the binder's index.
    Scene below = scene_of(large);
    below.boundary = rte::Boundary{};
    below.particles.packing = Packing::effective_host;
    const double reflected = solve(below, {550}).albedo({1.0}).mirror_reflectance[0][0];
    CHECK(std::abs(reflected - 0.04) <= 1e-12);
    CHECK_THROWS_AS(scattering(scene_of("index:2,0,radius=0.1"), Packing::effective_host),
                    UsageError);
}

TEST_CASE("the note of crowding has the range over the wavelengths that packing would give",
          "[pipeline][packing]") {
    const std::string words = GENERATE(
        "TiO2,radius=0.13,volume=15% in PMMA",
        "index:1.6,0,radius=0.1,variance=0.1,volume=12% + "
        "index:2,0,radius=0.3,distribution=log-normal,variance=0.05,volume=6% in index:1.5",
        "index:1.6,0,radius=1,variance=0.3,distribution=gamma,volume=20% in index:1.5");
    Scene scene = scene_of(words);
    const std::vector<double> nm =
        GENERATE(std::vector<double>{450, 550, 700}, std::vector<double>{700, 450, 550});
    CAPTURE(words);
    const auto scattering = [&](Packing packing) {
        scene.particles.packing = packing;
        std::vector<double> all;
        for (const double at : nm)
            all.push_back(
                *solve(scene, {at}, {.tolerance = 1e-3}).layers().at(0).reduced_scattering_per_um);
        return all;
    };
    const auto crowded = scattering(Packing::percus_yevick),
               alone = scattering(Packing::independent);
    double least = 1e9, most = 0.0;
    for (std::size_t w = 0; w < nm.size(); ++w) {
        least = std::min(least, crowded[w] / alone[w]);
        most = std::max(most, crowded[w] / alone[w]);
    }
    const auto notes = solve(scene, nm).albedo({1.0}).notes;
    const auto note = std::find_if(notes.begin(), notes.end(), [](const std::string& one) {
        return one.find("independent") != std::string::npos;
    });
    REQUIRE(note != notes.end());
    CAPTURE(*note, least, most);
    const auto number_after = [&](const std::string& text) {
        return std::stod(note->substr(note->find(text) + text.size()));
    };
    // Two digits, and sums over 16 sizes.
    CHECK(relative_error(number_after("would have "), least) <= 0.02);
    CHECK(relative_error(number_after("nm) to "), most) <= 0.06);
}

TEST_CASE("partial structure factors of hard spheres have their limits", "[pipeline][packing]") {
    for (const double q : {0.3, 1.0, 3.0}) {
        // Thin gases: pairs that do not overlap, S_ij = delta_ij - sqrt(n_i n_j) times the
        // transform of a sphere of radius R = (d_i + d_j) / 2; three of them change by its square.
        const HardSpheres thin{{1.0, 1.8}, {1e-6, 2e-6}};
        const Eigen::MatrixXd S = partial_structure(thin, q);
        for (int i = 0; i < 2; ++i) {
            for (int j = 0; j < 2; ++j) {
                const double pi = std::numbers::pi;
                const double R = (thin.diameter[i] + thin.diameter[j]) / 2;
                const double numbers = 6 / pi *
                                       std::sqrt(thin.volume_fraction[i] * thin.volume_fraction[j] /
                                                 std::pow(thin.diameter[i] * thin.diameter[j], 3));
                const double pairs =
                    -numbers * 4 * pi * (std::sin(q * R) - q * R * std::cos(q * R)) / (q * q * q);
                CHECK(std::abs(S(i, j) - (i == j) - pairs) <= 1e-9);
            }
        }
        // Equal spheres under two names, three parts in ten: S_01 = sqrt(.3 .7) (S - 1).
        const Eigen::MatrixXd equal = partial_structure({{2.0, 2.0}, {0.12, 0.28}}, q);
        const double s = percus_yevick(0.4, 2.0 * q);
        CHECK(relative_error(equal(0, 1), std::sqrt(0.21) * (s - 1)) <= 1e-10);
        CHECK(relative_error(equal(0, 0), 1 + 0.3 * (s - 1)) <= 1e-10);
    }
}

TEST_CASE("spheres crowd each other whatever their names and sizes", "[pipeline][packing]") {
    const auto extinction = [](const std::string& medium) {
        Scene scene = scene_of(medium + " in index:1.5");
        scene.particles.packing = Packing::percus_yevick;
        const LayerOptics layer = solve(scene, {550}, {.tolerance = 1e-3}).layers().at(0);
        return *layer.scattering_per_um + *layer.absorption_per_um;
    };
    const auto spheres = [](const std::string& radius, const std::string& volume) {
        return "index:2.7,0,radius=" + radius + ",variance=0.01,volume=" + volume;
    };
    const double whole = extinction(spheres("0.13", "20%"));
    const std::string half = spheres("0.13", "10%");
    CHECK(relative_error(extinction(half + " + " + half), whole) <= 1e-12);
    // Radii that differ by 1e-6 are the same spheres but for as much; cubics between angles.
    CHECK(relative_error(extinction(half + " + " + spheres("0.13000013", "10%")), whole) <= 1e-5);
    CHECK(relative_error(extinction(half + " + " + spheres("0.1313", "10%")), whole) <= 0.03);
    // Few spheres of another size change little.
    CHECK(relative_error(extinction(spheres("0.13", "20%") + " + " + spheres("0.05", "1e-6")),
                         whole) <= 1e-4);
    // Small spheres between large ones: crowded by what these fill.
    const std::string large = "index:1.500001,0,radius=0.3,variance=0.01,volume=30%";
    const double alone = extinction(spheres("0.02", "1%"));
    CHECK(extinction(spheres("0.02", "1%") + " + " + large) > 1.02 * alone);
}

TEST_CASE("equal spheres of two indices crowd each other by their mean amplitude",
          "[pipeline][packing]") {
    // Where spheres are far below the wavelength, F goes like (m^2 - 1) / (m^2 + 2) and S is S(0).
    const auto scattering = [](double n, Packing packing) {
        Scene scene = scene_of(
            "index:1.7,0,radius=0.0002,distribution=mono,volume=10% + index:" + std::to_string(n) +
            ",0,radius=0.0002,distribution=mono,volume=20% in index:1.5");
        scene.particles.packing = packing;
        return *solve(scene, {550}, {.tolerance = 1e-6}).layers().at(0).scattering_per_um;
    };
    const double n = GENERATE(1.7, 1.6, 1.501, 1.45, 1.3);
    const auto amplitude = [](double index) {
        const double m2 = index * index / (1.5 * 1.5);
        return (m2 - 1) / (m2 + 2);
    };
    const double a = amplitude(1.7), b = amplitude(n);
    const double mean = (a + 2 * b) / 3, mean_square = (a * a + 2 * b * b) / 3;
    const double s = std::pow(1 - 0.3, 4) / ((1 + 0.6) * (1 + 0.6));
    const double truth = 1 + (s - 1) * mean * mean / mean_square;
    CAPTURE(n);
    // (k d)^2 = 5e-5 changes S and the amplitudes.
    CHECK(relative_error(
              scattering(n, Packing::percus_yevick) / scattering(n, Packing::independent), truth) <=
          1e-4);
}
