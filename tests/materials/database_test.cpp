#include <miebrdf/database.h>

#include <fmt/format.h>

#include <set>
#include <thread>

#include "materials/index/checksum.h"
#include "tests/support/catch.h"
#include "tests/support/temporary_folder.h"

using namespace miebrdf;
using namespace miebrdf::materials;

TEST_CASE("the embedded database holds the rows of the collections' own files",
          "[materials][embedded]") {
    const Database database = Database::embedded();
    const std::filesystem::path folder = MIEBRDF_MATERIALS_DATA;
    std::size_t files = 0;
    for (const char* collection :
         {"sopra", "rii", "snicar", "pigments", "minerals", "literature"}) {
        for (const auto& entry : std::filesystem::directory_iterator(folder / collection)) {
            const Dataset source = read_file(entry.path());
            CAPTURE(entry.path());
            bool found = false;
            for (const MaterialInfo& m : database.list()) {
                for (const DatasetInfo& d : database.datasets(m.name))
                    found = found || d.content_sha256 == content_sha256(source);
            }
            CHECK(found);
            ++files;
        }
    }
    CHECK(files == 114);
    CHECK(database.list().size() == 109);
    CHECK(database.integrity_problems().empty());
    // Rows of GAP.NK, and wavelengths where a table resampled at 5 nm was off by half.
    const RefractiveIndex gap = database.refractive_index("GaP");
    CHECK(gap.at(1239.841984 / 2.675).imag() == Approx(0.012).margin(0.03));
    CHECK(database.dataset("GaP").n->x.size() == 221);
    CHECK(database.dataset("GaP").n->unit == Unit::electronvolt);
    // Ice and haematite reach as far as their sources do.
    CHECK(database.info("H2O_ice").longest_nm >= 5000);
    CHECK(database.info("Fe2O3").shortest_nm == 210);
    // SNICAR's rows: 480 bands of 10 nm.
    for (const char* name : {"black_carbon", "dust_saharan", "dust_greenland", "dust_colorado",
                             "H2O_ice/SNICAR-Pic16"}) {
        CHECK(database.dataset(name).n->x.size() == 480);
        CHECK(database.refractive_index(name).at(4990).real() > 1.0);
    }
    CHECK(database.refractive_index("dust_saharan").at(505).imag() ==
          Approx(0.00464328234).epsilon(1e-9));
    CHECK(database.refractive_index("air").at(550).real() == Approx(1.00027784).margin(2e-8));
    // Formulas are kept as formulas.
    CHECK(database.dataset("CaCO3").n->formula == 2);
}

TEST_CASE("words of everyday language say what stands for them, by names that are there",
          "[materials][names]") {
    const Database database = Database::embedded();
    for (const char* text :
         {"snow", "chalk", "gypsum", "ochre", "sand", "basalt", "olivine", "regolith", "milk",
          "fat", "oil", "Intralipid", "Teflon", "PTFE", "mica", "iron", "carbon", "casein"}) {
        CAPTURE(text);
        const auto word = common_word(text);
        REQUIRE(word);
        CHECK(word->meaning.size() > 20);
        for (const std::string& name : word->materials) CHECK(database.info(name).name == name);
    }
    CHECK(!common_word("word"));
    CHECK(!common_word("TiO2"));
    // van Staveren et al. (1991) at 500 nm; Michalski et al. (2001) at 633 nm.
    CHECK(database.refractive_index("soybean_oil").at(500).real() ==
          Approx(1.451 + 1.154e4 / 25e4 - 1.132e9 / 625e8).epsilon(1e-12));
    CHECK(database.refractive_index("milk_fat").at(633) == std::complex<double>(1.460, 1e-5));
    // Dorschner et al. (1995), their row at 1 um.
    CHECK(database.refractive_index("olivine_amorphous").at(1000).imag() == Approx(0.068667));
}

TEST_CASE("materials are found by the names people write", "[materials][names]") {
    const Database database = Database::embedded();
    const std::pair<const char*, const char*> spellings[] = {
        {"GaP", "GaP"},
        {"gap", "GaP"},
        {"gallium phosphide", "GaP"},
        {"AlGaAs7", "AlGaAs_70"},
        {"algaas-70", "AlGaAs_70"},
        {"AlGaAs_70", "AlGaAs_70"},
        {"TiO2", "TiO2"},
        {"titanium dioxide", "TiO2"},
        {"Titania", "TiO2"},
        {"rutile", "TiO2"},
        {"silica", "SiO2"},
        {"water", "H2O"},
        {"ice", "H2O_ice"},
        {"SiON", "SiON_40"},
        {"Co", "Co"},
        {"gold", "Au"},
        {"BK7", "BK7"},
        {"n-bk7", "BK7"},
        {"TiO\xe2\x82\x82", "TiO2"},
    };
    for (const auto& [spelling, name] : spellings) {
        CAPTURE(spelling);
        CHECK(database.info(spelling).name == name);
    }
}

