// NetCDF files of single scattering, written here by Mie theory with the variables that other
// programs and databases have, and read back.
#include <miebrdf/brdf.h>
#include <miebrdf/ensemble.h>
#include <miebrdf/error.h>

#include <array>
#include <cmath>
#include <map>
#include <memory>
#include <numbers>

#include <fmt/format.h>
#include "pipeline/io/netcdf_file.h"
#include "pipeline/solve/resolved_scene.h"
#include "pipeline/solve/single_scattering.h"
#include "rte/phase/polarisation.h"
#include "tests/support/catch.h"
#include "tests/support/database_particles.h"
#include "tests/support/scenes.h"
#include "tests/support/temporary_folder.h"

using namespace miebrdf;

namespace {

constexpr std::complex<double> kGrain = {1.45, 1e-3};

/// A variable over named dimensions; the sizes of dimensions come with their first variable.
struct Variable {
    std::string name;
    std::vector<std::string> dimensions;
    std::vector<double> values;
};

std::string write_netcdf(const std::string& path, const std::map<std::string, std::size_t>& sizes,
                         const std::vector<Variable>& variables) {
    const auto file = make_netcdf_file(path, "write");
    file->create(path);
    std::map<std::string, int> dimension;
    for (const auto& [name, size] : sizes) dimension[name] = file->define_dimension(name, size);
    std::vector<int> numbers;
    for (const Variable& v : variables) {
        std::vector<int> over;
        for (const std::string& name : v.dimensions) over.push_back(dimension.at(name));
        numbers.push_back(file->define_variable(v.name, NetcdfFile::Type::number, over));
    }
    file->end_definitions();
    for (std::size_t i = 0; i < variables.size(); ++i) file->write(numbers[i], variables[i].values);
    file->close();
    return path;
}

MediumOptics optics_at(const std::string& words, double nm) {
    const ResolvedScene scene = resolve(support::scene_of(words), {nm});
    return compute_optics(scene.media[0].species[0], 0, {.highest_moment = 8, .tolerance = 1e-6});
}

double grain_parameter(double radius_um, double nm) {
    return 2e3 * std::numbers::pi * radius_um / nm;
}

/// The sphere of this radius: efficiencies to rounding; the matrix at its own angles to the digits
/// of single numbers, the coefficients to what interpolation between half degrees leaves.
void check_sphere(const std::string& words, double radius_um, double nm) {
    const std::vector<double> angles = support::even_angles(0.5);
    const auto truth = support::database_sphere(kGrain, grain_parameter(radius_um, nm), angles);
    const MediumOptics read = optics_at(words, nm);
    CAPTURE(words, nm);
    CHECK(*read.q_ext == Approx(truth.sphere.q_ext).epsilon(1e-6));
    CHECK(read.optics.single_scattering_albedo ==
          Approx(truth.sphere.q_sca / truth.sphere.q_ext).epsilon(1e-6));
    CHECK(std::abs(read.asymmetry - truth.sphere.asymmetry) <= 1e-4);
    REQUIRE(read.optics.polarisation);
    REQUIRE(read.optics.polarisation->matrix);
    // Without the exact function, the coefficients alone.
    rte::Optics series = read.optics;
    rte::Polarisation coefficients = *series.polarisation;
    coefficients.matrix = {};
    series.polarisation = std::make_shared<const rte::Polarisation>(coefficients);
    for (const std::size_t a : {20u, 90u, 180u, 300u, 350u}) {
        const double x = std::cos(angles[a] * std::numbers::pi / 180.0);
        CAPTURE(angles[a]);
        for (const rte::Optics& optics : {read.optics, series}) {
            const rte::ScatteringMatrix m = rte::exact_matrix(optics, x), t = truth.matrix[a];
            for (auto element : {&rte::ScatteringMatrix::a1, &rte::ScatteringMatrix::a2,
                                 &rte::ScatteringMatrix::a3, &rte::ScatteringMatrix::a4,
                                 &rte::ScatteringMatrix::b1, &rte::ScatteringMatrix::b2})
                CHECK(std::abs(m.*element - t.*element) <= 1e-3 * t.a1 + 2e-4);
        }
    }
}

}  // namespace

