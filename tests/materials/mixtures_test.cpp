// Mixtures as materials: the rules' equations and limits, names, and what is refused.
#include <miebrdf/database.h>

#include <complex>
#include <string>
#include <tuple>
#include <vector>

#include "materials/index/mixing_rules.h"
#include "tests/support/catch.h"
#include "tests/support/temporary_folder.h"

using namespace miebrdf;
using namespace miebrdf::materials;

namespace {

using Complex = std::complex<double>;

Complex mixed(const char* rule, const std::vector<MixturePart>& parts) {
    return find_mixing_rule(rule)->permittivity(parts);
}

}  // namespace

TEST_CASE("mixing rules satisfy their equations and meet in the dilute limit",
          "[materials][mixtures]") {
    const Complex a = GENERATE(Complex(7.6, 0.0), Complex(2.0, 3.0), Complex(-10.0, 1.2));
    const Complex b(1.77, 1e-3);
    const double f = GENERATE(0.0, 0.01, 0.3, 0.9, 1.0);
    CAPTURE(a, f);
    const std::vector<MixturePart> parts{{a, f}, {b, 1 - f}};

    const Complex eps = mixed("bruggeman", parts);
    const Complex rest = f * (a - eps) / (a + 2.0 * eps) + (1 - f) * (b - eps) / (b + 2.0 * eps);
    CHECK(std::abs(rest) <= 1e-12);
    CHECK(eps.imag() >= -1e-12);
    const Complex garnett = mixed("maxwell-garnett", parts);
    CHECK(std::abs((garnett - b) / (garnett + 2.0 * b) - f * (a - b) / (a + 2.0 * b)) <= 1e-12);
    const Complex root = std::pow(mixed("looyenga", parts), 1.0 / 3.0);
    CHECK(std::abs(root - f * std::pow(a, 1.0 / 3.0) - (1 - f) * std::pow(b, 1.0 / 3.0)) <= 1e-12);
    CHECK(std::abs(mixed("volume", parts) - (f * a + (1 - f) * b)) <= 1e-13);
    if (f == 0.0 || f == 1.0) {
        for (const MixingRule& rule : mixing_rules())
            CHECK(std::abs(rule.permittivity(parts) - (f == 0.0 ? b : a)) <= 1e-12 * std::abs(a));
    }
}

TEST_CASE("Bruggeman and Maxwell Garnett agree to first order in the fraction",
          "[materials][mixtures]") {
    const Complex a(4.0, 0.5), b(2.25, 0.0);
    const double f = 1e-5;
    const std::vector<MixturePart> parts{{a, f}, {b, 1 - f}};
    const Complex slope = 3.0 * b * (a - b) / (a + 2.0 * b);  // Clausius-Mossotti, dilute
    CHECK(std::abs((mixed("bruggeman", parts) - b) / f - slope) <= 1e-4);
    CHECK(std::abs((mixed("maxwell-garnett", parts) - b) / f - slope) <= 1e-4);
}

TEST_CASE("a mixture is a material like any other", "[materials][mixtures][names]") {
    const Database database = Database::embedded();
    // The powder of rutile: two ordinary axes and one extraordinary.
    const auto powder = database.refractive_index("average(rutile-o, rutile-e)");
    const auto o = database.refractive_index("TiO2_rutile_o").at(550);
    const auto e = database.refractive_index("TiO2_rutile_e").at(550);
    CHECK(std::abs(powder.at(550) - (2.0 * o + e) / 3.0) <= 1e-6);
    CHECK_FALSE(powder.k_known());

    const std::string name = "maxwell-garnett(Au:2%,SiO2)";
    const auto film = database.refractive_index(name);
    const Complex gold = database.refractive_index("Au").at(520);
    const Complex silica = database.refractive_index("SiO2").at(520);
    const std::vector<MixturePart> parts{{gold * gold, 0.02}, {silica * silica, 0.98}};
    CHECK(std::abs(film.at(520) - std::sqrt(mixed("maxwell-garnett", parts))) <= 1e-4);
    CHECK(database.info(name).name == name);
    CHECK(database.info(name).density_g_cm3 == Approx(0.02 * 19.3 + 0.98 * 2.20));
    CHECK_THAT(database.info(name).reference,
               Catch::Contains("Garnett") && Catch::Contains("AU.NK"));
    CHECK(database.dataset_info(name + "/mixture").material == name + "/mixture");
    CHECK_THAT(export_dataset(database.dataset(name), "csv").at(0).text,
               Catch::Contains("wavelength_nm,n,k"));
    // Inside of each other, and with keys of collections.
    const auto nested =
        database.refractive_index("volume(bruggeman(sopra:GAP:50%,SiO2),sopra:SIO2:1e-9)");
    const auto inner = database.refractive_index("bruggeman(GaP:50%,SiO2)");
    CHECK(std::abs(nested.at(550) - inner.at(550)) <= 1e-6);
}

