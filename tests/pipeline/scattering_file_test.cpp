// Files of single scattering, written here by Mie theory in the forms that databases have, and read
// back: the same albedo, asymmetry, extinction and phase function must come out.
#include <miebrdf/brdf.h>
#include <miebrdf/ensemble.h>
#include <miebrdf/error.h>
#include <miebrdf/sphere.h>

#include <algorithm>
#include <cmath>
#include <map>
#include <numbers>

#include <fmt/format.h>
#include "pipeline/solve/resolved_scene.h"
#include "pipeline/solve/single_scattering.h"
#include "tests/support/catch.h"
#include "tests/support/database_particles.h"
#include "tests/support/scenes.h"
#include "tests/support/temporary_folder.h"

using namespace miebrdf;

namespace {

constexpr std::complex<double> kDrop = {1.45, 1e-3};

mie::EnsembleRequest drops(double nm) {
    mie::EnsembleRequest request;
    request.sizes = {mie::SizeDistributionKind::log_normal, 0.4, 0.2};
    request.refractive_index = kDrop;
    request.wavelength_nm = nm;
    request.tolerance = 1e-6;
    return request;
}

std::vector<double> half_degrees() {
    std::vector<double> angles;
    for (int i = 0; i <= 360; ++i) angles.push_back(0.5 * i);
    return angles;
}

MediumOptics read_optics(const std::string& words, double nm) {
    const ResolvedScene scene = resolve(support::scene_of(words), {nm});
    return compute_optics(scene.media[0].species[0], 0, {.highest_moment = 8, .tolerance = 1e-6});
}

LayerOptics layer_in(const std::string& words, double nm) {
    return solve(support::scene_of(words), {nm}, {.tolerance = 1e-4}).layers().at(0);
}

double mean_area() { return mie::mean_cross_section_um2(drops(550).sizes); }

/// A component file as OPAC has it: 1/km of one particle in a cm3.
std::string opac_text(const std::vector<double>& wavelengths_nm) {
    std::string spectra, names, rows;
    std::vector<mie::EnsembleOptics> all;
    for (const double nm : wavelengths_nm) {
        mie::EnsembleRequest request = drops(nm);
        request.angles_deg = half_degrees();
        request.phase_tolerance = 1e-4;
        all.push_back(mie::average_over_sizes(request));
        const double ext = 1e-3 * mean_area() * all.back().q_ext;
        const double albedo = all.back().single_scattering_albedo;
        spectra +=
            fmt::format("# {:.3E} {:.6E} {:.6E} {:.6E} {:.6E} {:.3E} 1.0 1.45 -1E-3\n", nm / 1e3,
                        ext, albedo * ext, (1 - albedo) * ext, albedo, all.back().asymmetry);
    }
    for (std::size_t a = 0; a < half_degrees().size(); ++a) {
        rows += fmt::format("  {:.3E} ", half_degrees()[a]);
        for (const auto& optics : all) rows += fmt::format(" {:.5E}", 0.01 * optics.phase[a]);
        rows += "\n";
    }
    return "# drops\n#\n# optical parameters:\n# -----\n#\n# wavelength ext.coef\n#\n" + spectra +
           "#\n# volume phase function [1/km]:\n# ----\n" + rows;
}

}  // namespace

TEST_CASE("a component file of OPAC gives what Mie theory put in", "[pipeline][scattering]") {
    const support::TemporaryFolder folder;
    const std::string file = folder.write("drop00", opac_text({450, 550, 650}));
    for (const double nm : {450.0, 550.0, 650.0}) {
        const mie::EnsembleOptics truth = [&] {
            mie::EnsembleRequest request = drops(nm);
            request.highest_moment = 8;
            return mie::average_over_sizes(request);
        }();
        const MediumOptics read = read_optics("scattering:" + file, nm);
        CAPTURE(nm);
        CHECK(std::abs(read.optics.single_scattering_albedo - truth.single_scattering_albedo) <=
              2e-6);  // six digits
        // Half degrees and log-linear interpolation between them.
        for (std::size_t l = 0; l <= 8; ++l)
            CHECK(std::abs(read.optics.chi[l] - truth.chi[l]) <= 3e-4);
        CHECK(*read.q_ext == Approx(mean_area() * truth.q_ext).epsilon(1e-5));
    }
    // An optical depth follows the extinction; numbers make a thickness of it.
    const auto depths = [&](const std::string& depth) {
        const Brdf brdf = solve(support::scene_of("isotropic:0.5", {"scattering:" + file + depth}),
                                {450, 550, 650});
        std::vector<double> found;
        for (const LayerOptics& layer : brdf.layers()) {
            if (layer.layer == "coat 1") found.push_back(layer.optical_depth);
        }
        return found;
    };
    const auto q = [](double nm) { return mie::average_over_sizes(drops(nm)).q_ext; };
    CHECK(depths("@0.3")[0] == Approx(0.3 * q(450) / q(550)).epsilon(1e-4));
    CHECK(depths(",number=1e6/cm3@1m")[2] ==
          Approx(1e-6 * 1e6 * mean_area() * q(650)).epsilon(1e-4));
    // Between wavelengths linear.
    const double halfway = *read_optics("scattering:" + file, 500).q_ext;
    CHECK(halfway == Approx(0.5 * mean_area() * (q(450) + q(550))).epsilon(1e-4));
    CHECK_THROWS_WITH(read_optics("scattering:" + file, 700),
                      Catch::Contains("450") && Catch::Contains("650"));
}