TEST_CASE("no alias of the embedded database is ambiguous", "[materials][names]") {
    const Database database = Database::embedded();
    for (const MaterialInfo& material : database.list()) {
        CHECK(database.resolve(material.name) == std::vector<std::string>{material.name});
        for (const std::string& alias : material.aliases) {
            CAPTURE(alias);
            CHECK(database.resolve(alias) == std::vector<std::string>{material.name});
            std::string upper = alias;
            for (char& c : upper)
                c = static_cast<char>(std::toupper(static_cast<unsigned char>(c)));
            CHECK(database.info(upper).name == material.name);
        }
    }
}

TEST_CASE("an unknown name is an error with the nearest ones", "[materials][names][errors]") {
    const Database database = Database::embedded();
    try {
        database.info("TiO3");
        FAIL("TiO3 was found");
    } catch (const UnknownMaterial& error) {
        CHECK(error.name == "TiO3");
        CHECK(
            std::set<std::string>(error.candidates.begin(), error.candidates.end()).count("TiO2") ==
            1);
        CHECK_THAT(error.what(), Catch::Contains("TiO3") && Catch::Contains("did you mean"));
    }
    CHECK_THROWS_AS(database.refractive_index("unobtainium"), UnknownMaterial);
    CHECK_THROWS_WITH(database.refractive_index("sellmeier(1,2)"),
                      Catch::Contains("bruggeman") && Catch::Contains("drude"));
    CHECK_THROWS_AS(database.info(""), UnknownMaterial);
    CHECK_THROWS_AS(database.dataset("GaP/nobody"), UnknownMaterial);
    CHECK_THROWS_WITH(database.dataset("GaP/nobody"), Catch::Contains("GaP/SOPRA-GAP"));
    CHECK_THROWS_AS(database.dataset("sopra:NOTHING"), UnknownMaterial);
}

TEST_CASE("one dataset is named by label or by its collection's key", "[materials][names]") {
    const Database database = Database::embedded();
    CHECK(database.dataset("gap/Sopra-Gap").material == "GaP");
    CHECK(database.dataset("sopra:GAP").material == "GaP");
    CHECK(database.info("sopra:GAP").name == "GaP");
    CHECK(database.info("GaP/SOPRA-GAP").default_dataset == "SOPRA-GAP");
    CHECK(
        database.dataset("https://refractiveindex.info/?shelf=main&book=H2O&page=Hale").material ==
        "H2O");
    CHECK(database.dataset("SOPRA:algaas7").material == "AlGaAs_70");
}

TEST_CASE("every material says where it comes from and what it covers", "[materials][embedded]") {
    const Database database = Database::embedded();
    for (const MaterialInfo& material : database.list()) {
        CAPTURE(material.name);
        CHECK_FALSE(material.title.empty());
        CHECK_FALSE(material.source.empty());
        CHECK_FALSE(material.reference.empty());
        // Kaolinite's spectrum is of the infrared, milk fat was measured at 466 and 633 nm alone.
        const bool is_narrow = material.name == "milk_fat";
        if (material.name != "kaolinite" && !is_narrow) CHECK(material.shortest_nm <= 450);
        if (!is_narrow) CHECK(material.longest_nm >= 700);
        CHECK(material.datasets >= 1);
        for (const DatasetInfo& d : database.datasets(material.name)) {
            CAPTURE(d.label);
            const bool is_said = d.note.find("good for: ") != std::string::npos ||
                                 d.note.find("not for colours") != std::string::npos;
            CHECK((is_said || d.material == "H2O_ice"));
        }
    }
    // "no k" in the index: nobody gave it. SOPRA's zeros are kept as given.
    CHECK_FALSE(database.info("BaTiO3").k_known);
    CHECK_FALSE(database.refractive_index("ZnO").k_known());
    CHECK(database.info("SiO2").k_known);
    CHECK_THAT(database.info("SiO2").note, Catch::Contains("k is exactly 0"));
    CHECK_THROWS_WITH(database.refractive_index("BaTiO3").at(360),
                      Catch::Contains("BaTiO3") && Catch::Contains("400 to 700 nm"));
    CHECK_THAT(database.dataset("GaP").licence, Catch::Contains("unclear"));
    CHECK(database.dataset("H2O").licence == "CC0-1.0");
}