TEST_CASE("libRadtran's files are read with their scattering matrix",
          "[pipeline][scattering][netcdf]") {
    if (!has_netcdf()) {
        WARN("skipped: this build has no NetCDF");
        return;
    }
    const support::TemporaryFolder folder;
    const std::vector<double> um = {0.5, 0.6}, radii = {0.3, 0.4},
                              angles = support::even_angles(0.5);
    const std::size_t n = angles.size();
    // Two spheres as if they were averages; descending angles, as MOPSMAP writes them.
    std::vector<double> ext, ssa, theta, phase, count;
    for (const double wavelength : um) {
        for (const double r : radii) {
            const auto one =
                support::database_sphere(kGrain, grain_parameter(r, 1e3 * wavelength), angles);
            ext.push_back(one.sphere.q_ext * 0.75e3 / (2.6 * r));  // m2/kg
            ssa.push_back(one.sphere.q_sca / one.sphere.q_ext);
            for (const int element : {0, 1, 2, 3, 4, 5}) {
                count.push_back(double(n));
                for (std::size_t a = n; a-- > 0;) {
                    const rte::ScatteringMatrix& m = one.matrix[a];
                    theta.push_back(angles[a]);
                    phase.push_back(std::array{m.a1, m.b1, m.a3, -m.b2, m.a2, m.a4}[element]);
                }
            }
        }
    }
    const std::map<std::string, std::size_t> sizes = {
        {"nlam", 2}, {"nreff", 2}, {"nphamat", 6}, {"nthetamax", n}};
    const std::vector<std::string> entries = {"nlam", "nreff"},
                                   lists = {"nlam", "nreff", "nphamat", "nthetamax"};
    std::vector<Variable> variables = {
        {"wavelen", {"nlam"}, um},      {"reff", {"nreff"}, radii},
        {"rho", {"nreff"}, {2.6, 2.6}}, {"ext", entries, ext},
        {"ssa", entries, ssa},          {"theta", lists, theta},
        {"phase", lists, phase},        {"ntheta", {"nlam", "nreff", "nphamat"}, count}};
    const std::string file = write_netcdf(folder / "mie.cdf", sizes, variables);
    for (const double nm : {500.0, 600.0}) {
        for (const double r : radii)
            check_sphere(fmt::format("scattering:{},radius={}", file, r), r, nm);
    }
    CHECK_THROWS_WITH(optics_at("scattering:" + file, 500), Catch::Contains("say which"));
    CHECK_THROWS_WITH(optics_at("scattering:" + file + ",radius=0.3,variance=0.1", 500),
                      Catch::Contains("averages over sizes"));
    CHECK_THROWS_WITH(optics_at("scattering:" + file + ",radius=0.5", 500),
                      Catch::Contains("0.3 to 0.4 um"));
    CHECK_THROWS_WITH(optics_at("scattering:" + file + ",radius=0.3,number=1/cm3", 500),
                      Catch::Contains("volume="));
    // Amounts by volume are those of the spheres.
    const auto layer = [](const std::string& words) {
        return solve(support::scene_of(words), {500.0}, {.tolerance = 1e-3}).layers().at(0);
    };
    CHECK(*layer("scattering:" + file + ",radius=0.3,volume=1%").scattering_per_um ==
          Approx(*layer("index:1.45,1e-3,radius=0.3,distribution=mono,volume=1%").scattering_per_um)
              .epsilon(1e-3));

    // A matrix that no particle can have: P22 above P11.
    variables[6].values[4 * n + 40] *= 1.5;
    const std::string wrong = write_netcdf(folder / "wrong.cdf", sizes, variables);
    CHECK_THROWS_WITH(medium("scattering:" + wrong),
                      Catch::Contains("160 degrees") && Catch::Contains("eigenvalue"));
}

