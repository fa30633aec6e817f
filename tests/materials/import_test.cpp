// Files and folders into a database, and out again.
#include <miebrdf/database.h>

#include <fmt/format.h>

#include <algorithm>
#include <complex>
#include <map>

#include "materials/index/checksum.h"
#include "tests/support/catch.h"
#include "tests/support/temporary_folder.h"

using namespace miebrdf;
using namespace miebrdf::materials;

namespace {

const std::filesystem::path samples = MIEBRDF_MATERIALS_TEST_SAMPLES;
const std::filesystem::path big_samples = MIEBRDF_SAMPLES_DIR;

std::vector<ImportItem> import_into(const std::filesystem::path& database,
                                    const std::vector<std::filesystem::path>& files,
                                    const ImportOptions& options = {}) {
    return import_files(database, files, options);
}

std::map<std::string, ImportItem> by_name(const std::vector<ImportItem>& items) {
    std::map<std::string, ImportItem> found;
    for (const ImportItem& item : items) found[std::filesystem::path(item.file).filename()] = item;
    return found;
}

std::filesystem::path write_in(const support::TemporaryFolder& folder, const std::string& name,
                               const std::string& text) {
    std::filesystem::create_directories(folder.path() / "in");
    return folder.write("in/" + name, text);
}

bool big_samples_missing() {
    if (std::filesystem::is_directory(big_samples)) return false;
    WARN("skipped: no collection of samples in '" << big_samples.string()
                                                  << "'; configure with -DMIEBRDF_SAMPLES_DIR=DIR");
    return true;
}

}  // namespace

TEST_CASE("importing twice changes nothing", "[materials][import]") {
    const support::TemporaryFolder folder;
    const auto file = folder.path() / "user.sqlite";
    const std::vector<std::filesystem::path> files{samples / "sopra_ev.nk", samples / "table.csv"};
    for (const ImportItem& item : import_into(file, files))
        CHECK(item.outcome == AddOutcome::added);
    const std::string before = support::read_file(file);
    for (const ImportItem& item : import_into(file, files))
        CHECK(item.outcome == AddOutcome::unchanged);
    CHECK(support::read_file(file) == before);
}

TEST_CASE("one bad file among those named: nothing is changed", "[materials][import]") {
    const support::TemporaryFolder folder;
    const auto file = folder.path() / "user.sqlite";
    const auto bad = folder.write("bad.nk", "1 .5 6 1\n1 0\n2 x\n");
    import_into(file, {samples / "table.csv"});
    CHECK_THROWS_WITH(import_into(file, {samples / "sopra_ev.nk", bad}),
                      Catch::Contains("bad.nk:3: 'x'"));
    CHECK_THROWS_WITH(import_into(file, {folder.write("what.dat", "hello\n")}),
                      Catch::Contains("not recognised"));
    CHECK_THROWS_AS(import_into(file, {folder.path() / "missing.nk"}), ImportError);
    CHECK(Database::open(file).list().size() == 1);
}

TEST_CASE("other figures under a label that is taken are refused", "[materials][import]") {
    const support::TemporaryFolder folder;
    const auto file = folder.path() / "user.sqlite";
    const auto first = write_in(folder, "a.csv", "nm,n\n400,1.5\n");
    const auto other = write_in(folder, "b.csv", "nm,n\n400,1.6\n");
    import_into(file, {first}, {.material = "M", .label = "x"});
    CHECK_THROWS_WITH(import_into(file, {other}, {.material = "M", .label = "x"}),
                      Catch::Contains("b.csv: M/x is already in") && Catch::Contains("replace"));
    CHECK_THROWS_WITH(import_into(file, {first, other}, {.material = "N", .label = "x"}),
                      Catch::Contains("another file gives N/x"));
    CHECK_THROWS_WITH(import_into(file, {first}, {.material = "GaP", .label = "visible"}),
                      Catch::Contains("embedded"));
    // In a folder the clash is refused and the rest goes on.
    const auto items = import_into(file, {folder.path() / "in"}, {.material = "P", .label = "x"});
    CHECK(std::count_if(items.begin(), items.end(), [](const auto& i) { return !i.outcome; }) == 1);
    const auto replaced =
        import_into(file, {other}, {.material = "M", .label = "x", .replace = true});
    CHECK(replaced.front().outcome == AddOutcome::replaced);
}

