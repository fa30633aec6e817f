// Fit files are read, or refused before anything is solved.
#include <miebrdf/error.h>
#include <miebrdf/fit.h>

#include <cmath>

#include "tests/support/catch.h"
#include "tests/support/temporary_folder.h"

using namespace miebrdf;
using Catch::Contains;

namespace {

constexpr char kGood[] = R"(
[scene]
base = "H2O_ice,radius={radius}"
[unknowns]
radius = "100 in 20:1000 log"
[[measured]]
file = "snow.csv"
quantity = "plane_albedo"
mu_in = 0.5
sigma = 0.01
)";

std::string replaced(std::string text, const std::string& what, const std::string& with) {
    const std::size_t at = text.find(what);
    REQUIRE(at != std::string::npos);
    return text.replace(at, what.size(), with);
}

}  // namespace

TEST_CASE("an unknown has a start, bounds, and perhaps a logarithm", "[fit]") {
    const Unknown radius = unknown("radius", "100 in 20:1000 log");
    CHECK(radius.start == 100);
    CHECK(radius.low == 20);
    CHECK(radius.high == 1000);
    CHECK(radius.scale == Unknown::Scale::logarithm);
    CHECK_FALSE(radius.per_wavelength);
    const Unknown k = unknown("k", "per wavelength, 0.99 in 0:0.999 log1m");
    CHECK(k.per_wavelength);
    CHECK(k.scale == Unknown::Scale::log_of_one_minus);
    CHECK_THROWS_WITH(unknown("r", "100"), Contains("START in LOW:HIGH"));
    CHECK_THROWS_WITH(unknown("r", "5 in 20:1000"), Contains("outside its bounds 20:1000"));
    CHECK_THROWS_WITH(unknown("r", "5 in 0:10 log"), Contains("no logarithm"));
    CHECK_THROWS_WITH(unknown("r", "0.5 in 0:1 log1m"), Contains("below 1"));
    CHECK_THROWS_WITH(unknown("r", "5 in 10:1"), Contains("the lower one first"));
}

TEST_CASE("of a spectrum and Lab of one patch a fit takes what its quantity says", "[fit]") {
    const support::TemporaryFolder folder;
    folder.write("patch.csv",
                 "quantity,geometry,wavelength_nm,mu_in,mu_out,azimuth_deg,value,sigma\n"
                 "reflectance,,400,,,,0.1,\nreflectance,,500,,,,0.2,\nlab_l,,,,,,50,\n"
                 "lab_a,,,,,,1,\nlab_b,,,,,,2,\n");
    const auto read = [&](const std::string& quantity) {
        return read_fit_text(replaced(replaced(kGood, "snow.csv", "patch.csv"),
                                      "quantity = \"plane_albedo\"", quantity),
                             folder.path().string(), "fit.toml");
    };
    CHECK_THROWS_WITH(read(""), Contains("spectra and Lab") && Contains("quantity"));
    CHECK(read("quantity = \"plane_albedo\"").data[0].values.size() == 2);
    CHECK(read("quantity = \"lab\"").data[0].values.size() == 3);
}

TEST_CASE("a fit file names scene, unknowns and measured values", "[fit]") {
    const support::TemporaryFolder folder;
    folder.write("snow.csv", "wavelength_nm,albedo\n900,0.8\n1000,0.7\n1100,\n1200,0.5\n");
    const FitProblem problem = read_fit_file(folder.write("fit.toml", kGood));
    REQUIRE(problem.data.size() == 1);
    const FitData& data = problem.data[0];
    CHECK(data.name == "snow.csv");
    REQUIRE(data.values.size() == 3);  // the empty field is a gap
    CHECK(data.values[2].wavelength_nm == 1200);
    CHECK(data.values[2].sigma == 0.01);
    CHECK(data.values[2].mu_in == 0.5);
    const FitProblem narrow =
        read_fit_text(replaced(kGood, "mu_in = 0.5", "theta_in = 60\nwavelengths = \"950:1050\""),
                      folder.path().string(), "narrow");
    REQUIRE(narrow.data[0].values.size() == 1);
    const FitProblem apart =
        read_fit_text(replaced(kGood, "mu_in = 0.5",
                               "mu_in = 0.5\nwavelengths = \"850:950, 1150:1250\"\nname = \"A\""
                               "\ncolumn = \"albedo\""),
                      folder.path().string(), "apart");
    REQUIRE(apart.data[0].values.size() == 2);
    CHECK(apart.data[0].values[1].wavelength_nm == 1200);
    CHECK(apart.data[0].name == "A");
    CHECK(std::abs(narrow.data[0].values[0].mu_in - 0.5) <= 1e-15);
}

