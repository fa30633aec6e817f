// The materials subcommands as a user runs them, each with a database of its own.
#include <filesystem>

#include "tests/support/catch.h"
#include "tests/support/program.h"
#include "tests/support/program_csv.h"
#include "tests/support/temporary_folder.h"
#include "tests/tools/one_line.h"

using namespace miebrdf;
using support::kBadInput;
using support::kUsage;

namespace {

constexpr int kCheckFailed = 1;

const std::string kCsv = "# label: lab\nwavelength_nm,n,k\n400,1.5,0.1\n500,1.6,0.2\n600,1.7,0.3\n";

/// The program with a user database in a folder that goes away.
struct Bench {
    support::TemporaryFolder folder;
    support::ProgramRun run(const std::string& arguments) const {
        return support::run_program(
            "materials " + arguments,
            "XDG_DATA_HOME=" + folder.path().string() + " MIEBRDF_DATABASE=");
    }
    std::string import_sample() const {
        std::string file = folder.write("mine.csv", kCsv);
        REQUIRE(run("import " + file + " --name MyOxide").exit_code == 0);
        return file;
    }
};

void check_error(const support::ProgramRun& run, int exit_code, const std::string& word) {
    CAPTURE(run.err, run.out);
    CHECK(run.exit_code == exit_code);
    CHECK(run.out.empty());
    CHECK_THAT(run.err, Catch::StartsWith("miebrdf: error: ") && Catch::Contains(word));
}

}  // namespace

TEST_CASE("materials list, search and show", "[program][materials]") {
    const Bench bench;
    const support::CsvOutput list(bench.run("list").out);
    CHECK(list.size() == 109);
    CHECK(list.columns().front() == "name");
    const support::CsvOutput found(
        bench.run("search \"titanium dioxide\" --covers 400:700 --has-k").out);
    REQUIRE(found.size() >= 1);
    CHECK(found.text(0, "name") == "TiO2");
    CHECK(bench.run("search zzzz").exit_code == kCheckFailed);
    CHECK_THAT(bench.run("show AlGaAs7").out, Catch::Contains("AlGaAs_70/SOPRA-ALGAAS7"));
    CHECK_THAT(bench.run("show Fe2O3").out, Catch::Contains("density (g/cm3),5.26 ("));
    CHECK_THAT(bench.run("show gap --json").out, Catch::StartsWith("{"));
    check_error(bench.run("search x --covers 1:2:3"), kUsage, "--covers");
    check_error(bench.run("show TiO3"), kBadInput, "TiO2");
    check_error(bench.run("show unobtainium"), kBadInput, "search");
}

TEST_CASE("materials nk: units, range, interpolation, clamping", "[program][materials]") {
    const Bench bench;
    const support::CsvOutput nk(
        bench.run("nk GaP --wavelengths 550,0.55um,5500A,18181.818181818182cm-1").out);
    CHECK(nk.columns() == std::vector<std::string>{"wavelength_nm", "n", "k"});
    REQUIRE(nk.size() == 4);
    // Between the table's rows at 2.25 and 2.275 eV.
    for (std::size_t row = 0; row < 4; ++row) {
        CHECK(nk.number(row, "n") == Approx(3.4496).epsilon(1e-4));
        CHECK(nk.number(row, "n") == Approx(nk.number(0, "n")).epsilon(1e-12));
    }
    check_error(bench.run("nk SiON --wavelengths 900"), kBadInput, "250 to 800 nm");
    check_error(bench.run("nk GaP --wavelengths -1"), kUsage, "-1");
    check_error(bench.run("nk GaP --wavelengths 550 --interpolation magic"), kUsage, "magic");
    const auto clamped = bench.run("nk SiON --wavelengths 900 --extrapolate clamp");
    CHECK_THAT(clamped.out, Catch::Contains("# extrapolated: 900 nm is outside 250 to 800 nm"));
    CHECK_THAT(bench.run("nk BaTiO3 --wavelengths 550").out, Catch::Contains("# k: unknown"));
    CHECK_THAT(bench.run("nk SiO2 --wavelengths 550 --k-floor 1e-6").out,
               Catch::Contains(",1e-06"));
}

