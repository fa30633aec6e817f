// Datasets as files of every format, and back.
#include <miebrdf/database.h>

#include <cmath>
#include <string>
#include <vector>

#include "materials/index/checksum.h"
#include "tests/support/catch.h"
#include "tests/support/temporary_folder.h"

using namespace miebrdf;
using namespace miebrdf::materials;

namespace {

const std::filesystem::path sample_files = MIEBRDF_MATERIALS_TEST_SAMPLES;

}  // namespace

TEST_CASE("every format that takes a dataset gives it back", "[materials][export]") {
    for (const char* name :
         {"sopra_ev.nk", "sopra_commas.NK", "tfcalc.MAT", "page_nk.yml", "page_formula.yml",
          "table.csv", "two_parts.csv", "energy.csv", "imd.nk", "pair.eta.spd"}) {
        const support::TemporaryFolder folder;
        Dataset original = read_file(sample_files / name);
        original.density_g_cm3 = 4.23;
        original.density_source = "a handbook";
        original.licence = "CC0-1.0";
        original.reference = "A. Author, J. Opt. 1, 1 (2001)";
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
            if (format != "sopra") {
                CHECK(back.reference == original.reference);
                CHECK(back.licence == original.licence);
                CHECK(back.note == original.note);
                CHECK(back.ray == original.ray);
                CHECK(back.temperature_k == original.temperature_k);
                CHECK(back.density_g_cm3 == 4.23);
                CHECK(back.density_source == "a handbook");
                CHECK(back.corrections == original.corrections);
            }
        }
    }
}

TEST_CASE("exports refuse what the format cannot say", "[materials][export][errors]") {
    const auto refusal = [](const char* name, const char* format) {
        return [=] { export_dataset(read_file(sample_files / name), format); };
    };
    CHECK_THROWS_WITH(refusal("page_formula.yml", "csv")(), Catch::Contains("formula"));
    CHECK_THROWS_WITH(refusal("two_parts.csv", "tfcalc")(), Catch::Contains("different grids"));
    CHECK_THROWS_WITH(refusal("imd.nk", "sopra")(), Catch::Contains("no unit angstrom"));
    Dataset uneven = read_file(sample_files / "sopra_nm.nk");
    for (Series* series : {&*uneven.n, &*uneven.k}) series->x[1] *= 1 + 1e-13;
    CHECK_THROWS_WITH(export_dataset(uneven, "sopra"), Catch::Contains("not uniform"));
    Dataset d = read_file(sample_files / "table.csv");
    d.k.reset();
    CHECK_THROWS_WITH(export_dataset(d, "tfcalc"), Catch::Contains("k is unknown"));
    const auto as_zero = export_dataset(d, "tfcalc", {.unknown_k_as_zero = true});
    CHECK_THAT(as_zero.front().text, Catch::Contains("DATA1*1*400*1.5*0*"));
}