TEST_CASE("mixtures that cannot be are refused with the reason", "[materials][mixtures][errors]") {
    const Database database = Database::embedded();
    const auto refused = [&](const char* name) {
        return [&database, name] { database.refractive_index(name); };
    };
    CHECK_THROWS_WITH(refused("bruggeman(TiO2:1.2,SiO2)")(),
                      Catch::Contains("1.2") && Catch::Contains("0 to 1"));
    CHECK_THROWS_WITH(refused("bruggeman(TiO2:0.5,SiO2:0.6)")(), Catch::Contains("add up to 1.1"));
    CHECK_THROWS_WITH(refused("looyenga(TiO2,SiO2)")(), Catch::Contains("write a fraction"));
    CHECK_THROWS_WITH(refused("bruggeman(TiO2:0.5)")(), Catch::Contains("two"));
    CHECK_THROWS_WITH(refused("bruggeman(TiO2:0.2,SiO2:0.3,Au)")(), Catch::Contains("two"));
    CHECK_THROWS_WITH(refused("volume(TiO2:nan,SiO2)")(), Catch::Contains("allowed"));
    CHECK_THROWS_WITH(refused("volume(,SiO2:0.5)")(), Catch::Contains("without a name"));
    CHECK_THROWS_AS(refused("volume(TiO3:0.5,SiO2)")(), UnknownMaterial);
    CHECK_THROWS_AS(refused("stir(TiO2:0.5,SiO2)")(), UnknownMaterial);
}

TEST_CASE("a mixture keeps the absorption of its parts", "[materials][mixtures]") {
    const Database database = Database::embedded();
    // Air, and rutile within its gap, are given by formulas that say nothing of k.
    for (const auto& [name, part, fraction, other] :
         std::vector<std::tuple<const char*, const char*, double, const char*>>{
             {"bruggeman(soot_diesel:50%,air)", "soot_diesel", 0.5, "air"},
             {"maxwell-garnett(Au:2%,air)", "Au", 0.02, "air"},
             {"bruggeman(Ag:50%,TiO2_rutile_o)", "Ag", 0.5, "TiO2_rutile_o"}}) {
        CAPTURE(name);
        const Complex a = database.refractive_index(part).at(550);
        const Complex b = database.refractive_index(other).at(550);
        const std::string rule = std::string(name).substr(0, std::string(name).find('('));
        const Complex m =
            std::sqrt(mixed(rule.c_str(), {{a * a, fraction}, {b * b, 1 - fraction}}));
        const RefractiveIndex index = database.refractive_index(name);
        CHECK(index.k_known());
        CHECK(m.imag() > 1e-3);
        CHECK(std::abs(index.at(550) - m) <= 2e-4 * std::abs(m));
    }
    CHECK_FALSE(database.refractive_index("bruggeman(TiO2_rutile_o:50%,air)").k_known());
    CHECK_THAT(database.dataset("bruggeman(soot_diesel:50%,air)").note,
               Catch::Contains("k of air/"));
}

TEST_CASE("a mixture of what absorbs with a table without k is refused",
          "[materials][mixtures][errors]") {
    const support::TemporaryFolder folder;
    Dataset d;
    d.material = "mystery";
    d.label = "n";
    d.n = make_table(Unit::nanometre, {400, 500, 600}, {1.5, 1.5, 1.5});
    DatabaseWriter(folder / "own.sqlite").add(std::vector<Dataset>{d});
    const Database database = Database::layered(folder / "own.sqlite");
    CHECK_THROWS_WITH(database.refractive_index("bruggeman(Au:10%,mystery)"),
                      Catch::Contains("k of mystery") && Catch::Contains("is unknown"));
    CHECK_FALSE(database.refractive_index("bruggeman(air:10%,mystery)").k_known());
}