TEST_CASE("materials import, alias, default, export and remove go round", "[program][materials]") {
    const Bench bench;
    const std::string file = bench.import_sample();
    CHECK_THAT(bench.run("import " + file + " --name MyOxide").out, Catch::Contains("unchanged"));
    CHECK(bench.run("alias \"house white\" MyOxide").exit_code == 0);
    CHECK_THAT(bench.run("nk \"House White\" --wavelengths 500").out,
               Catch::Contains("500,1.6,0.2"));
    check_error(bench.run("alias gold MyOxide"), kBadInput, "Au");

    REQUIRE(bench.run("import " + file + " --name GaP --label mine").exit_code == 0);
    CHECK_THAT(bench.run("nk GaP --wavelengths 500").out, Catch::Contains("GaP/SOPRA-GAP"));
    CHECK(bench.run("default GaP/mine").exit_code == 0);
    // The table is another one, the substance is not.
    CHECK_THAT(bench.run("show GaP").out, Catch::Contains("4.14 (CRC"));
    CHECK_THAT(bench.run("nk GaP --wavelengths 500").out, Catch::Contains("500,1.6,0.2"));
    CHECK(bench.run("remove GaP/mine").exit_code == 0);
    CHECK_THAT(bench.run("nk GaP --wavelengths 500").out, Catch::Contains("GaP/SOPRA-GAP"));
    check_error(bench.run("remove GaP"), kBadInput, "embedded");

    const std::string out = bench.folder / "out.yml";
    REQUIRE(bench.run("export MyOxide --format yaml -o " + out).exit_code == 0);
    REQUIRE(bench.run("import " + out + " --name Again --label again").exit_code == 0);
    CHECK(bench.run("diff MyOxide Again").exit_code == 0);
    CHECK(bench.run("diff MyOxide SiO2").exit_code == kCheckFailed);
    CHECK(bench.run("export MyOxide --format spd -o " + (bench.folder / "pair")).exit_code == 0);
    CHECK(std::filesystem::exists(bench.folder / "pair.k.spd"));
    check_error(bench.run("export MyOxide --format spd"), kUsage, "two files");
    check_error(bench.run("export BaTiO3 --format tfcalc --wavelengths 400:700:100"), kBadInput,
                "k is unknown");
    CHECK(bench.run("verify").exit_code == 0);
}

TEST_CASE("a pair of files may be named by its beginning or by one of its halves",
          "[program][materials]") {
    const Bench bench;
    const auto given = GENERATE("pair", "pair.spd", "pair.eta.spd", "pair.k.spd");
    CAPTURE(given);
    REQUIRE(bench.run("export GaP --format spd -o " + (bench.folder / given)).exit_code == 0);
    CHECK(bench.folder.count() == 2);
    REQUIRE(bench.run("import " + (bench.folder / "pair.eta.spd") + " --name Back").exit_code == 0);
    // um in the database, nm in the file: the wavelengths may differ by a rounding.
    CHECK(bench.run("diff GaP Back --tolerance 1e-12").exit_code == 0);
}

TEST_CASE("removing says how much of the user's was removed", "[program][materials]") {
    const Bench bench;
    const std::string file = bench.import_sample();
    REQUIRE(bench.run("import " + file + " --name MyOxide --label two").exit_code == 0);
    CHECK_THAT(bench.run("remove MyOxide").err, Catch::Contains("2 datasets"));
    check_error(bench.run("remove MyOxide"), kBadInput, "MyOxide");
}

TEST_CASE("a table of one's own without title and reference has a source line all the same",
          "[program][materials]") {
    const support::TemporaryFolder folder;
    const std::string table = folder.write("x.csv", "wavelength_nm,n,k\n400,1.5,0\n700,1.4,0.1\n");
    const std::string database = " --database " + (folder / "own.db");
    support::run_ok("materials import " + table + " --name Testite --source lab" + database);
    const auto run =
        support::run_program("optics Testite --wavelengths 550 --effective-radius 1" + database);
    CAPTURE(run.out, run.err);
    CHECK_THAT(run.out,
               Catch::Contains("# source: Testite: dataset ") && Catch::Contains(", lab\n"));
}