TEST_CASE("MOPSMAP's data set is averaged over sizes of one's own, at any wavelength",
          "[pipeline][scattering][netcdf]") {
    if (!has_netcdf()) {
        WARN("skipped: this build has no NetCDF");
        return;
    }
    const support::TemporaryFolder folder;
    // The T-matrix programs' functions of b1 and b2 have the other sign. `rat` of this file says
    // that the particles' spheres of the same area are larger than those of 3 V / (4 A).
    constexpr double kRat = 0.9;
    std::vector<double> x, last, qext, qsca;
    std::map<std::string, std::vector<double>> lists;
    for (int i = 0; i <= 90; ++i) {
        x.push_back(0.2 * std::pow(200.0, i / 90.0));
        mie::EnsembleRequest one;
        one.sizes.kind = mie::SizeDistributionKind::mono;
        one.sizes.effective_radius_um = x.back() / (2 * std::numbers::pi);
        one.wavelength_nm = 1000;
        one.refractive_index = kGrain;
        const mie::MatrixOptics m = mie::average_matrix(one);
        qext.push_back(m.optics.q_ext);
        qsca.push_back(m.optics.q_sca);
        last.push_back(double(m.optics.chi.size()) - 1);
        for (std::size_t l = 0; l < m.optics.chi.size(); ++l)
            lists["a1"].push_back((2.0 * double(l) + 1.0) * m.optics.chi[l]);
        for (const auto& [name, list] : kMatrixLists) {
            const double sign = name[0] == 'b' ? -1.0 : 1.0;
            for (const double value : m.expansion.*list) lists[name].push_back(sign * value);
        }
        x.back() /= std::pow(kRat, 3);
    }
    const std::map<std::string, std::size_t> sizes = {{"sizepara", x.size()},
                                                      {"index_coeff", lists["a1"].size()}};
    std::vector<Variable> variables = {{"sizepara", {"sizepara"}, x},
                                       {"lmax", {"sizepara"}, last},
                                       {"qext", {"sizepara"}, qext},
                                       {"qsca", {"sizepara"}, qsca},
                                       {"rat", {}, {kRat}}};
    for (const auto& [name, values] : lists) variables.push_back({name, {"index_coeff"}, values});
    const std::string file = write_netcdf(folder / "spheroid.nc", sizes, variables);
    for (const double nm : {450.0, 650.0}) {
        mie::EnsembleRequest request;
        request.sizes = {mie::SizeDistributionKind::log_normal, 0.4, 0.2};
        request.refractive_index = kGrain;
        request.wavelength_nm = nm;
        const mie::MatrixOptics truth = mie::average_matrix(request);
        const MediumOptics read = optics_at(
            "scattering:" + file + ",radius=0.4,variance=0.2,distribution=log-normal", nm);
        CAPTURE(nm);
        // 90 sizes, linear between them.
        CHECK(*read.q_ext == Approx(truth.optics.q_ext).epsilon(5e-3));
        CHECK(read.optics.single_scattering_albedo ==
              Approx(truth.optics.single_scattering_albedo).epsilon(3e-4));
        REQUIRE(read.optics.polarisation);
        for (std::size_t l = 2; l <= 8; ++l) {
            CAPTURE(l);
            CHECK(std::abs(read.optics.chi[l] - truth.optics.chi[l]) <= 3e-3);
            CHECK(std::abs(read.optics.polarisation->b1[l] - truth.expansion.b1[l]) <= 0.02);
            CHECK(std::abs(read.optics.polarisation->b2[l] - truth.expansion.b2[l]) <= 0.02);
        }
    }
    CHECK_THROWS_WITH(optics_at("scattering:" + file, 500), Catch::Contains("size parameters"));
    CHECK_THROWS_WITH(optics_at("scattering:" + file + ",radius=50", 500),
                      Catch::Contains("reach"));
    // A number of particles counts the area of each: spheres have kRat^6 of this one.
    const auto scattered = [](const std::string& words) {
        return *solve(support::scene_of(words), {550.0}, {.tolerance = 1e-3})
                    .layers()
                    .at(0)
                    .scattering_per_um;
    };
    const std::string law = ",radius=0.4,variance=0.2,distribution=log-normal,number=1e9/cm3";
    CHECK(scattered("scattering:" + file + law) * std::pow(kRat, 6) ==
          Approx(scattered("index:1.45,1e-3" + law)).epsilon(5e-3));
}