TEST_CASE("densities are known with their source, or not at all", "[materials][density]") {
    const Database database = Database::embedded();
    CHECK(database.info("TiO2").density_g_cm3 == 4.23);
    CHECK(database.info("sopra:GAP").density_g_cm3 == 4.14);
    CHECK(database.dataset("gold").density_g_cm3 == 19.3);
    CHECK_FALSE(database.info("ITO").density_g_cm3.has_value());
    for (const MaterialInfo& material : database.list()) {
        CAPTURE(material.name);
        CHECK(material.density_g_cm3.has_value() == !material.density_source.empty());
    }
}

TEST_CASE("search finds words of name, alias, title and provenance", "[materials][search]") {
    const Database database = Database::embedded();
    const auto names = [&](const std::string& text) {
        std::vector<std::string> found;
        for (const auto& m : database.search(text)) found.push_back(m.name);
        return found;
    };
    CHECK(names("tio2").front() == "TiO2");
    CHECK(names("rutile ordinary").front() == "TiO2_rutile_o");
    CHECK(names("wolfram") == std::vector<std::string>{"W"});
    CHECK(names("djurisic") == std::vector<std::string>{"C_graphite"});  // without the accent
    CHECK(names("Al0.7Ga0.3As").front() == "AlGaAs_70");
    CHECK(database.info("TiO2_anatase").formula == "TiO2");
    CHECK(names("no such words").empty());
    CHECK(names("\"*('").empty());  // no character has a meaning of its own
    // 26 of the 109 do not reach from 360 to 840 nm.
    CHECK(database.search(SearchFilter{.text = "", .covers_from_nm = 360, .covers_to_nm = 840})
              .size() == 83);
    CHECK(database
              .search(SearchFilter{
                  .text = "rutile", .covers_from_nm = {}, .covers_to_nm = {}, .needs_k = true})
              .size() == 2);
}

TEST_CASE("search finds parts of words and names by formula after whole words",
          "[materials][search]") {
    const Database database = Database::embedded();
    const auto place = [&](const std::string& text, const std::string& name) {
        const auto found = database.search(text);
        const auto at =
            std::find_if(found.begin(), found.end(), [&](const auto& m) { return m.name == name; });
        return at == found.end() ? 1000 : static_cast<int>(at - found.begin());
    };
    for (const char* oxide : {"SiO2", "ZrO2", "HfO2", "SiO", "TiO2_rutile_o"}) {
        CAPTURE(oxide);
        CHECK(place("oxide", oxide) < 1000);
        CHECK(place("oxide", "ZnO") < place("oxide", oxide));  // "Zinc oxide": the whole word
    }
    CHECK(place("oxide", "CaCO3") == 1000);
    CHECK(place("oxide", "PMMA") == 1000);  // C5H8O2
    CHECK(place("oxide", "kaolinite") == 1000);
    CHECK(place("nitride", "SiON_40") > place("nitride", "Si3N4"));
    CHECK(place("fluoride", "ThF4") < 1000);
    CHECK(place("sulphide", "ZnS") < 1000);
    CHECK(place("carbide", "SiC") == 0);
    CHECK(place("silicon oxide", "SiO2") < 1000);  // a whole word and a part
    CHECK(place("io", "SiO2") == 1000);            // two letters are part of most names
}

TEST_CASE("what is missing is found, and says what there is instead", "[materials][search]") {
    const Database database = Database::embedded();
    for (const char* asked : {"goethite", "yellow iron oxide", "chromium oxide", "ultramarine"}) {
        CAPTURE(asked);
        const auto found = database.search(asked);
        REQUIRE_FALSE(found.empty());
        CHECK(found.front().datasets == 0);
        CHECK_THROWS_WITH(database.refractive_index(asked), Catch::Contains("no n and k"));
    }
    CHECK(database.search("kaolin").front().name == "kaolinite");
    CHECK(database.refractive_index("kaolinite/handbook").at(550).real() == Approx(1.564));
    CHECK(database.info("barium sulphate").name == "barite");
}

TEST_CASE("one database serves several threads", "[materials][threads]") {
    const Database database = Database::embedded();
    const double expected = database.refractive_index("GaP").at(550).real();
    std::vector<std::thread> threads;
    std::vector<int> right(4, 0);
    for (std::size_t t = 0; t < right.size(); ++t) {
        threads.emplace_back([&, t] {
            for (int i = 0; i < 50; ++i)
                right[t] += database.refractive_index("gap").at(550).real() == expected;
        });
    }
    for (auto& thread : threads) thread.join();
    for (const int count : right) CHECK(count == 50);
}