TEST_CASE("a bad file changes nothing and says where it is bad", "[program][materials]") {
    const Bench bench;
    const std::string bad = bench.folder.write("bad.csv", "wavelength_nm,n\n400,1.5\n500,oops\n");
    const std::string good = bench.folder.write("good.csv", kCsv);
    check_error(bench.run("import " + good + " " + bad), kBadInput, "bad.csv:3: 'oops'");
    CHECK_FALSE(bench.run("show good").exit_code == 0);
    CHECK(bench.folder.count() == 2);  // not even an empty database
    check_error(bench.run("import " + good + " --format nonsense"), kUsage, "nonsense");
    check_error(bench.run("import " + (bench.folder / "missing.nk")), kUsage, "missing.nk");
}

TEST_CASE("materials datasets: one line each", "[program][materials]") {
    const Bench bench;
    const support::CsvOutput both(bench.run("datasets ice").out);
    REQUIRE(both.size() == 2);
    CHECK(both.text(0, "dataset") == "H2O_ice/Warren-2008");
    CHECK(both.text(0, "default") == "yes");
    CHECK(both.text(1, "source") == "SNICAR:rfidx_ice_v2:Pic16");
    const support::CsvOutput far(bench.run("datasets ice --covers 100:2000").out);
    CHECK(far.size() == 1);
    const auto none = bench.run("datasets SiON --covers 400:2000");
    CHECK(none.exit_code == kCheckFailed);
    check_error(bench.run("datasets TiO3"), kBadInput, "TiO2");
}

TEST_CASE("long lists are cut on request, and a search that finds nothing proposes names",
          "[program][materials]") {
    const Bench bench;
    CHECK(support::CsvOutput(bench.run("list --limit 5").out).size() == 5);
    CHECK_THAT(bench.run("list --limit 5").err, Catch::Contains("first 5 of 109"));
    CHECK(support::CsvOutput(bench.run("search \"\" --limit 0").out).size() == 109);
    CHECK(support::CsvOutput(bench.run("search \"\"").out).size() == 50);
    CHECK_THAT(bench.run("search polystirene").err, Catch::Contains("did you mean polystyrene"));
    CHECK(support::CsvOutput(bench.run("search TiO\xe2\x82\x82").out).text(0, "name") == "TiO2");
}

TEST_CASE("mixtures are materials of every command", "[program][materials]") {
    const Bench bench;
    const std::string name = "\"average(TiO2_rutile_o,TiO2_rutile_e)\"";
    const support::CsvOutput nk(bench.run("nk " + name + " --wavelengths 550").out);
    CHECK(nk.number(0, "n") == Approx((2 * 2.6479 + 2.9441) / 3).epsilon(2e-3));
    CHECK_THAT(bench.run("show " + name).out, Catch::Contains("of the parts, by volume"));
    const auto optics = support::run_program(
        "optics \"maxwell-garnett(soot:1%,water),radius=0.5\" --wavelengths 550");
    CAPTURE(optics.err);
    CHECK(optics.exit_code == 0);
    CHECK_THAT(optics.out, Catch::Contains("Maxwell Garnett: 0.01 soot_diesel"));
    check_error(bench.run("nk \"bruggeman(TiO2:2,SiO2)\" --wavelengths 550"), kUsage, "0 to 1");
}

TEST_CASE("scenes take n and k between and beyond the rows as nk does", "[program][materials]") {
    const std::string optics = "optics SiON --effective-radius 1 --wavelengths ";
    CHECK(support::run_program(optics + "900").exit_code == kBadInput);
    const auto clamped = support::run_program(optics + "900 --extrapolate clamp");
    CHECK(clamped.exit_code == 0);
    CHECK_THAT(clamped.out, Catch::Contains("1 of 1 wavelengths are outside 250 to 800 nm"));
    const support::CsvOutput smooth(support::run_program(optics + "551").out),
        linear(support::run_program(optics + "551 --interpolation linear").out);
    CHECK(smooth.number(0, "n") != linear.number(0, "n"));
    CHECK(smooth.number(0, "n") == Approx(linear.number(0, "n")).epsilon(1e-4));
    check_error(support::run_program(optics + "551 --interpolation magic"), kUsage, "pchip");
}

