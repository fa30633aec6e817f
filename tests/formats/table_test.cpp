// csv, json, npz and exr: tables at listed directions.
#include <sys/resource.h>
#include <sys/stat.h>
#include <cmath>
#include <csignal>
#include <cstring>

#include "pipeline/formats/table/npz.h"
#include "pipeline/io/atomic_file.h"
#include "tests/support/catch.h"
#include "tests/support/child_process.h"
#include "tests/support/temporary_folder.h"
#include "tests/support/test_material.h"
#include "tests/support/written_file.h"

using namespace miebrdf;
using support::material;

namespace {

const rte::Directions& grid() {
    static const rte::Directions instance{{0.1, 0.5, 1.0}, {0.05, 0.3, 0.6, 1.0}, {0, 45, 90, 180}};
    return instance;
}

void write_npz(const std::filesystem::path& path) {
    export_brdf(material(), "npz", path, {.directions = grid()});
}

/// The file's values at the table's own directions are those of the BRDF, bit for bit.
void check_exact(const BrdfFile& file) {
    CHECK(file.wavelength_nm() == support::seven_wavelengths());
    std::vector<double> expected(7), found(7);
    for (const double mu_in : grid().mu_in) {
        for (const double mu_out : grid().mu_out) {
            for (const double azimuth : grid().azimuth_deg) {
                const Direction direction{mu_in, mu_out, azimuth};
                material().evaluate({&direction, 1}, expected);
                file.evaluate(direction, found);
                CHECK(found == expected);
            }
        }
    }
}

}  // namespace

TEST_CASE("csv and json tables read back to the same doubles", "[formats][table]") {
    const ExportOptions options{.directions = grid()};
    const std::string csv = support::written_file("csv", material(), options);
    const std::string json = support::written_file("json", material(), options);
    const auto from_csv = read_brdf_file(csv, "test");
    CHECK(from_csv->format() == "csv");
    check_exact(*from_csv);
    const auto from_json = read_brdf_file(json, "test");
    CHECK(from_json->format() == "json");
    check_exact(*from_json);
}

TEST_CASE("npz holds the axes by name, the same doubles, and the same bytes each time",
          "[formats][table]") {
    const support::TemporaryFolder folder;
    write_npz(folder / "a.npz");
    write_npz(folder / "b.npz");
    const std::string content = support::read_file(folder / "a.npz");
    CHECK(content == support::read_file(folder / "b.npz"));
    CHECK(folder.count() == 2);
    const auto arrays = read_npz_arrays(content);
    CHECK(arrays.at("brdf").shape == std::vector<std::size_t>{7, 3, 4, 4});
    CHECK(arrays.at("mu_out").values == grid().mu_out);
    CHECK(arrays.at("meta").is_bytes);
    check_exact(*read_brdf_file(content, "test"));
}

TEST_CASE("npz members are aligned .npy 1.0 arrays, stored", "[formats][table]") {
    const support::TemporaryFolder folder;
    write_npz(folder / "a.npz");
    const std::string content = support::read_file(folder / "a.npz");
    const std::size_t first = content.find("\x93NUMPY");
    REQUIRE(first != content.npos);
    CHECK(content[first + 6] == 1);
    const std::size_t length = static_cast<unsigned char>(content[first + 8]) +
                               256u * static_cast<unsigned char>(content[first + 9]);
    CHECK((10 + length) % 64 == 0);
    CHECK(content[first + 10 + length - 1] == '\n');
    CHECK_THAT(content.substr(first + 10, length),
               Catch::Contains("'descr': '<f8'") && Catch::Contains("'shape': (7,)"));
    double value = 0;
    std::memcpy(&value, content.data() + first + 10 + length, 8);
    CHECK(value == 400.0);
}

TEST_CASE("a signal in the midst of writing npz leaves nothing behind", "[formats][table]") {
    // A limit on the size of files raises SIGXFSZ at a known byte of the archive.
    const support::TemporaryFolder folder;
    const rlim_t limit = GENERATE(rlim_t(0), rlim_t(100), rlim_t(4000));
    const pid_t child = support::in_child(
        [&] {
            std::signal(SIGXFSZ, [](int) {
                remove_unfinished_files();
                _exit(7);
            });
            const rlimit bytes{limit, limit};
            setrlimit(RLIMIT_FSIZE, &bytes);
            write_npz(folder / "a.npz");
        },
        [](const std::exception&) { return 8; });
    CHECK(support::exit_code(child) == 7);
    CHECK(folder.count() == 0);
}

