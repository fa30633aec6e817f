// Each format: what is right, and what is refused with file, line and reason.
#include "materials/readers/file_format.h"

#include <fmt/format.h>

#include <cmath>

#include <miebrdf/database.h>
#include <miebrdf/index.h>
#include "materials/readers/text.h"
#include "tests/support/catch.h"
#include "tests/support/temporary_folder.h"

using namespace miebrdf;
using namespace miebrdf::materials;

namespace {

/// A text, or a pair of them, as a format reads it.
Dataset read(const char* format, const std::string& text, const std::string& file,
             const std::string& second_text = "") {
    return format_named(format).read({file, text, second_text}, {});
}

Dataset sample(const std::string& name) {
    return read_file(MIEBRDF_MATERIALS_TEST_SAMPLES "/" + name);
}

using Numbers = std::vector<double>;

}  // namespace

TEST_CASE("formats are recognised by content, not by the file's name", "[materials][import]") {
    const std::pair<const char*, const char*> cases[] = {
        {"sopra_ev.nk", "sopra"},    {"sopra_commas.NK", "sopra"}, {"sopra_surplus.nk", "sopra"},
        {"imd.nk", "imd"},           {"tfcalc.MAT", "tfcalc"},     {"page_nk.yml", "rii"},
        {"page_formula.yml", "rii"}, {"table.csv", "csv"},         {"two_parts.csv", "csv"},
        {"energy.csv", "csv"},       {"pair.eta.spd", "spd"},
    };
    for (const auto& [name, format] : cases) {
        CAPTURE(name);
        const auto text =
            support::read_file(std::string(MIEBRDF_MATERIALS_TEST_SAMPLES "/") + name);
        REQUIRE(recognise(text) != nullptr);
        CHECK(recognise(text)->name == std::string(format));
    }
    CHECK(recognise("") == nullptr);
    CHECK(recognise("some words\nand more") == nullptr);
    CHECK(recognise("400 1.5 0\n500 1.4 0\n") == nullptr);  // three columns of what?
}

TEST_CASE("SOPRA: photon energies, noise below 0, trailing words", "[materials][import][sopra]") {
    const Dataset d = sample("sopra_ev.nk");
    REQUIRE((d.n && d.k));
    CHECK(d.n->unit == Unit::electronvolt);
    CHECK(d.n->x == Numbers{2.0, 1.5, 1.0, 0.5});  // ascending in wavelength
    CHECK(d.n->y == Numbers{3.6, 3.3, 3.1, 3.0});
    CHECK(d.k->y == Numbers{0.2, 0.01, 0.0, 0.0});
    CHECK(d.n->longest_nm == Approx(1239.841984 / 0.5).epsilon(1e-15));
    CHECK(d.note == "Dispersion LAw");
    REQUIRE(d.corrections.size() == 1);
    CHECK_THAT(d.corrections[0], Catch::Contains("1 negative k") && Catch::Contains("-0.002"));
}

TEST_CASE("SOPRA: commas, Ctrl-Z, one value per line, surplus rows, all four units",
          "[materials][import][sopra]") {
    CHECK(sample("sopra_commas.NK").n->wavelengths_nm().size() == 4);
    CHECK(sample("sopra_commas.NK").n->x.front() == 0.4);
    CHECK(sample("sopra_commas.NK").corrections.empty());
    const Dataset surplus = sample("sopra_surplus.nk");
    CHECK(surplus.k->y == Numbers{0, 0.001, 0.002});
    CHECK_THAT(surplus.corrections.at(0), Catch::Contains("2 numbers after the last"));
    CHECK(sample("sopra_wavenumber.nk").n->shortest_nm == 500.0);
    CHECK(sample("sopra_nm.nk").n->x == Numbers{400, 500, 600});
}