TEST_CASE("permittivity and group index beside n and k, formulas as tables",
          "[program][materials]") {
    const Bench bench;
    const support::CsvOutput nk(
        bench.run("nk SiO2/SOPRA-SIO2 --wavelengths 589.3 --permittivity --group-index").out);
    const double n = nk.number(0, "n");
    CHECK(nk.number(0, "permittivity_real") == Approx(n * n).epsilon(1e-14));
    CHECK(nk.number(0, "permittivity_imaginary") == 0);
    // Fused silica, Malitson's formula: n - w dn/dw = 1.4788 at 589.3 nm.
    CHECK(nk.number(0, "group_index") == Approx(1.4788).epsilon(1e-3));

    check_error(bench.run("export NaCl --format csv"), kBadInput, "formula");
    const auto table = bench.run("export NaCl --format csv --wavelengths 400:700:100");
    CHECK_THAT(table.out, Catch::Contains("sampled at 4 wavelengths"));
    const support::CsvOutput rows(table.out);
    CHECK(rows.size() == 4);
    CHECK(rows.number(1, "n") ==
          support::CsvOutput(bench.run("nk NaCl --wavelengths 500").out).number(0, "n"));
}

TEST_CASE("bare columns and bad rows on request, remove shows what it would do",
          "[program][materials]") {
    const Bench bench;
    const std::string bare = bench.folder.write("bare.txt", "0.4 1.5 0\n0.5 1.6 0\n");
    check_error(bench.run("import " + bare), kBadInput, "not recognised");
    CHECK(bench.run("import " + bare + " --unit um --name Bare").exit_code == 0);
    CHECK_THAT(bench.run("nk Bare --wavelengths 500").out, Catch::Contains("500,1.6,0"));
    const auto dry = bench.run("remove Bare --dry-run");
    CHECK_THAT(dry.out, Catch::Contains("Bare/csv-bare"));
    CHECK_THAT(dry.err, Catch::Contains("1 dataset would be removed"));
    CHECK(bench.run("show Bare").exit_code == 0);

    std::string rows = "nm,n\n";
    for (int i = 400; i < 420; ++i) rows += std::to_string(i) + ",1.5\n";
    const std::string bad = bench.folder.write("bad.csv", rows + "420,oops\n");
    check_error(bench.run("import " + bad), kBadInput, "bad.csv:22");
    CHECK_THAT(bench.run("import " + bad + " --skip-bad-rows").out,
               Catch::Contains("row of line 22 left out"));
    check_error(bench.run("import /dev/zero"), kBadInput, "no ordinary file");
}

TEST_CASE("materials plot draws n and k", "[program][materials]") {
    const Bench bench;
    const std::string file = bench.folder / "nk.svg";
    REQUIRE(bench.run("plot GaP TiO2 -o " + file).exit_code == 0);
    const std::string svg = support::read_file(file);
    CHECK_THAT(svg, Catch::Contains("<svg") && Catch::Contains("GaP/SOPRA-GAP"));
    check_error(bench.run("plot GaP"), kUsage, "-o FILE");
    check_error(bench.run("plot SiON --range 900:1000 -o " + file), kBadInput, "nothing to draw");
}

TEST_CASE("databases that are none are refused", "[program][materials]") {
    const Bench bench;
    const std::string text = bench.folder.write("text.db", std::string(5000, 'x'));
    check_error(bench.run("list --database " + text), kBadInput, "not a materials database");
    check_error(bench.run("list --database " + (bench.folder / "missing.db")), kBadInput,
                "does not exist");
    const std::string file = bench.folder.write("mine.csv", kCsv);
    check_error(bench.run("import " + file + " --database " + text), kBadInput,
                "not a materials database");
    CHECK(support::read_file(text) == std::string(5000, 'x'));
}