TEST_CASE("a T-matrix program's list of coefficients is read whole", "[pipeline][scattering]") {
    // There b1 and b2 have the other sign, as their functions do (tests/mie/spheroid_test.cpp
    // compares with what the program printed).
    const mie::MatrixOptics truth = mie::average_matrix(drops(550));
    std::vector<double> a1(truth.optics.chi);
    for (std::size_t l = 0; l < a1.size(); ++l) a1[l] *= 2.0 * static_cast<double>(l) + 1.0;
    const auto text = [&](std::size_t count) {
        std::string list = fmt::format(
            "LAM=  0.550000   MRR=0.145D+01   MRI=0.100D-02\nCEXT={:.6E}  CSCA=0.1  W={:.6E}  "
            "<COS>=0.7\n \n   S      ALPHA1      ALPHA2      ALPHA3      ALPHA4       BETA1       "
            "BETA2\n",
            mean_area() * truth.optics.q_ext, truth.optics.single_scattering_albedo);
        std::replace(list.begin(), list.end(), 'E', 'D');
        list.replace(list.find("CDXT"), 4, "CEXT");
        list.replace(list.find("BDTA1"), 5, "BETA1");
        list.replace(list.find("BDTA2"), 5, "BETA2");
        for (std::size_t l = 0; l < count; ++l) {
            const auto& e = truth.expansion;
            list += fmt::format("{:4} {:11.5f} {:11.5f} {:11.5f} {:11.5f} {:11.5f} {:11.5f}\n", l,
                                a1[l], e.a2[l], e.a3[l], e.a4[l], -e.b1[l], -e.b2[l]);
        }
        return list + " \n      <        F11\n";
    };
    const support::TemporaryFolder folder;
    const std::string whole = folder.write("tmd.out", text(a1.size()));
    const MediumOptics read = read_optics("scattering:" + whole, 550);
    CHECK(std::abs(read.asymmetry - truth.optics.asymmetry) <= 1e-5);
    REQUIRE(read.optics.polarisation);
    CHECK(read.optics.polarisation->b1[2] == Approx(truth.expansion.b1[2]).margin(1e-5));
    CHECK_THROWS_WITH(read_optics("scattering:" + whole, 600), Catch::Contains("nothing at 600"));
    CHECK(read_optics("scattering:" + whole, 550.2).asymmetry == read.asymmetry);
    CHECK(resolve(support::scene_of("scattering:" + whole), {550}).notes.empty());

    // Not so short that P is negative, which is refused.
    std::size_t count = a1.size();
    while (count > 1 && std::abs(a1[count - 1]) < 0.015) --count;
    const std::string cut = folder.write("cut.out", text(count));
    const auto notes = resolve(support::scene_of("scattering:" + cut), {550}).notes;
    REQUIRE_FALSE(notes.empty());
    CHECK_THAT(notes[0], Catch::Contains("look cut"));
}