TEST_CASE("SOPRA: what is refused, and where", "[materials][import][sopra][errors]") {
    const auto refused = [](const char* text) { return read("sopra", text, "x.nk"); };
    CHECK_THROWS_WITH(refused("1 .5 6 3\n1 0\n2 0\n"),
                      Catch::Contains("x.nk:") && Catch::Contains("after 2 of the 4"));
    CHECK_THROWS_WITH(refused("1 .5 6 1\n1 0\nabc 0\n"), Catch::Contains("x.nk:3: 'abc'"));
    CHECK_THROWS_WITH(refused("1 .5 6 1\n1 0\n-2 0\n"), Catch::Contains("x.nk:3: n = -2"));
    CHECK_THROWS_WITH(refused("1 .5 6 1\n1 0\n2 -.5\n"), Catch::Contains("x.nk:3: k = -0.5"));
    CHECK_THROWS_WITH(refused("1 .5 6 1\n1 0\n2 nan\n"), Catch::Contains("x.nk:3"));
    for (const char* header :
         {"", "5 1 2 3", "1 2 1 3", "1 0 1 3", "1 1 2 0", "1 1 2 1.5", "1 1 2 1e9", "1.5 1 2 1"}) {
        CAPTURE(header);
        CHECK_THROWS_WITH(refused(header), Catch::Contains("no SOPRA header"));
    }
}

TEST_CASE("TFCalc: a missing '*', the announced number of points", "[materials][import][tfcalc]") {
    const Dataset d = sample("tfcalc.MAT");
    CHECK(d.n->x == Numbers{400, 500, 600});
    CHECK(d.k->y == Numbers{0.1, 0.05, 0.01});
    CHECK(d.note == "our sample");
    CHECK(d.corrections.empty());
    CHECK_THROWS_WITH(read("tfcalc", "POINTS*2*\nDATA1*1*400*1.5*0*\nEOF*\n", "x"),
                      Catch::Contains("announces 2 points and has 1"));
    CHECK_THROWS_WITH(read("tfcalc", "FORMAT*2*\n", "x"), Catch::Contains("x:1"));
    CHECK_THROWS_WITH(read("tfcalc", "POINTS*1*\nDATA1*1*400*1.5\n", "x"), Catch::Contains("x:2"));
}

TEST_CASE("refractiveindex.info: n and k on grids of their own, the table before the formula",
          "[materials][import][rii]") {
    const Dataset d = sample("page_nk.yml");
    CHECK(d.n->x == Numbers{0.4, 0.5, 0.6});
    CHECK(d.n->y == Numbers{1.60, 1.55, 1.50});
    CHECK(d.k->x == Numbers{0.45, 0.55});
    CHECK(d.k->y == Numbers{0.10, 0.0});
    CHECK(d.doi == "10.1000/xyz.1");
    CHECK_THAT(d.reference, Catch::StartsWith("A. Author. J. Opt. 1, 1-2 (2001), doi"));
    CHECK(d.note == "Sample 2; orientation <100>; thickness: 20 nm");
    CHECK(d.ray == "e");
    CHECK(d.temperature_k == 293.15);
    const std::string all = fmt::format("{}", fmt::join(d.corrections, " | "));
    CHECK_THAT(all, Catch::Contains("sorted") && Catch::Contains("1 rows with a repeated") &&
                        Catch::Contains("negative k") && Catch::Contains("formula 5' ignored"));
    CHECK(d.corrections.size() == 4);
}

TEST_CASE("a DOI with escapes is the DOI", "[materials][import][rii]") {
    CHECK(first_doi("<a href=\"https://doi.org/10.1364%2FAO.12.000555\">") ==
          "10.1364/AO.12.000555");
    CHECK(first_doi("doi.org/10.1/a%zz%2") == "10.1/a%zz%2");
}

TEST_CASE("refractiveindex.info: formulas, the older key of the range, unknown k",
          "[materials][import][rii]") {
    const Dataset d = sample("page_formula.yml");
    CHECK_FALSE(d.k.has_value());
    CHECK(d.n->formula == 3);
    CHECK(d.density_g_cm3 == 2.51);
    const RefractiveIndex index("x", d.n, d.k);
    CHECK(index.at(500).real() == Approx(std::sqrt(2.25 + 0.01 / 0.25)).epsilon(1e-15));
    CHECK_THROWS_AS(index.at(399), InputError);
}