TEST_CASE("bulk scattering by ice habits and aerosol tables are read by effective radius",
          "[pipeline][scattering][netcdf]") {
    if (!has_netcdf()) {
        WARN("skipped: this build has no NetCDF");
        return;
    }
    const support::TemporaryFolder folder;
    const std::vector<double> um = {0.5, 0.6}, radii = {0.3, 0.4},
                              angles = support::even_angles(0.5);
    const auto sphere = [&](double r, double wavelength) {
        return support::database_sphere(kGrain, grain_parameter(r, 1e3 * wavelength), angles);
    };
    // Angles slowest, wavelengths fastest, elements over P11.
    std::map<std::string, std::vector<double>> ice;
    for (std::size_t a = 0; a < angles.size(); ++a) {
        for (const double r : radii) {
            for (const double wavelength : um) {
                const rte::ScatteringMatrix m = sphere(r, wavelength).matrix[a];
                ice["p11"].push_back(m.a1);
                ice["p21"].push_back(m.b1 / m.a1);
                ice["p22"].push_back(m.a2 / m.a1);
                ice["p33"].push_back(m.a3 / m.a1);
                ice["p43"].push_back(-m.b2 / m.a1);
                ice["p44"].push_back(m.a4 / m.a1);
            }
        }
    }
    std::vector<double> qext, ssa;
    for (const double r : radii) {
        for (const double wavelength : um) {
            const auto one = sphere(r, wavelength).sphere;
            qext.push_back(one.q_ext);
            ssa.push_back(one.q_sca / one.q_ext);
        }
    }
    const std::map<std::string, std::size_t> sizes = {
        {"nScatAng", angles.size()}, {"nDeff", 2}, {"nWaveLen", 2}};
    std::vector<Variable> variables = {
        {"wavelengths", {"nWaveLen"}, um},
        {"effective_diameter", {"nDeff"}, {2 * radii[0], 2 * radii[1]}},
        {"phase_angles", {"nScatAng"}, angles},
        {"extinction_efficiency", {"nDeff", "nWaveLen"}, qext},
        {"single_scattering_albedo", {"nDeff", "nWaveLen"}, ssa}};
    for (const auto& [name, values] : ice)
        variables.push_back({name + "_phase_function", {"nScatAng", "nDeff", "nWaveLen"}, values});
    const std::string habits = write_netcdf(folder / "ice.nc", sizes, variables);
    check_sphere("scattering:" + habits + ",radius=0.4", 0.4, 600);
    check_sphere("scattering:" + habits + ",radius=300nm", 0.3, 500);

    // Metres; one humidity, or it is asked which.
    for (const std::size_t humidities : {1u, 2u}) {
        std::map<std::string, std::vector<double>> dust;
        for (const double r : radii) {
            for (std::size_t h = 0; h < humidities; ++h) dust["rEff"].push_back(1e-6 * r);
            for (const double wavelength : um) {
                const auto one = sphere(r, wavelength);
                for (std::size_t h = 0; h < humidities; ++h) {
                    dust["qext"].push_back(one.sphere.q_ext);
                    dust["ssa"].push_back(one.sphere.q_sca / one.sphere.q_ext);
                    for (const rte::ScatteringMatrix& m : one.matrix) {
                        dust["p11"].push_back(m.a1);
                        dust["p12"].push_back(m.b1);
                        dust["p22"].push_back(m.a2);
                        dust["p33"].push_back(m.a3);
                        dust["p34"].push_back(m.b2);
                        dust["p44"].push_back(m.a4);
                    }
                }
            }
        }
        std::vector<Variable> table = {{"wavelength", {"wavelength"}, {5e-7, 6e-7}},
                                       {"ang", {"ang"}, angles}};
        for (const auto& [name, values] : dust) {
            std::vector<std::string> over = {"bin", "wavelength", "rh"};
            if (name == "rEff") over = {"bin", "rh"};
            if (name[0] == 'p') over.push_back("ang");
            table.push_back({name, over, values});
        }
        const std::string file = write_netcdf(
            folder / fmt::format("dust{}.nc4", humidities),
            {{"bin", 2}, {"wavelength", 2}, {"rh", humidities}, {"ang", angles.size()}}, table);
        if (humidities == 1) {
            check_sphere("scattering:" + file + ",radius=0.3", 0.3, 600);
        } else {
            CHECK_THROWS_WITH(medium("scattering:" + file), Catch::Contains("ncks -d rh,0"));
        }
    }
}

TEST_CASE("NetCDF files of other kinds are refused with the kinds that are known",
          "[pipeline][scattering][netcdf][errors]") {
    if (!has_netcdf()) {
        WARN("skipped: this build has no NetCDF");
        return;
    }
    const support::TemporaryFolder folder;
    const std::string file =
        write_netcdf(folder / "other.nc", {{"time", 2}}, {{"temperature", {"time"}, {1, 2}}});
    CHECK_THROWS_WITH(medium("scattering:" + file),
                      Catch::Contains("no known kind") && Catch::Contains("libRadtran"));
    CHECK_THROWS_WITH(medium("scattering:" + folder.write("cut.nc", "\x89HDF\r\n\x1a\n cut")),
                      Catch::Contains("cannot read"));
}