TEST_CASE("a folder with a catalogue: wrong entries are refused one by one",
          "[materials][import][rii]") {
    const support::TemporaryFolder folder;
    const auto file = folder.path() / "user.sqlite";
    const auto items = import_into(file, {samples / "rii_database"});
    REQUIRE(items.size() == 6);
    std::map<std::string, int> refused;
    for (const ImportItem& item : items) {
        if (!item.outcome) refused[item.reason]++;
    }
    REQUIRE(refused.size() == 3);
    const std::string reasons =
        fmt::format("{} {} {}", refused.begin()->first, std::next(refused.begin())->first,
                    refused.rbegin()->first);
    CHECK_THAT(reasons, Catch::Contains("a file of As2S3 under MgO") &&
                            Catch::Contains("no such file") && Catch::Contains("lies outside"));
    const Database database = Database::layered(file);
    CHECK(database.dataset("Ag/Sample").key == "main/Ag/Sample");
    CHECK(database.dataset("rii:main/Ag/Sample").k->y.back() == 3.5);
    CHECK(database.info("As2S3").title == "As2S3 (Arsenic trisulfide)");
    // A maker's glass called BAF2 is not barium fluoride.
    CHECK(database.info("MAKER-optical BAF2").name == "MAKER-optical BAF2");
    CHECK(database.info("BAF2").name == "BaF2");
}

TEST_CASE("names from files: known spellings, new materials, names given", "[materials][import]") {
    const support::TemporaryFolder folder;
    const auto file = folder.path() / "user.sqlite";
    const std::string text = support::read_file(samples / "sopra_ev.nk");
    const auto items =
        by_name(import_into(file, {folder.write("gap.nk", text), folder.write("NEW1.NK", text)}));
    CHECK(items.at("gap.nk").dataset == "GaP/SOPRA-GAP");
    CHECK(items.at("NEW1.NK").dataset == "NEW1/SOPRA-NEW1");
    const auto named =
        import_into(file, {samples / "table.csv"}, {.material = "titania", .label = "x"});
    CHECK(named.front().dataset == "TiO2/x");
    // CO and Co are both there: "co" is no longer one name.
    import_into(file, {samples / "table.csv"}, {.material = "CO"});
    CHECK_THROWS_WITH(import_into(file, {folder.write("co.nk", text)}), Catch::Contains("CO, Co"));
}

TEST_CASE("every format that takes a dataset gives it back", "[materials][export]") {
    for (const char* name :
         {"sopra_ev.nk", "sopra_commas.NK", "tfcalc.MAT", "page_nk.yml", "page_formula.yml",
          "table.csv", "two_parts.csv", "energy.csv", "imd.nk", "pair.eta.spd"}) {
        const support::TemporaryFolder folder;
        Dataset original = read_file(samples / name);
        original.density_g_cm3 = 4.23;
        original.density_source = "a handbook";
        for (const MaterialFormat& kind : material_formats()) {
            const std::string& format = kind.name;
            CAPTURE(name, format);
            std::vector<ExportFile> files;
            try {
                files = export_dataset(original, format);
            } catch (const InputError& refusal) {
                CHECK_THAT(refusal.what(), Catch::Contains("cannot be written as"));
                continue;
            }
            for (const ExportFile& file : files) folder.write("out" + file.suffix, file.text);
            const Dataset back =
                read_file(folder.path() / ("out" + files.front().suffix), {.format = format});
            REQUIRE(back.n.has_value() == original.n.has_value());
            CHECK(back.n->y == original.n->y);
            CHECK(back.k.has_value() == original.k.has_value());
            if (back.k) CHECK(back.k->y == original.k->y);
            // Another unit: half a unit in the last place of either side.
            const auto before = original.n->wavelengths_nm(), after = back.n->wavelengths_nm();
            REQUIRE(before.size() == after.size());
            for (std::size_t i = 0; i < before.size(); ++i) {
                CHECK(std::abs(after[i] / before[i] - 1) <= 3.4e-16);
            }
            const bool keeps_unit = format == "csv" || back.n->unit == original.n->unit;
            if (keeps_unit) CHECK(content_sha256(back) == content_sha256(original));
            if (format == "csv" || format == "rii") {
                CHECK(back.reference == original.reference);
                CHECK(back.ray == original.ray);
                CHECK(back.temperature_k == original.temperature_k);
                CHECK(back.density_g_cm3 == 4.23);
                CHECK(back.density_source == "a handbook");
                CHECK(back.corrections == original.corrections);
            }
        }
    }
}

TEST_CASE("embedded tables with even decimal steps are written as SOPRA", "[materials][export]") {
    // 0.36, 0.365, ... um: each row rounded by itself, so not to the bit first + i * step.
    for (const char* name : {"GaP", "SiO2", "TiO2"}) {
        const Dataset original = Database::embedded().dataset(name);
        const support::TemporaryFolder folder;
        const auto file = folder.write("x.nk", export_dataset(original, "sopra")[0].text);
        const Dataset back = read_file(file, {.format = "sopra"});
        CAPTURE(name);
        CHECK(back.n->y == original.n->y);
        CHECK(back.k->y == original.k->y);
        REQUIRE(back.n->x.size() == original.n->x.size());
        for (std::size_t i = 0; i < back.n->x.size(); ++i) {
            CHECK(std::abs(back.n->x[i] / original.n->x[i] - 1) <= 1e-15);
        }
    }
}

