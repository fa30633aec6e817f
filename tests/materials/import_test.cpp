// Files and folders into a database.
#include <miebrdf/database.h>

#include <fmt/format.h>
#include <sys/stat.h>

#include <algorithm>
#include <map>
#include <set>

#include "tests/support/catch.h"
#include "tests/support/temporary_folder.h"

using namespace miebrdf;
using namespace miebrdf::materials;

namespace {

const std::filesystem::path samples = MIEBRDF_MATERIALS_TEST_SAMPLES;
const std::filesystem::path collected = MIEBRDF_MATERIALS_DATA "/sopra";
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
    CHECK_THROWS_WITH(import_into(file, {first}, {.material = "GaP", .label = "SOPRA-GAP"}),
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

TEST_CASE("a catalogue with a key twice loses no book", "[materials][import]") {
    const support::TemporaryFolder folder;
    const std::string page =
        "DATA:\n  - type: tabulated nk\n    data: |\n      0.4 1.5 0.01\n      0.6 1.4 0.02\n";
    for (const char* book : {"XyO", "ZzO"})
        std::filesystem::create_directories(folder.path() / "data/main" / book / "nk");
    folder.write("data/main/XyO/nk/Smith.yml", page);
    folder.write("data/main/ZzO/nk/Jones.yml", page);
    folder.write("catalog-nk.yml",
                 "- SHELF: main\n  content:\n"
                 "    - BOOK: XyO\n      content:\n      content:\n        - PAGE: Smith\n"
                 "          data: main/XyO/nk/Smith.yml\n"
                 "    - BOOK: ZzO\n      content:\n        - PAGE: Jones\n"
                 "          data: main/ZzO/nk/Jones.yml\n          data: main/XyO/nk/Smith.yml\n");
    const auto items = by_name(import_into(folder.path() / "user.sqlite", {folder.path()}));
    CHECK(items.size() == 2);
    CHECK(items.at("Smith.yml").dataset == "XyO/Smith");
    CHECK_THAT(items.at("Jones.yml").reason, Catch::Contains("'data' stands twice"));
}

TEST_CASE("names from files: known spellings, new materials, names given", "[materials][import]") {
    const support::TemporaryFolder folder;
    const auto file = folder.path() / "user.sqlite";
    const std::string text = support::read_file(samples / "sopra_ev.nk");
    const auto items = by_name(
        import_into(file, {folder.write("gap100.nk", text), folder.write("NEW1.NK", text)}));
    CHECK(items.at("gap100.nk").dataset == "GaP/SOPRA-GAP100");
    CHECK(items.at("NEW1.NK").dataset == "NEW1/SOPRA-NEW1");
    const auto named =
        import_into(file, {samples / "table.csv"}, {.material = "titania", .label = "x"});
    CHECK(named.front().dataset == "TiO2/x");
    // A name goes on meaning what it meant before anything was imported.
    import_into(file, {samples / "table.csv"}, {.material = "CO"});
    CHECK(Database::layered(file).info("co").name == "Co");
    CHECK(Database::layered(file).info("CO").name == "CO");
    // SOPRA's CO_2 is cobalt, PBS lead sulphide.
    const auto listed =
        by_name(import_into(file, {folder.write("co_2.nk", text), collected / "PBS.nk"}));
    CHECK(listed.at("co_2.nk").dataset == "Co/SOPRA-CO_2");
    CHECK(listed.at("PBS.nk").dataset == "PbS/SOPRA-PBS");
}

TEST_CASE("the order of imports makes no difference", "[materials][import]") {
    const support::TemporaryFolder folder;
    const std::string sopra = support::read_file(samples / "sopra_ev.nk");
    std::filesystem::create_directories(folder.path() / "sopra");
    // Names that other collections use for something else.
    for (const char* name : {"CO_2.NK", "GAP100.NK", "HFSI2.NK", "NEW1.NK"})
        folder.write(std::string("sopra/") + name, sopra);
    for (const char* name : {"PBS.nk", "ALSB.nk"})
        std::filesystem::copy_file(collected / name, folder.path() / "sopra" / name);
    const auto page = [&](const std::string& shelf, const std::string& book) {
        const auto path = folder.path() / "rii/data" / shelf / book / "nk";
        std::filesystem::create_directories(path);
        support::write_file(path / "P.yml", support::read_file(samples / "page_nk.yml"));
        return fmt::format(
            "    - BOOK: {0}\n      name: \"{0}\"\n      content:\n"
            "        - PAGE: P\n          data: {1}/{0}/nk/P.yml\n",
            book, shelf);
    };
    std::string catalogue;
    for (const auto& [shelf, books] : std::map<std::string, std::vector<std::string>>{
             {"main", {"CO2", "Co", "AlSb", "GaP", "CO"}}, {"other", {"PBS", "glass"}}}) {
        catalogue += fmt::format("- SHELF: {}\n  content:\n", shelf);
        for (const std::string& book : books) catalogue += page(shelf, book);
    }
    catalogue += "- SHELF: 3d\n  content:\n" + page("other", "metals");
    support::write_file(folder.path() / "rii/catalog-nk.yml", catalogue);

    const std::filesystem::path collections[] = {folder.path() / "sopra", folder.path() / "rii"};
    std::set<std::string> stored[2];
    for (const int first : {0, 1}) {
        const auto file = folder.path() / fmt::format("{}.sqlite", first);
        for (const int which : {first, 1 - first}) {
            for (const ImportItem& item : import_into(file, {collections[which]})) {
                CAPTURE(item.reason);
                CHECK(item.outcome.has_value());
            }
        }
        const Database database = Database::layered(file);
        for (const MaterialInfo& m : database.list()) {
            for (const DatasetInfo& d : database.datasets(m.name)) {
                stored[first].insert(
                    fmt::format("{}/{} {} {}", d.material, d.label, m.title, d.content_sha256));
            }
        }
        CHECK(database.dataset_info("sopra:CO_2").material == "Co");
        CHECK(database.dataset_info("sopra:PBS").material == "PbS");
        CHECK(database.dataset_info("rii:other/PBS/P").material == "PBS");
        CHECK(database.dataset_info("rii:other/glass/P").material == "glass (other)");
        CHECK(database.info("glass").name == "soda_lime_glass");
        CHECK(database.datasets("AlSb").size() == 2);
        CHECK(database.info("AlSb").default_dataset == "SOPRA-ALSB");
        CHECK(database.resolve("metals").empty());
    }
    CHECK(stored[0] == stored[1]);
}

TEST_CASE("no name or key of the embedded database changes its meaning by an import",
          "[materials][import][names]") {
    const support::TemporaryFolder folder;
    const auto file = folder.path() / "user.sqlite";
    std::vector<std::filesystem::path> files;
    for (const auto& entry : std::filesystem::directory_iterator(collected)) {
        files.push_back(entry.path());
    }
    for (const ImportItem& item : import_into(file, files)) {
        CAPTURE(item.file);
        CHECK(item.outcome == AddOutcome::unchanged);
    }
    import_into(file, files, {.label = "mine"});
    const Database embedded = Database::embedded(), layered = Database::layered(file);
    for (const MaterialInfo& material : embedded.list()) {
        const DatasetInfo before = embedded.dataset_info(material.name);
        CAPTURE(material.name);
        CHECK(layered.dataset_info(material.name).label == before.label);
        if (before.source != "SOPRA") continue;
        CHECK(layered.dataset_info("sopra:" + before.key).label == before.label);
    }
}

TEST_CASE("of the datasets of a new material, the default is one that covers 550 nm",
          "[materials][import]") {
    const support::TemporaryFolder folder;
    const auto file = folder.path() / "user.sqlite";
    write_in(folder, "a.csv", "# material: Newium\nnm,n\n2000,1.5\n3000,1.6\n");
    write_in(folder, "b.csv", "# material: Newium\nnm,n\n400,1.5\n700,1.6\n");
    import_into(file, {folder.path() / "in"});
    CHECK(Database::layered(file).info("Newium").default_dataset == "csv-b");
}

TEST_CASE("pipes, devices, links and names that are no text are skipped with a line each",
          "[materials][import][errors]") {
    const support::TemporaryFolder folder;
    const auto file = folder.path() / "user.sqlite";
    write_in(folder, "good.csv", "nm,n\n400,1.5\n");
    const auto in = folder.path() / "in";
    REQUIRE(::mkfifo((in / "pipe.csv").c_str(), 0600) == 0);
    std::filesystem::create_symlink("loop.csv", in / "loop.csv");
    std::filesystem::create_symlink(folder.write("outside.csv", "nm,n\n1,2\n"), in / "out.csv");
    std::filesystem::create_symlink("good.csv", in / "same.csv");
    support::write_file(in / "caf\xe9.csv", "nm,n\n400,1.5\n");
    const auto items = by_name(import_into(file, {in}));
    CHECK(items.size() == 6);
    CHECK(items.at("good.csv").outcome == AddOutcome::added);
    CHECK(items.at("same.csv").outcome == AddOutcome::added);
    CHECK_THAT(items.at("pipe.csv").reason, Catch::Contains("no ordinary file"));
    CHECK_THAT(items.at("loop.csv").reason, Catch::Contains("leads nowhere"));
    CHECK_THAT(items.at("out.csv").reason, Catch::Contains("out of the folder"));
    CHECK_THAT(items.at("caf\\xe9.csv").reason, Catch::Contains("not UTF-8"));
    for (const char* device : {"/dev/zero", "/dev/null"}) {
        CHECK_THROWS_WITH(import_into(file, {device}), Catch::Contains("no ordinary file"));
        CHECK_THROWS_WITH(read_file(device), Catch::Contains("no ordinary file"));
    }
    CHECK_THROWS_WITH(import_into(file, {in / "caf\xe9.csv"}), Catch::Contains("not UTF-8"));
    // Words in another encoding are read as Latin-1.
    const auto latin = folder.write("latin.csv", "# note: caf\xe9\nnm,n\n400,1.5\n");
    CHECK(read_file(latin).note == "caf\xc3\xa9");
}

TEST_CASE("one bad row can be left out on request, many cannot", "[materials][import]") {
    const support::TemporaryFolder folder;
    std::string text = "wavelength_nm,n\n";
    for (int i = 0; i < 30; ++i) text += fmt::format("{},1.5\n", 400 + i);
    const auto file = folder.write("a.csv", text + "430,oops\n");
    CHECK_THROWS_WITH(read_file(file), Catch::Contains("a.csv:32: 'oops'"));
    const Dataset read = read_file(file, {.skip_bad_rows = true});
    CHECK(read.n->x.size() == 30);
    CHECK(read.corrections ==
          std::vector<std::string>{"row of line 32 left out: 'oops' is not a number"});
    const auto negative = folder.write("b.csv", text + "430,-1\n");
    CHECK(read_file(negative, {.skip_bad_rows = true}).n->x.size() == 30);
    const auto many = folder.write("c.csv", "nm,n\n400,1.5\n410,x\n420,1.5\n");
    CHECK_THROWS_WITH(read_file(many, {.skip_bad_rows = true}), Catch::Contains("c.csv:3: 'x'"));
}

TEST_CASE("bare columns are read when their unit is given", "[materials][import]") {
    const support::TemporaryFolder folder;
    const auto bare = folder.write("bare.txt", "0.4 1.5 0.1\n0.5,1.6,0.2\n");
    CHECK_THROWS_WITH(read_file(bare), Catch::Contains("not recognised"));
    const Dataset read = read_file(bare, {.unit = Unit::micrometre});
    CHECK(read.n->unit == Unit::micrometre);
    CHECK(read.n->wavelengths_nm() == std::vector<double>{400, 500});
    CHECK(read.k->y == std::vector<double>{0.1, 0.2});
    const auto nameless = folder.write("x.csv", "wavelength,n\n400,1.5\n500,1.6\n");
    CHECK_THROWS_WITH(read_file(nameless), Catch::Contains("unit of 'wavelength'"));
    CHECK(read_file(nameless, {.unit = Unit::nanometre}).n->x.front() == 400);
}

TEST_CASE("the sample collection imports, or is refused for a reason",
          "[materials][import][samples]") {
    if (big_samples_missing()) return;
    const support::TemporaryFolder folder;
    const auto items = by_name(import_into(folder.path() / "user.sqlite", {big_samples}));
    int refused = 0;
    for (const auto& [name, item] : items) refused += !item.outcome;
    CHECK(items.size() == 32);
    CHECK(refused == 2);
    CHECK_THAT(items.at("main_AgGaSe2_nk_Boyd-o.yml").reason, Catch::Contains("4 coefficients"));
    // 11 rows beyond 47 um with k down to -0.148: more than noise.
    CHECK_THAT(items.at("main_Fe2O3_nk_Querry-o.yml").reason, Catch::Contains(":622: k = -0.074"));
    CHECK_THAT(items.at("Inas.nk").corrections.at(0), Catch::Contains("read as eV"));
    CHECK_THAT(items.at("Gap100.nk").corrections.at(0), Catch::Contains("141 negative k"));
    CHECK_THAT(items.at("P_siud.nk").corrections.at(0), Catch::Contains("2 numbers after"));
    const Database database = Database::layered(folder.path() / "user.sqlite");
    // The embedded tables are the collection's own.
    for (const char* name : {"Gap.nk", "Inas.nk", "Tio2.nk", "Sio2.nk", "Algaas7.nk"})
        CHECK(items.at(name).outcome == AddOutcome::unchanged);
}
