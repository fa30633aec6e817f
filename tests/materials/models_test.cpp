// Materials by models: oscillators against closed forms, the Kramers-Kronig integral and published
// values; formulas; interpolation in temperature; names.
#include <miebrdf/database.h>

#include <algorithm>
#include <boost/math/quadrature/exp_sinh.hpp>
#include <boost/math/quadrature/tanh_sinh.hpp>
#include <cmath>
#include <complex>
#include <limits>
#include <numbers>
#include <vector>

#include "materials/index/oscillators.h"
#include "tests/support/catch.h"
#include "tests/support/temporary_folder.h"

using namespace miebrdf;
using namespace miebrdf::materials;

namespace {

using Complex = std::complex<double>;

Complex susceptibility(const char* kind, const std::vector<double>& parameters, double energy_ev) {
    return find_oscillator_kind(kind)->susceptibility(parameters, energy_ev);
}

// 2/pi P int_0^inf x eps_2(x) / (x^2 - E^2) dx. Because P int 1 / (x^2 - E^2) = 0, E eps_2(E) is
// taken off the numerator, which leaves nothing singular.
double kramers_kronig(const char* kind, const std::vector<double>& parameters, double E,
                      std::vector<double> kinks) {
    const auto absorption = [&](double x) {
        return x * susceptibility(kind, parameters, x).imag();
    };
    const double own = absorption(E);
    const auto integrand = [&](double x) {
        const double step = 1e-4 * E;
        if (std::abs(x - E) < 1e-7 * E)
            return (absorption(E + step) - absorption(E - step)) / (4.0 * step * E);
        return (absorption(x) - own) / ((x - E) * (x + E));
    };
    kinks.insert(kinks.end(), {1e-12, E});
    std::sort(kinks.begin(), kinks.end());
    boost::math::quadrature::tanh_sinh<double> finite(12);
    boost::math::quadrature::exp_sinh<double> infinite(12);
    double sum =
        infinite.integrate(integrand, kinks.back(), std::numeric_limits<double>::infinity(), 1e-9);
    for (std::size_t i = 0; i + 1 < kinks.size(); ++i) {
        if (kinks[i + 1] > kinks[i])
            sum += finite.integrate(integrand, kinks[i], kinks[i + 1], 1e-9);
    }
    return 2.0 / std::numbers::pi * sum;
}

// Jellison & Modine, Appl. Phys. Lett. 69, 371 and 2137 (1996): eps_1 as they print it.
double jellison_modine(double A, double E0, double C, double Eg, double E) {
    const double pi = std::numbers::pi;
    const double alpha = std::sqrt(4 * E0 * E0 - C * C), gamma2 = E0 * E0 - C * C / 2;
    const double zeta4 = std::pow(E * E - gamma2, 2) + alpha * alpha * C * C / 4;
    const double a_ln =
        (Eg * Eg - E0 * E0) * E * E + Eg * Eg * C * C - E0 * E0 * (E0 * E0 + 3 * Eg * Eg);
    const double a_atan = (E * E - E0 * E0) * (E0 * E0 + Eg * Eg) + Eg * Eg * C * C;
    const double sum = E0 * E0 + Eg * Eg;
    return A * C * a_ln / (pi * zeta4 * 2 * alpha * E0) *
               std::log((sum + alpha * Eg) / (sum - alpha * Eg)) -
           A * a_atan / (pi * zeta4 * E0) *
               (pi - std::atan((2 * Eg + alpha) / C) + std::atan((alpha - 2 * Eg) / C)) +
           2 * A * E0 / (pi * zeta4 * alpha) * Eg * (E * E - gamma2) *
               (pi + 2 * std::atan(2 * (gamma2 - Eg * Eg) / (alpha * C))) -
           A * E0 * C / (pi * zeta4) * (E * E + Eg * Eg) / E *
               std::log(std::abs(E - Eg) / (E + Eg)) +
           2 * A * E0 * C / (pi * zeta4) * Eg *
               std::log(std::abs(E - Eg) * (E + Eg) /
                        std::sqrt(std::pow(E0 * E0 - Eg * Eg, 2) + Eg * Eg * C * C));
}

const std::vector<double> kAmorphous = {122.0, 3.45, 2.54, 1.2};

}  // namespace