TEST_CASE("refractiveindex.info: what is refused, and where", "[materials][import][rii][errors]") {
    const auto refused = [](const std::string& text) { return read("rii", text, "p.yml"); };
    CHECK_THROWS_WITH(refused("DATA:\n  - type: tabulated nk\n    data: |\n      0.4 1.5\n"),
                      Catch::Contains("p.yml:4: 2 columns"));
    CHECK_THROWS_WITH(
        refused("DATA:\n  - type: tabulated n\n    data: |\n      0.4 1.5\n      0.5 0\n"),
        Catch::Contains("p.yml:5: n = 0"));
    CHECK_THROWS_WITH(refused("DATA:\n  - type: formula 12\n"),
                      Catch::Contains("p.yml:2") && Catch::Contains("formula 12"));
    CHECK_THROWS_WITH(refused("DATA:\n  - type: formula 1\n    coefficients: 1 2\n"),
                      Catch::Contains("without range"));
    CHECK_THROWS_WITH(refused("DATA: nothing\n"), Catch::Contains("no list"));
    CHECK_THROWS_WITH(refused("DATA: [\n"), Catch::Contains("no YAML"));
    CHECK_THROWS_WITH(refused("DATA: &a\n  - *a\n"), Catch::Contains("anchors"));
    CHECK_THROWS_WITH(refused("DATA: " + std::string(1000, '[')), Catch::Contains("nested"));
}

TEST_CASE("CSV: units by column name, two parts, other separators", "[materials][import][csv]") {
    const Dataset d = sample("table.csv");
    CHECK(d.n->unit == Unit::nanometre);
    CHECK(d.label == "mine");
    CHECK(d.reference == "our laboratory, 2024");
    CHECK_THAT(d.corrections.at(0), Catch::Contains("'remark' ignored"));
    const Dataset two = sample("two_parts.csv");
    CHECK(two.n->unit == Unit::micrometre);
    CHECK(two.k->x == Numbers{0.45, 0.55});
    CHECK(sample("energy.csv").n->x == Numbers{3, 2.5, 2});
    CHECK_THROWS_WITH(read("csv", "wavelength,n\n400,1.5\n", "t.csv"),
                      Catch::Contains("t.csv:1") && Catch::Contains("unit of 'wavelength'"));
    CHECK_THROWS_WITH(read("csv", "nm,n\n400,1.5\n500,x\n", "t.csv"),
                      Catch::Contains("t.csv:3: 'x'"));
    CHECK_THROWS_WITH(read("csv", "nm,n\n", "t.csv"), Catch::Contains("no data"));
    CHECK_THROWS_WITH(read("csv", "a,b\n1,2\n", "t.csv"), Catch::Contains("no header"));
}

TEST_CASE("atrri: three columns, read when they are asked for", "[materials][import]") {
    const char* text = "# our sample\n400 1.6 0.1\n500 1.5 0.05  # a remark\n\n600 1.4 0\n";
    const Dataset d = read("atrri", text, "x.atrri");
    CHECK(d.n->x == Numbers{400, 500, 600});
    CHECK(d.k->y == Numbers{0.1, 0.05, 0.0});
    CHECK_THAT(d.note, Catch::StartsWith("our sample"));
    CHECK(recognise(text) == nullptr);
    CHECK_THROWS_WITH(read("atrri", "400 1.5\n", "x.atrri"),
                      Catch::Contains("x.atrri:1: 2 columns"));
}

TEST_CASE("OpenMATERIAL: metres, one temperature, rows or pairs", "[materials][import]") {
    const std::string text = GENERATE(
        "{\n\t\"metadata\": {\"name\": \"metal\"},\n\t\"opticalProperties\": [\n"
        "[4e-07, 297, 1.5, 2.0],\n[5e-07, 297, 1.25, 3.0]]}",
        "{\"asset\": {\"version\": \"2.0\"}, \"extensions\": {\"OpenMaterial_ior_data\": {\n"
        "\"297\": {\"n\": [[4.000e-07, 1.5], [5e-07, 1.25]],\n"
        "\"k\": [[4.000e-07, 2.000e+00], [5e-07, 3.0]]}}}}");
    CAPTURE(text);
    REQUIRE(recognise(text) != nullptr);
    CHECK(recognise(text)->name == std::string("openmaterial"));
    const Dataset d = read("openmaterial", text, "x.xompt");
    REQUIRE(d.n->x.size() == 2);
    CHECK(d.n->x[0] == Approx(400).epsilon(1e-14));
    CHECK(d.n->x[1] == Approx(500).epsilon(1e-14));
    CHECK(d.n->y == Numbers{1.5, 1.25});
    CHECK(d.k->y == Numbers{2, 3});
    CHECK(d.temperature_k == 297.0);
    std::string two = text;
    two.replace(two.find("3.0]"), 4,
                text.find("optical") != std::string::npos
                    ? "3.0], [6e-07, 350, 1, 1]"
                    : "3.0]]}, \"350\": {\"n\": [[6e-07, 1]], \"k\": [[6e-07, 1]");
    CHECK_THROWS_WITH(read("openmaterial", two, "x.xompt"),
                      Catch::Contains("2 temperatures, from 297 to 350 K"));
    std::string bad = text;
    bad.replace(bad.find("1.25"), 4, "\"x\"");
    CHECK_THROWS_WITH(read("openmaterial", bad, "x.xompt"), Catch::Contains("'x'"));
}