TEST_CASE("a table of sizes is averaged over sizes of one's own", "[pipeline][scattering]") {
    // Spheres of 0.02 to 4 um as the databases of ice and dust list particles.
    std::string rows, phases;
    for (const double angle : half_degrees()) phases += fmt::format("{} ", angle);
    phases += "\n";
    for (const double nm : {500.0, 600.0}) {
        for (int i = 0; i <= 150; ++i) {
            const double r = 0.02 * std::pow(200.0, i / 150.0), x = 2e3 * std::numbers::pi * r / nm;
            const auto sphere = mie::scatter_by_sphere(kDrop, x);
            const auto amplitudes = mie::scattering_amplitudes(kDrop, x, half_degrees());
            rows +=
                fmt::format("{:.7E} {:.7E} {:.7E} {:.7E} {:.7E} {:.7E} {:.7E}\n", nm / 1e3, 2 * r,
                            4.0 / 3 * std::numbers::pi * r * r * r, std::numbers::pi * r * r,
                            sphere.q_ext, sphere.q_sca / sphere.q_ext, sphere.asymmetry);
            for (std::size_t a = 0; a < half_degrees().size(); ++a) {
                const double p = 2 * (std::norm(amplitudes.s1[a]) + std::norm(amplitudes.s2[a])) /
                                 (x * x * sphere.q_sca);
                phases += fmt::format("{:.6E} ", p);
            }
            phases += "\n";
        }
    }
    const support::TemporaryFolder folder;
    const std::string file = folder.write("isca.dat", rows);
    CHECK_THROWS_WITH(medium("scattering:" + file), Catch::Contains("P11.dat"));
    folder.write("P11.dat", phases);
    CHECK_FALSE(read_optics("scattering:" + file + ",radius=0.4,distribution=mono", 500)
                    .optics.polarisation);
    const std::string sizes = ",radius=0.4,variance=0.2,distribution=log-normal";
    for (const double nm : {500.0, 600.0}) {
        mie::EnsembleRequest request = drops(nm);
        request.highest_moment = 8;
        const mie::EnsembleOptics truth = mie::average_over_sizes(request);
        const MediumOptics read = read_optics("scattering:" + file + sizes, nm);
        // 150 sizes, linear between them.
        CHECK(*read.q_ext == Approx(truth.q_ext).epsilon(3e-3));
        CHECK(read.optics.single_scattering_albedo ==
              Approx(truth.single_scattering_albedo).epsilon(1e-4));
        for (std::size_t l = 0; l <= 8; ++l)
            CHECK(std::abs(read.optics.chi[l] - truth.chi[l]) <= 2e-3);
    }
    // Amounts by volume, mass and number are those of the spheres.
    const std::string spheres = "index:1.45,1e-3" + sizes;
    for (const char* amount : {",volume=1%", ",number=1e9/cm3"}) {
        const LayerOptics read = layer_in("scattering:" + file + sizes + amount, 500),
                          truth = layer_in(spheres + amount, 500);
        CHECK(*read.scattering_per_um == Approx(*truth.scattering_per_um).epsilon(3e-3));
    }
    // In a mixture with spheres.
    const std::string soot = " + index:1.8,0.8,radius=0.05,volume=0.1%";
    const LayerOptics mixed = layer_in("scattering:" + file + sizes + ",volume=1%" + soot, 500),
                      truth = layer_in(spheres + ",volume=1%" + soot, 500);
    CHECK(mixed.single_scattering_albedo == Approx(truth.single_scattering_albedo).epsilon(2e-3));
    CHECK_THROWS_WITH(read_optics("scattering:" + file, 500), Catch::Contains("radius=1"));
    CHECK_THROWS_WITH(read_optics("scattering:" + file + ",radius=50", 500),
                      Catch::Contains("reach"));
}