TEST_CASE("Drude and Lorentz have the closed forms of their conductivity and static limit",
          "[materials][models]") {
    const double E = GENERATE(0.01, 0.5, 2.5, 9.0, 30.0);
    const double EP = 9.0, G = 0.07;
    const Complex drude = susceptibility("drude", {EP, G}, E);
    CHECK(drude.real() == Approx(-EP * EP / (E * E + G * G)).epsilon(1e-13));
    CHECK(drude.imag() == Approx(EP * EP * G / (E * (E * E + G * G))).epsilon(1e-13));
    // At resonance i S E0 / G; far below it the strength.
    CHECK(std::abs(susceptibility("lorentz", {1.5, E, G}, E) - Complex(0, 1.5 * E / G)) <=
          1e-12 * E / G);
    CHECK(susceptibility("lorentz", {1.5, E, G}, 1e-6 * E).real() == Approx(1.5).epsilon(1e-9));
    CHECK(susceptibility("lorentz", {1.5, E, 0.3 * E}, 0.8 * E).real() ==
          Approx(kramers_kronig("lorentz", {1.5, E, 0.3 * E}, 0.8 * E, {E})).epsilon(1e-7));
}

TEST_CASE("Tauc-Lorentz is the form that its authors print", "[materials][models]") {
    const double E = GENERATE(0.3, 1.19, 1.21, 1.8, 2.5, 3.45, 5.0, 20.0);
    const int set = GENERATE(0, 1, 2);
    const std::vector<double> parameters = std::vector<std::vector<double>>{
        kAmorphous,
        {40.0, 4.8, 1.9, 2.4},
        {10.0, 2.0, 3.9, 2.3}}.at(std::size_t(set));
    CAPTURE(E, parameters);
    const double expected =
        jellison_modine(parameters[0], parameters[1], parameters[2], parameters[3], E);
    // The printed sum cancels to a few digits far above the resonance.
    CHECK(susceptibility("tauc-lorentz", parameters, E).real() ==
          Approx(expected).epsilon(1e-9).margin(1e-9));
    if (E <= parameters[3]) CHECK(susceptibility("tauc-lorentz", parameters, E).imag() == 0.0);
}

TEST_CASE("Tauc-Lorentz and Cody-Lorentz obey Kramers-Kronig, broad and at their kinks too",
          "[materials][models]") {
    const double E = GENERATE(0.4, 1.2, 1.6, 1.8, 2.7, 3.45, 8.0, 60.0);
    CAPTURE(E);
    // 6.9 = 2 E0: zeros of the Lorentz shape meet; 9: they lie on the imaginary axis.
    for (const double C : {0.3, 2.54, 6.9, 6.9 * (1 + 1.1e-5), 9.0}) {
        CAPTURE(C);
        const std::vector<double> tauc = {122.0, 3.45, C, 1.2};
        CHECK(susceptibility("tauc-lorentz", tauc, E).real() ==
              Approx(kramers_kronig("tauc-lorentz", tauc, E, {1.2, 3.45}))
                  .epsilon(1e-6)
                  .margin(1e-6));
        std::vector<double> cody = {70.0, 3.45, C, 1.6, 1.1};
        CHECK(susceptibility("cody-lorentz", cody, E).real() ==
              Approx(kramers_kronig("cody-lorentz", cody, E, {1.6, 3.45}))
                  .epsilon(1e-6)
                  .margin(1e-6));
        cody.insert(cody.end(), {1.8, 0.05});
        CHECK(susceptibility("cody-lorentz", cody, E).real() ==
              Approx(kramers_kronig("cody-lorentz", cody, E, {1.6, 1.8, 3.45}))
                  .epsilon(1e-6)
                  .margin(1e-6));
    }
}