TEST_CASE("formats are known by name, and an unknown name lists them all", "[materials][import]") {
    std::string refusal;
    try {
        format_named("zip");
    } catch (const UsageError& error) {
        refusal = error.what();
    }
    CHECK_THAT(refusal, Catch::Contains("'zip'"));
    for (const MaterialFormat& format : material_formats()) {
        CAPTURE(format.name);
        CHECK(format_named(format.name).name == format.name);
        CHECK_THAT(refusal, Catch::Contains(format.name));
        CHECK(format.read);
        CHECK((!format.written || !format.endings.empty()));
    }
    CHECK(format_named("nk").name == std::string("sopra"));
    CHECK(format_named("yaml").name == std::string("rii"));
}

TEST_CASE("IMD and spd: Angstrom and nm, pairs of files", "[materials][import]") {
    const Dataset imd = sample("imd.nk");
    CHECK(imd.n->shortest_nm == 400.0);
    CHECK(imd.k->y == Numbers{0.1, 0.0});
    CHECK_THAT(imd.note, Catch::StartsWith("Optical constants, our sample"));
    for (const char* half : {"pair.eta.spd", "pair.k.spd"}) {
        const Dataset pair = sample(half);
        CHECK(pair.n->y == Numbers{1.5, 1.4});
        CHECK(pair.k->y == Numbers{0.5, 0.45, 0.4});  // sorted
    }
    CHECK_FALSE(read("spd", "400 1.5\n", "x").k.has_value());
    CHECK_FALSE(read("spd", "", "x", "400 1.5\n").n.has_value());
    // n in nm, k in um.
    CHECK_THROWS_WITH(read("spd", "400 1.5\n700 1.4\n", "x", "0.4 0.1\n0.7 0.2\n"),
                      Catch::Contains("no wavelength in common"));
    CHECK_THROWS_WITH(read("spd", "400 1.5\n500 1 2\n", "x"), Catch::Contains("x.eta.spd:2"));
}