TEST_CASE("files in words of a fit file lie beside it", "[fit]") {
    const support::TemporaryFolder folder;
    folder.write("grey.csv",
                 "wavelength_nm,single_scattering_albedo,g\n400,0.9,0.5\n700,0.9,0.5\n");
    folder.write("ground.csv", "wavelength_nm,albedo\n400,0.2\n700,0.2\n");
    const FitProblem problem = read_fit_file(folder.write("fit.toml", R"([scene]
coat = ["hg:grey.csv@{tau}", "isotropic:0.5 in index:1.5@1"]
substrate = "lambert:ground.csv"
[unknowns]
tau = "1 in 0.1:10"
[[measured]]
values = [0.3, 0.3]
wavelength_nm = [500, 600]
quantity = "spherical_albedo"
)"));
    REQUIRE(problem.scene.size() == 2);
    for (const SceneText& word : problem.scene) {
        const bool is_coat = word.word == "coat";
        CHECK(word.values[0] == (is_coat ? "hg:" + (folder / "grey.csv") + "@{tau}"
                                         : "lambert:" + (folder / "ground.csv")));
    }
}

TEST_CASE("what is wrong with a fit file is said with its place and what would help",
          "[fit][errors]") {
    const support::TemporaryFolder folder;
    folder.write("snow.csv", "wavelength_nm,albedo\n900,0.8\n1000,0.7\n");
    folder.write("percent.csv", "wavelength_nm,albedo\n900,80\n1000,70\n");
    folder.write("twice.csv", "wavelength_nm,albedo\n900,0.8\n900,0.7\n");
    folder.write("white.csv", "wavelength_nm,albedo\n900,1.2\n1000,0.7\n");
    struct Case {
        std::string what, with, reason;
    };
    const Case cases[] = {
        {"radius = \"100", "radios = \"100", "[unknowns] has no 'radius'"},
        {"[unknowns]", "[unknowns]\nsoot = \"1 in 0:2\"", "stands in no word of a scene"},
        {"base = ", "bass = ", "did you mean base"},
        {"\"plane_albedo\"", "\"plain_albedo\"", "plain_albedo"},
        {"100 in 20:1000", "10 in 20:1000", "outside its bounds"},
        {"mu_in = 0.5", "", "where did the light come from"},
        {"mu_in = 0.5", "mu_in = 0.5\ntheta_in = 60", "say the same"},
        {"mu_in = 0.5", "theta_in = 90", "theta_in 90; allowed"},
        {"mu_in = 0.5", "mu_in = 1.7", "mu_in 1.7; allowed"},
        {"sigma = 0.01", "sigma = 0.01\n[fit]\niterations = 2.5", "2.5; allowed: a whole number"},
        {"sigma = 0.01", "sigma = 0.01\n[fit]\nstarts = -1", "1 to 1000"},
        {"mu_in = 0.5", "mu_in = 0.5\nwavelengths = \"1000:950\"", "FIRST:LAST"},
        {"mu_in = 0.5", "mu_in = 0.5\nwavelengths = \"900:1000,950:1100\"", "ascending"},
        {"sigma = 0.01", "sigma = \"1 %\"", "given: '1 %'"},
        {"sigma = 0.01", "scale = 2", "'scale' is \"free\""},
        {"snow.csv", "percent.csv", "percent"},
        {"snow.csv", "white.csv", "more light than came in"},
        {"snow.csv", "none.csv", "none.csv"},
        {"sigma = 0.01", "sigma = -1", "sigma"},
        {"sigma = 0.01", "wavelengths = \"2000:2100\"", "the data have 900 to 1000 nm"},
        {"plane_albedo", "d8-sci", "d8-sci and d8-sce are at 8 degrees"},
        {"plane_albedo", "hemispherical", "hemispherical from all sides"},
        {"plane_albedo", "45-0", "45-0 from 45 degrees"},
        {"100 in 20:1000 log\"", "100 in 20:1000 log\"\nb = 3", "stands in [scene] itself"},
    };
    for (const Case& c : cases) {
        CAPTURE(c.what, c.with);
        CHECK_THROWS_WITH(
            read_fit_text(replaced(kGood, c.what, c.with), folder.path().string(), "fit.toml"),
            Contains(c.reason) && Contains("fit.toml"));
    }
    // The place is that of the data set, or of the unknowns, that is wrong.
    const auto place_of = [&](const std::string& what, const std::string& with) {
        try {
            read_fit_text(replaced(kGood, what, with), folder.path().string(), "fit.toml");
        } catch (const Error& error) {
            const std::string text = error.what();
            return text.substr(0, text.find(", column"));
        }
        return std::string("accepted");
    };
    CHECK(place_of("snow.csv", "white.csv") == "fit file 'fit.toml', line 6");
    CHECK(place_of("mu_in = 0.5", "") == "fit file 'fit.toml', line 6");
    CHECK(place_of("mu_in = 0.5", "mu_in = 0.5\nscene = { substrate = \"lambert:1.4\" }") ==
          "fit file 'fit.toml', line 6");
    CHECK(place_of("[unknowns]", "[unknowns]\nsoot = \"1 in 0:2\"") ==
          "fit file 'fit.toml', line 4");
    CHECK_THROWS_WITH(
        read_fit_text(replaced(kGood, "snow.csv", "twice.csv"), folder.path().string(), "fit.toml"),
        Contains("twice"));
}