TEST_CASE("the Urbach tail is continuous and falls by e over its slope", "[materials][models]") {
    const std::vector<double> cody = {70.0, 3.8, 2.4, 1.6, 1.1, 1.8, 0.05};
    const auto absorption = [&](double E) {
        return E * susceptibility("cody-lorentz", cody, E).imag();
    };
    CHECK(absorption(1.8 * (1 - 1e-12)) == Approx(absorption(1.8 * (1 + 1e-12))).epsilon(1e-9));
    CHECK(absorption(1.5) / absorption(1.45) == Approx(std::exp(1.0)).epsilon(1e-12));
    // Without tail and with a wide transition it is a Tauc-Lorentz of (E - EG)^2 E^-2 no more.
    CHECK(susceptibility("cody-lorentz", {70.0, 3.8, 2.4, 1.6, 1.1}, 1.59).imag() == 0.0);
}

TEST_CASE("gold of Rakic et al. has the values of its published table", "[materials][models]") {
    // Parameters: A. D. Rakic et al., Appl. Opt. 37, 5271 (1998), table 1 (Lorentz-Drude): plasma
    // energy 9.03 eV, strengths f, so that EP = sqrt(f0) 9.03 and S = f 9.03^2 / E0^2. Values:
    // refractiveindex.info, main/Au/Rakic-LD, 5 digits.
    const RefractiveIndex gold = Database::embedded().refractive_index(
        "oscillators(1, drude(7.872171492,0.053), lorentz(11.36293569,0.415,0.241),"
        "lorentz(1.183639135,0.83,0.345), lorentz(0.6567702228,2.969,0.87),"
        "lorentz(2.645485877,4.304,2.494), lorentz(2.014826232,13.32,2.214))");
    const double table[][3] = {{247.97, 1.0941, 1.5478},
                               {402.85, 1.4112, 1.7490},
                               {505.23, 0.74535, 1.9410},
                               {1012.9, 0.25970, 6.0788},
                               {6199.2, 5.0974, 38.118}};
    for (const auto& [wavelength_nm, n, k] : table) {
        CAPTURE(wavelength_nm);
        CHECK(gold.at(wavelength_nm).real() == Approx(n).epsilon(1e-4));
        CHECK(gold.at(wavelength_nm).imag() == Approx(k).epsilon(1e-4));
    }
}

TEST_CASE("a model is a material like any other", "[materials][models][names]") {
    const Database database = Database::embedded();
    const std::string name = "drude(1,9,0.07)";
    const RefractiveIndex metal = database.refractive_index(name);
    const double energy_ev = 1239.841984 / 550.0;
    const Complex expected = std::sqrt(1.0 + susceptibility("drude", {9.0, 0.07}, energy_ev));
    CHECK(std::abs(metal.at(550) - expected) <= 1e-14);
    CHECK(metal.k_known());
    CHECK(database.info(name).name == name);
    CHECK_THAT(database.info(name).title, Catch::Contains("drude(9,0.07)"));
    CHECK_THAT(database.info(name).reference, Catch::Contains("Drude"));
    CHECK(database.dataset_info(name + "/model").rows > 500);
    CHECK(database.refractive_index("oscillators(1,drude(9,0.07))").at(550) == metal.at(550));
    // Its table is fine enough to be interpolated in.
    const Dataset dataset = database.dataset("tauc-lorentz(1.15,122,3.45,2.54,1.2)");
    const RefractiveIndex table("sampled", dataset.n, dataset.k);
    const RefractiveIndex exact = database.refractive_index("tauc-lorentz(1.15,122,3.45,2.54,1.2)");
    for (const double w : {223.7, 351.3, 412.9, 777.7, 1033.1, 5021.0})
        CHECK(std::abs(table.at(w) - exact.at(w)) <= 1e-4);
    // Inside of mixtures, and over a range of its own.
    const auto garnett = database.refractive_index("maxwell-garnett(drude(1,9,0.07):1%,SiO2)");
    CHECK(garnett.at(550).imag() > 0.0);
    CHECK_THROWS_WITH(database.refractive_index("drude(1,9,0.07,range=400:700)").at(800),
                      Catch::Contains("400 to 700 nm"));
}