TEST_CASE("CSV as people and spreadsheets write it", "[materials][import][csv]") {
    const char* texts[] = {
        "wavelength_nm;n;k\n400,0;1,50;0,01\n500,0;1,49;0,02\n",
        "\"wavelength_nm\",n,k\n\"400,0\",\"1,50\",\"0,01\"\n500,\"1,49\",\"0,02\"\n",
        "WL[nm] n k\n400 1.5 0.01\n500 1.49 0.02\n",
        "Wavelength (nm) n k\n400 1,5 0,01\n500 1,49 0,02\n",
        "Wavelength (nm)\tn\tk\n400\t1,50\t0,01\n500\t1,49\t0,02\n",
        "wavelength_nm,refractive_index,extinction_coefficient\n400,1.5,1%\n500,1.49,2 %\n",
        "wavelength_nm,refractive index,kappa,\n400,1.5,0.01,\n500,1.49,0.02,\n",
        "# Wavelength (um)  n  k\n0.4 1.5 0.01\n0.5 1.49 0.02\n",
        "lambda (nm),eps1,eps2\n400,2.2499,0.03\n500,2.2197,0.0596\n",
    };
    for (const char* text : texts) {
        CAPTURE(text);
        REQUIRE(recognise(text) != nullptr);
        CHECK(recognise(text)->name == std::string("csv"));
        const Dataset d = read("csv", text, "t.csv");
        CHECK(d.n->wavelengths_nm() == Numbers{400, 500});
        CHECK(std::abs(d.n->y[0] - 1.5) <= 1e-12);
        CHECK(std::abs(d.k->y[1] - 0.02) <= 1e-12);
    }
    const auto refused = [](const char* text) { return read("csv", text, "t.csv"); };
    CHECK_THROWS_WITH(refused("nm,n,k\n400,0,1,50,0,01\n"),
                      Catch::Contains("t.csv:2: 6 fields under 3 names"));
    CHECK_THROWS_WITH(refused("nm,n\n400,1,50\n"), Catch::Contains("decimal commas"));
    CHECK_THROWS_WITH(refused("nm;n\n400.5;1,5\n"), Catch::Contains("decimal points and"));
    CHECK_THROWS_WITH(refused("nm,eps1\n400,2\n"), Catch::Contains("no header"));
    CHECK_THROWS_WITH(refused("nm,n\n0.4,1.5\n"), Catch::Contains("X-rays"));
    // Row numbers are no indices.
    CHECK_THROWS_WITH(refused("index,nm,n,k\n1,400,1.5,0.01\n2,500,1.49,0.02\n"),
                      Catch::Contains("a second column of the kind of 'n'"));
    CHECK_THROWS_WITH(refused("nm,n,k,kappa\n400,1.5,0.01,0.02\n"), Catch::Contains("'kappa'"));
    CHECK(read("csv", "wavelength (\xb5m),n\n0.4,1.5\n", "latin1.csv").n->shortest_nm == 400);
}

TEST_CASE("a byte-order mark changes nothing", "[materials][import]") {
    const support::TemporaryFolder folder;
    const std::string mark = "\xef\xbb\xbf";
    for (const auto& [name, text] : std::vector<std::pair<const char*, const char*>>{
             {"a.csv", "wavelength_nm,n,k\n400,1.5,0.1\n500,1.4,0.1\n"},
             {"b.nk", "4 400 500 1\n1.5 0.1\n1.4 0.1\n"},
             {"c.nk", "; imd\n4000 1.5 0.1\n5000 1.4 0.1\n"},
             {"d.yml",
              "DATA:\n  - type: tabulated nk\n    data: |\n      0.4 1.5 .1\n      0.5 1.4 .1\n"},
             {"e.MAT", "POINTS*2*\nDATA1*1*400*1.5*.1*\nDATA1*2*500*1.4*.1*\nEOF*\n"}}) {
        CAPTURE(name);
        const Dataset d = read_file(folder.write(name, mark + text));
        CHECK(d.n->wavelengths_nm() == Numbers{400, 500});
        CHECK(d.k->y == Numbers{0.1, 0.1});
        CHECK(d.file_sha256 != read_file(folder.write(name, text)).file_sha256);
    }
    CHECK_THROWS_WITH(read_file(folder.write("u.csv", std::string("\xff\xfen\0", 4))),
                      Catch::Contains("UTF-16"));
    CHECK_THROWS_WITH(read_file(folder.write("z.csv", std::string("n,k\n1\0,2", 8))),
                      Catch::Contains("z.csv") && Catch::Contains("binary"));
}

TEST_CASE("the unit that a file names counts, then the one that is given", "[materials][import]") {
    const support::TemporaryFolder folder;
    const auto wl = folder.write("wl.csv", "wl,n,k\n400,1.5,0.01\n500,1.49,0.02\n");
    CHECK(read_file(wl).n->shortest_nm == 400000);  // of refractiveindex.info
    CHECK(read_file(wl, {.unit = Unit::nanometre}).n->shortest_nm == 400);
    const auto named = folder.write("um.csv", "wavelength_um,n\n0.4,1.5\n0.5,1.49\n");
    const Dataset kept = read_file(named, {.unit = Unit::nanometre});
    CHECK(kept.n->shortest_nm == 400);
    CHECK_THAT(kept.corrections.at(0), Catch::Contains("um") && Catch::Contains("nm not used"));
    const auto imd =
        folder.write("x.nk", ";Wavelength (nm)  n  k\r\n400 1.5 0.1\r\n500 1.6 0.2\r\n");
    CHECK(read_file(imd).n->shortest_nm == 400);
    folder.write("Um.k.spd", "0.3 0.1\n0.5 0.2\n");
    const auto spd = folder.write("Um.eta.spd", "0.3 1.5\n0.5 1.49\n");
    CHECK_THROWS_WITH(read_file(spd), Catch::Contains("another unit than nm"));
    const Dataset pair = read_file(spd, {.unit = Unit::micrometre});
    CHECK(pair.n->shortest_nm == 300);
    CHECK(pair.k->y == Numbers{0.1, 0.2});
}