TEST_CASE("npz goes through pipes and devices too", "[formats][table]") {
    const support::TemporaryFolder folder;
    write_npz(folder / "a.npz");
    REQUIRE(mkfifo((folder / "pipe").c_str(), 0600) == 0);
    const pid_t child = support::in_child([&] { write_npz(folder / "pipe"); },
                                          [](const std::exception&) { return 8; });
    CHECK(support::read_file(folder / "pipe") == support::read_file(folder / "a.npz"));
    CHECK(support::exit_code(child) == 0);
    CHECK_NOTHROW(write_npz("/dev/null"));
    CHECK_THROWS_AS(write_npz("/dev/full"), InputError);
}

TEST_CASE("npz that does not fit on the disk is refused and leaves nothing behind",
          "[formats][table][errors]") {
    const support::TemporaryFolder folder;
    const pid_t child = support::in_child(
        [&] {
            std::signal(SIGXFSZ, SIG_IGN);
            const rlimit bytes{4000, 4000};
            setrlimit(RLIMIT_FSIZE, &bytes);
            write_npz(folder / "a.npz");
        },
        [](const std::exception& error) {
            const bool told = std::string(error.what()).find("File too large") != std::string::npos;
            return dynamic_cast<const InputError*>(&error) != nullptr && told ? 8 : 9;
        });
    CHECK(support::exit_code(child) == 8);
    CHECK(folder.count() == 0);
}

TEST_CASE("tables refuse directions out of range and unwritable places",
          "[formats][table][errors]") {
    const ExportOptions horizon{.directions = {{0.0}, {1.0}, {0}}};
    CHECK_THROWS_WITH(support::written_file("csv", material(), horizon),
                      Catch::Contains("mu_in: 0") && Catch::Contains("(0, 1]"));
    CHECK_THROWS_AS(write_npz("/nowhere/at/all.npz"), InputError);
}

TEST_CASE("exr: channels carry the names of the spectral layout and the values as floats",
          "[formats][exr]") {
    const support::TestMaterial material(support::seven_wavelengths(), 0.4);
    const rte::Directions grid{{0.25, 0.5, 1.0}, {0.125, 0.5, 1.0}, {0, 45, 90, 180}};
    const std::string content = support::written_file("exr", material, {.directions = grid});
    for (const char* text :
         {"T.550,000000nm", "T.400,000000nm", "spectralLayoutVersion", "mu_in", "azimuth_deg"}) {
        CHECK_THAT(content, Catch::Contains(text));
    }
    const auto read = read_brdf_file(content, "test");
    CHECK(read->format() == "exr");
    CHECK(read->wavelength_nm() == material.wavelength_nm());
    std::vector<double> expected(7), found(7);
    for (const double mu_in : grid.mu_in) {
        for (const double mu_out : grid.mu_out) {
            for (const double azimuth : grid.azimuth_deg) {
                const Direction direction{mu_in, mu_out, azimuth};
                material.evaluate({&direction, 1}, expected);
                read->evaluate(direction, found);
                // Single precision: half a unit in the last place.
                for (std::size_t c = 0; c < 7; ++c)
                    CHECK(std::abs(found[c] / expected[c] - 1) <= 6e-8);
            }
        }
    }
}

TEST_CASE("exr: an attribute that claims more than the file has is refused before it is allocated",
          "[formats][exr]") {
    using namespace std::string_literals;
    const std::string start = "\x76\x2f\x31\x01\x02\0\0\0"s;
    const std::string huge = start + "mu_in\0floatvector\0\xf0\xff\xff\x7f"s + "few bytes";
    CHECK_THROWS_WITH(read_brdf_file(huge, "test"),
                      Catch::Contains("'mu_in' claims 2147483632 bytes of the 9"));
    const std::string window =
        start + "dataWindow\0box2i\0\x10\0\0\0\0\0\0\0\0\0\0\0\xff\xff\0\0\xff\xff\x0f\0\0"s;
    CHECK_THROWS_WITH(read_brdf_file(window, "test"),
                      Catch::Contains("a window of 65536 x 1048576 pixels"));
    CHECK_THROWS_WITH(read_brdf_file(start + "mu_in", "test"),
                      Catch::Contains("header ends early"));
    CHECK_THROWS_WITH(read_brdf_file("\x76\x2f\x31\x01\x02\x10\0\0"s, "test"),
                      Catch::Contains("one flat part"));
}