TEST_CASE("models that cannot be are refused with the reason", "[materials][models][errors]") {
    const Database database = Database::embedded();
    const auto refused = [&](const std::string& name) {
        return [&database, name] { database.refractive_index(name).at(550); };
    };
    CHECK_THROWS_WITH(refused("drude(1,9)")(), Catch::Contains("drude(EPS_INF,EP,G)"));
    CHECK_THROWS_WITH(refused("drude(1,-9,0.1)")(), Catch::Contains("EP of drude"));
    CHECK_THROWS_WITH(refused("lorentz(1,2,x,0.1)")(), Catch::Contains("'x'"));
    CHECK_THROWS_WITH(refused("cody-lorentz(1,70,3.8,2.4,1.6,1.1,1.8)")(),
                      Catch::Contains("[,ET,EU]"));
    CHECK_THROWS_WITH(refused("oscillators(1,gauss(1,2))")(), Catch::Contains("tauc-lorentz("));
    CHECK_THROWS_WITH(refused("oscillators(drude(9,0.1))")(), Catch::Contains("EPS_INF"));
    CHECK_THROWS_WITH(refused("drude(nan,9,0.1)")(), Catch::Contains("nan"));
    // Without damping nothing gets in below the plasma energy: n = 0.
    CHECK_THROWS_WITH(refused("drude(1,9,0)")(), Catch::Contains("n > 0"));
    CHECK_THROWS_WITH(refused("lorentz(1,2,3,0.1,range=700:400)")(), Catch::Contains("FROM:TO"));
}

#ifdef MIEBRDF_HAS_MUPARSER
TEST_CASE("formulas are expressions of the wavelength or the energy", "[materials][models]") {
    const Database database = Database::embedded();
    const auto at = [&](const std::string& name, double wavelength_nm) {
        return database.refractive_index(name).at(wavelength_nm);
    };
    CHECK(at("formula(n=1.5+0.0042/um^2,k=1e-3*exp(-nm/500))", 550) ==
          Complex(1.5 + 0.0042 / (0.55 * 0.55), 1e-3 * std::exp(-1.1)));
    CHECK(at("formula(n = max(1.2, 2-0.1*eV))", 550).real() ==
          Approx(2 - 0.1 * 1239.841984 / 550).epsilon(1e-14));
    CHECK_FALSE(database.refractive_index("formula(n=1.5)").k_known());
    const Complex drude =
        at("formula(eps1=1-81/(eV^2+0.0049),eps2=81*0.07/(eV*(eV^2+0.0049)))", 700);
    CHECK(std::abs(drude - at("drude(1,9,0.07)", 700)) <= 1e-13);
    // Negative permittivities without absorption have k alone.
    CHECK_THROWS_WITH(at("formula(eps1=-2)", 550), Catch::Contains("n > 0"));
    CHECK_THROWS_WITH(at("formula(n=1.5,k=0-1)", 550), Catch::Contains("k >= 0"));
    CHECK_THROWS_WITH(at("formula(n=1/(nm-550))", 550), Catch::Contains("n > 0"));
    CHECK_THROWS_WITH(at("formula(n=1.5+lambda)", 550), Catch::Contains("lambda"));
    CHECK_THROWS_WITH(at("formula(n=1.5,eps2=1)", 550), Catch::Contains("n and perhaps k"));
    CHECK_THROWS_WITH(at("formula(k=1)", 550), Catch::Contains("n and perhaps k"));
}
#endif