TEST_CASE("n - ik is turned into n + ik, and a table of k is none of n", "[materials][import]") {
    const Dataset turned = read("csv", "nm,n,k\n400,1.5,-0.5\n500,1.49,-0.008\n600,1.4,0\n", "t");
    CHECK(turned.k->y == Numbers{0.5, 0.008, 0.0});
    CHECK_THAT(turned.corrections.at(0), Catch::Contains("n - ik"));
    const Dataset noise = read("csv", "nm,n,k\n400,1.5,0\n500,1.49,-0.008\n600,1.4,0\n", "t");
    CHECK(noise.k->y == Numbers{0.0, 0.0, 0.0});
    CHECK_THROWS_WITH(read("csv", "nm,n,k\n400,1.5,0.2\n500,1.49,-0.5\n", "t"),
                      Catch::Contains("k = -0.5"));
    CHECK_THROWS_WITH(read("csv", "nm,n\n400,2.1e-8\n500,9.9e-9\n", "t"),
                      Catch::Contains("2.1e-08") && Catch::Contains("figures k?"));
}

TEST_CASE("SOPRA: decimal commas", "[materials][import][sopra]") {
    const Dataset d = read("sopra", "4 400 500 1\n2,95 3,12\n2,85 3,02\n", "x.nk");
    CHECK(d.n->y == Numbers{2.95, 2.85});
    CHECK(d.k->y == Numbers{3.12, 3.02});
    CHECK(d.corrections.empty());
    CHECK_THROWS_WITH(read("sopra", "4 400 500 1\n2,95,3,12\n2,85,3,02\n", "x.nk"),
                      Catch::Contains("4 numbers follow the 4"));
    // Rows are missing: not twice as many numbers.
    CHECK_THROWS_WITH(read("sopra", "4 400 500 3\n2,95 3,12\n2,85 3,02\n2,8 3,0\n", "x.nk"),
                      Catch::Contains("ends after 3 of the 4 rows"));
}

TEST_CASE("refractiveindex.info: formulas with another number of coefficients are refused",
          "[materials][import][rii][errors]") {
    const auto with = [](int formula, const char* coefficients) {
        return read("rii",
                    fmt::format("DATA:\n  - type: formula {}\n    range: 0.4 2\n"
                                "    coefficients: {}\n",
                                formula, coefficients),
                    "x.yml");
    };
    CHECK(with(4, "1 0.5 2 0.02 1").n->y.size() == 5);
    CHECK(with(7, "3.4 0.1 -0.1 1e-6 -1e-9").n->y.size() == 5);
    // The last resonance without its wavelength, as in AgGaSe2/Boyd-o.
    CHECK_THROWS_WITH(with(2, "3.6453 2.2057 0.1879 1.8377"),
                      Catch::Contains("formula 2 with 4 coefficients"));
    CHECK_THROWS_WITH(with(4, "0 6.04 2 44.444 2 -4088.9 0 44.444"), Catch::Contains("with 8"));
    CHECK_THROWS_WITH(with(9, "2.2 0.01 0.02 0.01 1 0.1 9 9 9"), Catch::Contains("allowed: 6"));
    CHECK_THROWS_WITH(with(5, "1.4 0.02"), Catch::Contains("odd"));
    CHECK_THROWS_WITH(read("rii",
                           "DATA:\n  - type: formula 5\n    type: formula 3\n"
                           "    range: 0.4 2\n    coefficients: 2\n",
                           "x.yml"),
                      Catch::Contains("'type' stands twice"));
}
