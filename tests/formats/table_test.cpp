// csv, json, npz and exr: tables at listed directions.
#include <sys/resource.h>
#include <sys/stat.h>
#include <cmath>
#include <csignal>
#include <cstring>
#include <nlohmann/json.hpp>
#include <numbers>
#include <sstream>

#include "pipeline/formats/table/npz.h"
#include "pipeline/io/atomic_file.h"
#include "tests/support/catch.h"
#include "tests/support/child_process.h"
#include "tests/support/polarising_material.h"
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

TEST_CASE("tables hold Mueller matrices where they are known", "[formats][table][polarisation]") {
    const int components = GENERATE(3, 4);
    const support::PolarisingMaterial source({500, 600}, components, 0.5);
    const ExportOptions options{.directions = grid()};
    const auto size = static_cast<std::size_t>(components);
    const std::vector<std::size_t> shape = {2, 3, 4, 4, size, size};
    const auto arrays = read_npz_arrays(support::written_file("npz", source, options));
    REQUIRE(arrays.at("mueller").shape == shape);
    const auto json = nlohmann::json::parse(support::written_file("json", source, options));
    const std::string meta = json["metadata"]["mueller"].get<std::string>();
    CHECK_THAT(meta, Catch::Contains(components == 4 ? "(I, Q, U, V)" : "(I, Q, U)") &&
                         Catch::Contains("meridian"));
    const Direction direction{grid().mu_in[1], grid().mu_out[2], grid().azimuth_deg[1]};
    const Eigen::Matrix4d expected = source.matrix(direction, 1);
    const std::size_t place = ((1 * 3 + 1) * 4 + 2) * 4 + 1;
    for (std::size_t row = 0; row < size; ++row) {
        for (std::size_t column = 0; column < size; ++column) {
            const double value = expected(Eigen::Index(row), Eigen::Index(column));
            CHECK(arrays.at("mueller").values[(place * size + row) * size + column] == value);
            CHECK(json["mueller"][1][1][2][1][row][column] == value);
        }
    }
    // The files are tables of the BRDF all the same.
    for (const char* format : {"csv", "json", "npz", "exr"}) {
        CAPTURE(format);
        const auto file = read_brdf_file(support::written_file(format, source, options), "test");
        std::vector<double> found(2);
        file->evaluate(direction, found);
        CHECK(found[1] == Approx(expected(0, 0)).epsilon(1e-7));  // exr has 32 bits
    }
}

TEST_CASE("csv has the columns of a Mueller matrix by the names of brdf --stokes",
          "[formats][table][polarisation]") {
    const support::PolarisingMaterial source({550}, 3, 0.5);
    const Direction direction{0.5, 0.3, 45};
    const std::string csv =
        support::written_file("csv", source, {.directions = {{0.5}, {0.3}, {45}}});
    const std::size_t header = csv.find("wavelength_nm,");
    const std::size_t row = csv.find('\n', header) + 1;
    CHECK(csv.substr(header, row - 1 - header) ==
          "wavelength_nm,mu_in,mu_out,azimuth_deg,m11,m12,m13,m21,m22,m23,m31,m32,m33,dolp,"
          "aolp_deg");
    const Eigen::Matrix4d M = source.matrix(direction, 0);
    const double angle = std::atan2(M(2, 0), M(1, 0)) * 90 / std::numbers::pi;
    const std::string text = csv.substr(row);
    std::vector<double> numbers;
    std::stringstream words(text);
    for (std::string word; std::getline(words, word, ',');) numbers.push_back(std::stod(word));
    REQUIRE(numbers.size() == 15);
    CHECK(numbers[4] == M(0, 0));
    CHECK(numbers[5] == M(0, 1));
    CHECK(numbers[10] == M(2, 0));
    CHECK(numbers[13] == Approx(std::hypot(M(1, 0), M(2, 0)) / M(0, 0)).epsilon(1e-14));
    CHECK(numbers[14] == Approx(angle < 0 ? angle + 180 : angle).epsilon(1e-12));
}

TEST_CASE("exr has a channel for each element of a Mueller matrix",
          "[formats][table][polarisation]") {
    const support::PolarisingMaterial source({550}, 3, 0.5);
    const std::string exr = support::written_file("exr", source, {.directions = grid()});
    for (const char* channel : {"T.550,000000nm", "M12.550,000000nm", "M33.550,000000nm"})
        CHECK(exr.find(channel) != exr.npos);
}
