// Layouts of ISOFIT and CRTM: the order of values, and what they refuse. What readers see:
// open_table.py.
#include "pipeline/sweep/satellite.h"

#include <miebrdf/error.h>

#include "pipeline/sweep/sweep_file.h"
#include "tests/support/catch.h"
#include "tests/support/temporary_folder.h"

using namespace miebrdf;
using Catch::Contains;

namespace {

std::string surface_sweep(const std::string& top, const std::string& axes) {
    return top + "\n[scene]\nbase = \"hg:{w},{g}\"\n[axes]\n" + axes +
           "wavelength_nm = [500, 600]\n";
}

constexpr char kGrid[] =
    "w = [0.5, 0.9]\ng = [0, 0.3, 0.6]\ntheta_in_deg = [0, 30]\ntheta_out_deg = [0, 40, 60]\n"
    "azimuth_deg = 90\n";

struct Gathered : sweep::GatheredTable {
    using GatheredTable::GatheredTable;
    using GatheredTable::over;
    void finish() override {}
};

}  // namespace

TEST_CASE("gathered tables have their values over the axes in the order that is asked", "[sweep]") {
    const support::TemporaryFolder folder;
    const auto sweep = sweep::read_sweep_file(folder.write(
        "s.toml",
        surface_sweep("outputs = [\"hdrf\"]\ndiffuse_fraction = 0\nlayout = \"isofit\"", kGrid)));
    const auto layout = sweep::layout_of(sweep);
    Gathered table(sweep, layout);
    // Values that say where they are: scene, wavelength, incidence, reflection.
    std::vector<sweep::SceneResult> results(sweep.scenes());
    for (std::size_t scene = 0; scene < results.size(); ++scene) {
        for (int w = 0; w < 2; ++w)
            for (int i = 0; i < 2; ++i)
                for (int o = 0; o < 3; ++o)
                    results[scene].values.push_back(1000.0 * double(scene) + 100 * w + 10 * i + o);
    }
    table.add(0, {results.begin(), results.begin() + 2});
    table.add(2, {results.begin() + 2, results.end()});
    const sweep::Axis &w = *sweep.find_axis("w"), &g = *sweep.find_axis("g");
    const auto values =
        table.over({&sweep.wavelength, &g, &w, &sweep.reflection, &sweep.incidence});
    REQUIRE(values.size() == 72);
    std::size_t k = 0;
    for (int nm = 0; nm < 2; ++nm)
        for (int b = 0; b < 3; ++b)
            for (int a = 0; a < 2; ++a)
                for (int o = 0; o < 3; ++o)
                    for (int i = 0; i < 2; ++i)
                        CHECK(values[k++] == 1000 * (3 * a + b) + 100 * nm + 10 * i + o);
}

TEST_CASE("layouts of satellites say what they have no place for", "[sweep][errors]") {
    const support::TemporaryFolder folder;
    const auto refused = [&](const std::string& top, const std::string& axes, const char* why) {
        INFO(top << '\n' << axes);
        CHECK_THROWS_WITH(
            sweep::read_sweep_file(folder.write("bad.toml", surface_sweep(top, axes))),
            Contains(why));
    };
    const std::string isofit = "layout = \"isofit\"\noutputs = [\"plane_albedo\"]";
    refused("layout = \"isofit\"\noutputs = [\"brdf\"]", kGrid, "diffuse_fraction = 0");
    refused(isofit, "w = 0.5\ng = [0, 0.3]\nmu_in = [0.5, 1]\n", "theta_in_deg");
    refused(isofit, "w = 0.5\ng = [\"0\", \"0.3\"]\ntheta_in_deg = [0, 1]\n", "axis of numbers");
    refused(isofit, "w = 0.5\ng = [0.3, 0]\ntheta_in_deg = [0, 1]\n", "ascending");
    refused("layout = \"isofit\"\noutputs = [\"hdrf\"]\ndiffuse_fraction = 0",
            "w = 0.5\ng = 0\ntheta_in_deg = 0\ntheta_out_deg = 0\nazimuth_deg = [0, 90]\n",
            "one value of azimuth_deg");
    const std::string crtm = "layout = \"crtm-snow\"\noutputs = [\"plane_albedo\"]";
    refused("layout = \"crtm-snow\"\noutputs = [\"spherical_albedo\"]", "w = 0.5\ng = 0\n",
            "plane_albedo");
    refused(crtm, "w = 0.5\ng = 0\ntheta_in_deg = [0, 30, 60]\n", "4 values or more");
    refused("layout = \"crtm\"\noutputs = [\"plane_albedo\"]", "w = 0.5\ng = 0\n",
            "cf, eradiate, isofit, isofit-surface, crtm-snow");
}