TEST_CASE("databases with all elements of the matrix polarise", "[pipeline][scattering]") {
    // One sphere at two sizes, as a table and as tamudust2020single writes one particle.
    const std::vector<double> angles = support::even_angles(0.5);
    const support::TemporaryFolder folder;
    std::string rows, csv = "# single_scattering_albedo: 0.9\nangle_deg,p11,p12,p22,p33,p34,p44\n",
                      single;
    std::map<std::string, std::string> elements;
    for (const auto& name : {"P11", "P12", "P22", "P33", "P43", "P44"}) {
        for (const double angle : angles) elements[name] += fmt::format("{} ", angle);
    }
    for (const double r : {0.3, 0.4}) {
        const double x = 2e3 * std::numbers::pi * r / 500;
        const auto one = support::database_sphere(kDrop, x, angles);
        rows += fmt::format("0.5 {} {:.9E} {:.9E} {:.9E} {:.9E} {:.9E}\n", 2 * r,
                            4.0 / 3 * std::numbers::pi * r * r * r, std::numbers::pi * r * r,
                            one.sphere.q_ext, one.sphere.q_sca / one.sphere.q_ext,
                            one.sphere.asymmetry);
        if (r == 0.3) folder.write("isca.txt", rows);
        for (auto& [name, text] : elements) text += "\n";
        for (std::size_t a = 0; a < angles.size(); ++a) {
            const rte::ScatteringMatrix& m = one.matrix[a];
            const auto put = [&](const char* name, double value) {
                elements[name] += fmt::format("{:.7E} ", value);
            };
            put("P11", m.a1);
            put("P12", m.b1 / m.a1);
            put("P22", m.a2 / m.a1);
            put("P33", m.a3 / m.a1);
            put("P43", -m.b2 / m.a1);
            put("P44", m.a4 / m.a1);
            if (r != 0.3) continue;
            single += fmt::format("{} {} {} {} {} {} {}\n", angles[a], m.a1, m.b1 / m.a1,
                                  m.a2 / m.a1, m.a3 / m.a1, -m.b2 / m.a1, m.a4 / m.a1);
            csv += fmt::format("{},{},{},{},{},{},{}\n", angles[a], 7 * m.a1, 7 * m.b1, 7 * m.a2,
                               7 * m.a3, 7 * m.b2, 7 * m.a4);
        }
    }
    const std::string table = folder.write("isca.dat", rows);
    for (const auto& [name, text] : elements) folder.write(name + ".dat", text);
    folder.write("PMat.txt", single);
    mie::EnsembleRequest sphere = drops(500);
    sphere.sizes = {mie::SizeDistributionKind::mono, 0.3};
    const mie::MatrixOptics truth = mie::average_matrix(sphere);
    for (const std::string& words : {table + ",radius=0.3,distribution=mono", folder / "isca.txt",
                                     folder.write("m.csv", csv)}) {
        const MediumOptics read = read_optics("scattering:" + words, 500);
        CAPTURE(words);
        REQUIRE(read.optics.polarisation);
        for (std::size_t l = 2; l <= 8; ++l) {
            CAPTURE(l);
            CHECK(std::abs(read.optics.chi[l] - truth.optics.chi[l]) <= 1e-4);
            for (const auto& [name, list] : kMatrixLists) {
                const double error =
                    std::abs((*read.optics.polarisation.*list)[l] - (truth.expansion.*list)[l]);
                CHECK(error <= 2e-4 * (2.0 * double(l) + 1.0));
            }
        }
    }
}

TEST_CASE("impossible scattering is refused with the angle and the value",
          "[pipeline][scattering][errors]") {
    const support::TemporaryFolder folder;
    const auto refuses = [&](const std::string& text, const std::string& why) {
        CHECK_THROWS_WITH(medium("scattering:" + folder.write("f.csv", text)),
                          Catch::Contains(why));
    };
    const std::string head = "# single_scattering_albedo: 0.9\nangle_deg,p11\n";
    CHECK_NOTHROW(medium("scattering:" + folder.write("g.csv", head + "0,9\n90,1\n180,2\n")));
    refuses(head + "0,9\n90,-0.1\n180,2\n", "-0.1 at 90 degrees");
    refuses(head + "0,9\n90,1\n", "from 0 to 180");
    refuses(head + "0,0\n90,0\n180,0\n", "0 at all angles");
    refuses("angle_deg,p11\n0,9\n90,1\n180,2\n", "single_scattering_albedo");
    const std::string matrix =
        "# single_scattering_albedo: 0.9\nangle_deg,p11,p12,p22,p33,p34,p44\n";
    const auto rows = [](const std::string& middle) {
        return "0,9,0,9,9,0,9\n" + middle + "180,2,0,2,-2,0,-2\n";
    };
    CHECK_NOTHROW(
        medium("scattering:" + folder.write("g.csv", matrix + rows("90,1,-1,1,0,0,0\n"))));
    refuses(matrix + rows("90,1,-1.2,1,0,0,0\n"), "90 degrees");
    refuses(matrix + rows("60,1,0,1,1,0,0.2\n"), "eigenvalue -0.4");
    refuses("# single_scattering_albedo: 0.9\nangle_deg,p11,p12\n0,9,0\n90,1,0\n180,2,0\n",
            "expected: p12, p22");
    refuses("# single_scattering_albedo: 1.2\nangle_deg,p11\n0,9\n90,1\n180,2\n", "1.2");
    const std::string words = "scattering:" + folder.write("h.csv", head + "0,9\n90,1\n180,2\n");
    CHECK_THROWS_WITH(medium(words + ",volume=3%"), Catch::Contains("number="));
    CHECK_THROWS_WITH(medium(words + ",coating=SiO2@5nm"), Catch::Contains("leave"));
    CHECK(describe(species(words + ",number=3/cm3")) == words + ",number=3/cm3");
}