TEST_CASE("between two temperatures n and k are linear in it", "[materials][models][temperature]") {
    const support::TemporaryFolder folder;
    const std::filesystem::path file = folder / "own.sqlite";
    std::vector<Dataset> datasets;
    const auto add = [&](const char* label, std::optional<double> kelvin, double n, double k) {
        Dataset& d = datasets.emplace_back();
        d.material = "warm";
        d.label = label;
        d.temperature_k = kelvin;
        d.n = make_table(Unit::nanometre, {400, 500, 600, 700}, {n, n, n, n});
        d.k = make_table(Unit::nanometre, {400, 500, 600, 700}, {k, k, k, k});
    };
    add("unknown", std::nullopt, 9.0, 9.0);
    add("hot", 400.0, 1.7, 0.3);
    add("cold", 300.0, 1.5, 0.1);
    add("hottest", 500.0, 2.5, 0.5);
    DatabaseWriter(file).add(datasets);
    const Database database = Database::open(file);
    const auto at = [&](const std::string& name) {
        return database.refractive_index(name).at(550);
    };
    CHECK(std::abs(at("temperature(warm,325K)") - Complex(1.55, 0.15)) <= 1e-14);
    CHECK(std::abs(at("temperature(warm, 450)") - Complex(2.1, 0.4)) <= 1e-14);
    CHECK(at("temperature(warm,400K)") == Complex(1.7, 0.3));
    CHECK(std::abs(at("temperature(warm,76.85degC)") - Complex(1.6, 0.2)) <= 1e-13);
    CHECK(database.info("temperature(warm,325K)").title ==
          "warm at 325 K: 0.75 warm/cold + 0.25 warm/hot");
    CHECK(database.dataset("temperature(warm,325K)").temperature_k == 325.0);
    CHECK_THROWS_WITH(at("temperature(warm,501K)"), Catch::Contains("500 K (warm/hottest)"));
    CHECK_THROWS_WITH(at("temperature(warm,cold)"), Catch::Contains("is not a temperature"));
    CHECK_THROWS_WITH(Database::embedded().refractive_index("temperature(TiO2,300K)"),
                      Catch::Contains("does not lie between"));
}

TEST_CASE("temperature joins one ray, one phase and known k",
          "[materials][models][temperature][errors]") {
    const support::TemporaryFolder folder;
    const std::filesystem::path file = folder / "own.sqlite";
    std::vector<Dataset> datasets;
    const auto add = [&](const char* material, const char* label, double kelvin, double n,
                         std::optional<double> k, const char* ray) {
        Dataset& d = datasets.emplace_back();
        d.material = material;
        d.label = label;
        d.temperature_k = kelvin;
        d.ray = ray;
        d.n = make_table(Unit::nanometre, {400, 500, 600, 700}, {n, n, n, n});
        if (k) d.k = make_table(Unit::nanometre, {400, 500, 600, 700}, {*k, *k, *k, *k});
    };
    add("Xo", "cold", 280, 1.5, 0.004, "");
    add("Xo", "warm", 320, 1.46, std::nullopt, "");
    add("Yx", "o280", 280, 2.0, 0.0, "o");
    add("Yx", "e280", 280, 2.4, 0.0, "e");
    add("Yx", "e320", 320, 2.4, 0.0, "e");
    add("Zz", "liquid-100K", 100, 1.3, 0.0, "");
    add("Zz", "gas", 120, 1.0004, 0.0, "");
    add("Zz", "standard", 130, 1.0004, 0.0, "");
    DatabaseWriter(file).add(datasets);
    const Database database = Database::open(file);
    const auto at = [&](const std::string& name) {
        return database.refractive_index(name).at(550);
    };
    CHECK_THROWS_WITH(at("temperature(Xo,300K)"), Catch::Contains("k is 0.004"));
    CHECK(at("temperature(Yx,300K)") == Complex(2.4, 0.0));  // o is known at 280 K alone
    CHECK(at("temperature(Yx,280K)") == Complex(2.0, 0.0));
    CHECK_THROWS_WITH(at("temperature(Zz,110K)"), Catch::Contains("within a factor"));
    CHECK(at("temperature(Zz,125K)") == Complex(1.0004, 0.0));
}

TEST_CASE("a model without a value somewhere is refused there alone", "[materials][models]") {
    const Database database = Database::embedded();
    // Below the plasma wavelength a metal without losses is a dielectric: eps = 1 - (9 eV / E)^2.
    const double energy = 1239.841984 / 100;
    const auto drude = database.refractive_index("drude(1,9,0)");
    CHECK(std::abs(drude.at(100).real() - std::sqrt(1 - 81 / (energy * energy))) <= 1e-12);
    CHECK_THROWS_WITH(drude.at(200),
                      Catch::Contains("at 200 nm") && Catch::Contains("range=FROM:TO"));
    CHECK(drude.table().n.size() > 100);
#ifdef MIEBRDF_HAS_MUPARSER
    const auto formula = database.refractive_index("formula(n=sqrt(1+1.1/(1-0.0178/um^2)))");
    CHECK(std::abs(formula.at(587).real() - 1.4782) <= 1e-2);
#endif
}