TEST_CASE("exports refuse what the format cannot say", "[materials][export][errors]") {
    const auto refusal = [](const char* name, const char* format) {
        return [=] { export_dataset(read_file(samples / name), format); };
    };
    CHECK_THROWS_WITH(refusal("page_formula.yml", "csv")(), Catch::Contains("formula"));
    CHECK_THROWS_WITH(refusal("two_parts.csv", "tfcalc")(), Catch::Contains("different grids"));
    CHECK_THROWS_WITH(refusal("imd.nk", "sopra")(), Catch::Contains("no unit angstrom"));
    Dataset uneven = read_file(samples / "sopra_nm.nk");
    for (Series* series : {&*uneven.n, &*uneven.k}) series->x[1] *= 1 + 1e-13;
    CHECK_THROWS_WITH(export_dataset(uneven, "sopra"), Catch::Contains("not uniform"));
    Dataset d = read_file(samples / "table.csv");
    d.k.reset();
    CHECK_THROWS_WITH(export_dataset(d, "tfcalc"), Catch::Contains("k is unknown"));
    const auto as_zero = export_dataset(d, "tfcalc", {.unknown_k_as_zero = true});
    CHECK_THAT(as_zero.front().text, Catch::Contains("DATA1*1*400*1.5*0*"));
}

TEST_CASE("verify finds wrong values and k that does not belong to n", "[materials][verify]") {
    Dataset d;
    d.material = "M";
    d.label = "l";
    std::vector<double> x, n, k;
    for (int i = 0; i < 60; ++i) {
        // A Lorentz oscillator at 400 nm; epsilon = 1 + s / (E0^2 - E^2 - i g E).
        x.push_back(200 + 20 * i);
        const double E = 1239.841984 / x.back();
        const std::complex<double> epsilon =
            1.0 + 8.0 / std::complex<double>(9.6 - E * E, -0.5 * E);
        n.push_back(std::sqrt(epsilon).real());
        k.push_back(std::sqrt(epsilon).imag());
    }
    d.n = make_table(Unit::nanometre, x, n);
    d.k = make_table(Unit::nanometre, x, k);
    CHECK(verify(d).empty());
    // Causal by construction: only the trapezoids of k and the missing tails remain.
    CHECK(kramers_kronig_residual(d) <= 0.05);

    Dataset typing_error = d;
    typing_error.n->y[30] *= 1.3;
    REQUIRE(verify(typing_error).size() == 1);
    CHECK_THAT(verify(typing_error)[0].text,
               Catch::Contains("n jumps") && Catch::Contains("800 nm"));

    Dataset stranger = d;  // k of something else: the absorption is where n says there is none
    std::reverse(stranger.k->y.begin(), stranger.k->y.end());
    CHECK(kramers_kronig_residual(stranger) >= 0.5);

    Dataset unphysical = d;
    unphysical.k->y[3] = -1;
    CHECK(verify(unphysical).at(0).severity == Finding::Severity::error);
}

TEST_CASE("the embedded database verifies", "[materials][verify]") {
    for (const Finding& finding : verify(Database::embedded())) {
        CAPTURE(finding.dataset, finding.text);
        CHECK(finding.severity != Finding::Severity::error);
    }
}

TEST_CASE("the sample collection imports, or is refused for a reason",
          "[materials][import][samples]") {
    if (big_samples_missing()) return;
    const support::TemporaryFolder folder;
    const auto items = by_name(import_into(folder.path() / "user.sqlite", {big_samples}));
    int refused = 0;
    for (const auto& [name, item] : items) refused += !item.outcome;
    CHECK(items.size() == 32);
    CHECK(refused == 1);
    // 11 rows beyond 47 um with k down to -0.148: more than noise.
    CHECK_THAT(items.at("main_Fe2O3_nk_Querry-o.yml").reason, Catch::Contains(":622: k = -0.074"));
    CHECK_THAT(items.at("Inas.nk").corrections.at(0), Catch::Contains("read as eV"));
    CHECK_THAT(items.at("Gap100.nk").corrections.at(0), Catch::Contains("141 negative k"));
    CHECK_THAT(items.at("P_siud.nk").corrections.at(0), Catch::Contains("2 numbers after"));
    const Database database = Database::layered(folder.path() / "user.sqlite");
    // The embedded table is the collection's, to the five digits it was printed with.
    for (const char* name : {"GaP", "InAs", "TiO2", "SiO2"}) {
        const auto visible = database.refractive_index(std::string(name) + "/visible");
        std::string key = name;
        for (char& c : key) c = static_cast<char>(std::toupper(c));
        const auto original = database.refractive_index(fmt::format("{}/SOPRA-{}", name, key));
        for (int w = 450; w <= 800; w += 50) {
            CAPTURE(name, w);
            CHECK(std::abs(visible.at(w) - original.at(w)) <= 2e-3);
        }
    }
}
