// Every format through a reader that owes nothing to this project, against the BRDF itself at
// random directions. Bounds are twice what a correct writer of the format reached on this material.
#include <miebrdf/brdf.h>

#include <cmath>
#include <limits>
#include <random>

#include "pipeline/formats/check/check.h"
#include "tests/support/catch.h"
#include "tests/support/outside/outside_file.h"
#include "tests/support/sampling.h"
#include "tests/support/test_material.h"
#include "tests/support/written_file.h"

using namespace miebrdf;
using support::material;

namespace {

constexpr double kAny = std::numeric_limits<double>::max();

/// A half-space of that kind, solved.
const BrdfSource& solved() {
    static const BrdfTable instance =
        miebrdf::solve({.base = miebrdf::medium("hg:0.9,0.4")}, {480, 535, 620}).table();
    return instance;
}

/// A format at some fineness, and a reader of it that is not ours.
struct Case {
    const char* name;
    const char* format;
    bool spectral;
    std::array<double, 3> bounds;  ///< rms at mu > 0.2, 0.05-0.2, below 0.05
    ExportOptions options;
    std::size_t part;  ///< which of the files that the format writes
    std::unique_ptr<support::OutsideFile> (*open)(const std::string& bytes);
};

const Case kCases[] = {
    {"pbrt, 34 nodes",
     "pbrt",
     false,
     {1.0e-3, 2.2e-3, 2.2e-2},
     {.resolution = 16},
     0,
     support::scatfun_file},
    {"pbrt, 98 nodes",
     "pbrt",
     false,
     {1.04e-4, 1.68e-4, 1.74e-3},
     {.resolution = 48},
     0,
     support::scatfun_file},
    {"rgl spectral, 16",
     "rgl",
     true,
     {7.4e-2, 0.30, 2.4},
     {.resolution = 16},
     0,
     support::tensor_bsdf_file},
    {"rgl spectral, 32",
     "rgl",
     true,
     {1.68e-2, 9.8e-2, 1.12},
     {.resolution = 32},
     0,
     support::tensor_bsdf_file},
    {"rgl spectral, 64", "rgl", true, {4.4e-3, 3.2e-2, 0.52}, {}, 0, support::tensor_bsdf_file},
    {"rgl RGB, 64", "rgl", false, {4.4e-3, 3.2e-2, 0.52}, {}, 1, support::tensor_bsdf_file},
    {"merl", "merl", false, {6.2e-4, kAny, kAny}, {}, 0, support::merl_file},
    {"ssdd, 5 x 5 x 10 degrees", "ssdd", true, {5.6e-3, kAny, kAny}, {}, 0, support::ssdd_file},
    {"astm, 10 x 10 x 20 degrees", "astm", true, {2.6e-2, kAny, kAny}, {}, 0, support::astm_file},
    {"klems", "klems", false, {0.158, kAny, kAny}, {}, 0, support::klems_file},
    {"radiance, 16 cells",
     "radiance",
     false,
     {0.188, kAny, kAny},
     {.resolution = 4},
     0,
     support::tensor_tree_file},
    {"radiance, 64 cells",
     "radiance",
     false,
     {0.074, kAny, kAny},
     {.resolution = 6},
     0,
     support::tensor_tree_file},
};

struct Written {
    RgbSource rgb;
    std::string bytes;
    const BrdfSource& truth;

    Written(const Case& one, const BrdfSource& spectral)
        : rgb(spectral, nearest_wavelengths(spectral.wavelength_nm())),
          bytes(support::written_file(one.format, spectral, one.options, one.part)),
          truth(one.spectral ? spectral : static_cast<const BrdfSource&>(rgb)) {}
};

/// Both directions uniform over the hemisphere, down to 17 arc minutes above the horizon: nearer, a
/// format that stores BRDF times cosine has no bound.
std::vector<Direction> hemisphere_pairs(int count) {
    std::mt19937_64 engine(7);
    const auto uniform = [&] { return (static_cast<double>(engine() >> 12) + 0.5) * 0x1p-52; };
    const auto cosine = [&] { return 0.005 + 0.995 * uniform(); };
    std::vector<Direction> pairs;
    for (int i = 0; i < count; ++i) {
        const double mu_in = cosine(), mu_out = cosine();
        pairs.push_back({mu_in, mu_out, 360 * uniform()});
    }
    return pairs;
}

std::array<double, 3> relative_errors(const support::OutsideFile& file, const BrdfSource& truth) {
    std::array<double, 3> sums{}, counts{};
    std::vector<double> expected(truth.channels().size());
    for (const Direction& d : hemisphere_pairs(6000)) {
        truth.evaluate({&d, 1}, expected);
        const auto found = file.brdf(support::to_light(d), support::to_viewer(d));
        REQUIRE(found.size() == expected.size());
        const double least = std::min(d.mu_in, d.mu_out);
        const std::size_t band = least > 0.2 ? 0 : least > 0.05 ? 1 : 2;
        for (std::size_t c = 0; c < found.size(); ++c)
            sums[band] += std::pow(found[c] / expected[c] - 1, 2);
        counts[band] += static_cast<double>(found.size());
    }
    for (std::size_t b = 0; b < 3; ++b) sums[b] = std::sqrt(sums[b] / counts[b]);
    return sums;
}

/// Every value of the table, at its own directions, to a relative rounding error.
void check_table(const support::OutsideTable& table, const BrdfSource& source, double rounding) {
    CHECK(table.wavelength_nm == source.wavelength_nm());
    const std::size_t waves = table.wavelength_nm.size();
    const std::size_t plane = table.mu_in.size() * table.mu_out.size() * table.azimuth_deg.size();
    REQUIRE(table.values.size() == waves * plane);
    std::vector<double> expected(waves);
    std::size_t index = 0;
    double largest = 0;
    for (const double mu_in : table.mu_in) {
        for (const double mu_out : table.mu_out) {
            for (const double azimuth : table.azimuth_deg) {
                const Direction direction{mu_in, mu_out, azimuth};
                source.evaluate({&direction, 1}, expected);
                for (std::size_t w = 0; w < waves; ++w) {
                    const double ratio = table.values[w * plane + index] / expected[w];
                    largest = std::max(largest, std::abs(ratio - 1));
                }
                ++index;
            }
        }
    }
    CHECK(largest <= rounding);
}

}  // namespace

TEST_CASE("formats read back as their programs do, within the errors of docs/formats",
          "[formats][read_back]") {
    const Case& one = GENERATE(from_range(std::begin(kCases), std::end(kCases)));
    const bool closed_form = GENERATE(true, false);
    const Written written(one, closed_form ? material() : solved());
    const auto errors = relative_errors(*one.open(written.bytes), written.truth);
    CAPTURE(one.name, closed_form, written.bytes.size(), errors);
    // The bounds are of the closed form; the solved half-space is a little brighter at the horizon.
    const double room = closed_form ? 1.0 : 1.1;
    for (std::size_t band = 0; band < 3; ++band) CHECK(errors[band] <= room * one.bounds[band]);
}

TEST_CASE("bin centres serve readers of MERL that do not interpolate", "[formats][read_back]") {
    const RgbSource rgb(material(), nearest_wavelengths(material().wavelength_nm()));
    const std::string edges = support::written_file("merl", material());
    const std::string centres =
        support::written_file("merl", material(), {.extra = {{"bin_centres", 1}}});
    const auto from_edges = relative_errors(*support::merl_bins_file(edges), rgb);
    const auto from_centres = relative_errors(*support::merl_bins_file(centres), rgb);
    CAPTURE(from_edges, from_centres);
    // A value uniform in its bin is on average half as far (rms) from the centre as from the edge.
    CHECK(from_centres[0] <= 0.6 * from_edges[0]);
}

TEST_CASE("npz and exr hold the axes and values that other readers find", "[formats][read_back]") {
    const ExportOptions options{
        .directions = {{0.125, 0.5, 1.0}, {0.25, 0.75, 1.0}, {0, 45, 90, 135, 180}}};
    check_table(support::npz_table(support::written_file("npz", material(), options)), material(),
                0.0);
    check_table(support::exr_table(support::written_file("exr", material(), options)), material(),
                6e-8);
}

TEST_CASE("sampled with the stored tables, the albedo is complete and the density true",
          "[formats][read_back]") {
    // Albedo within what sampling reached: 0.1 % with Fourier files, 0.5 % with tensor files (1.7 %
    // in one number, 2.3 % at the worst incidence, at N = 16).
    const auto [index, bound] =
        GENERATE(std::pair{0, 1e-3}, std::pair{1, 1e-3}, std::pair{2, 2.3e-2}, std::pair{3, 5e-3},
                 std::pair{4, 5e-3}, std::pair{5, 5e-3});
    const bool closed_form = GENERATE(true, false);
    const Case& one = kCases[index];
    const Written written(one, closed_form ? material() : solved());
    const auto file = one.open(written.bytes);
    for (const double mu : {0.1, 0.15, 0.2, 0.3, 0.5, 0.7, 0.9, 1.0}) {
        const support::Sampling sampling = support::sampling_of(*file, mu);
        const auto sampled = support::sampled_albedo(sampling, 10000);
        const auto expected = support::integrated_albedo(written.truth, mu);
        CAPTURE(one.name, closed_form, mu, sampled, expected);
        for (std::size_t c = 0; c < expected.size(); ++c)
            CHECK(std::abs(sampled[c] / expected[c] - 1) <= bound);
        if (mu == 0.1 || mu == 0.3 || mu == 0.9) {
            CHECK(support::chi_square_probability(sampling, 20000) >= 1e-3);
        }
    }
}

TEST_CASE("the sampling that `check` judges by carries the albedo and draws by its density",
          "[formats][read_back]") {
    const Case& one = kCases[GENERATE(0, 3)];
    const Written written(one, material());
    const auto file = read_brdf_file(written.bytes, one.name);
    for (const double mu : {0.3, 0.9}) {
        const support::Sampling sampling = support::sampling_of(*file, mu);
        const auto sampled = support::sampled_albedo(sampling, 4000);
        const auto expected = support::integrated_albedo(written.truth, mu);
        CAPTURE(one.name, mu, sampled, expected);
        for (std::size_t c = 0; c < expected.size(); ++c)
            CHECK(std::abs(sampled[c] / expected[c] - 1) <= 1e-2);
        CHECK(support::chi_square_probability(sampling, 20000) >= 1e-3);
    }
}

TEST_CASE("the readers of `check` see what the other readers see", "[formats][read_back]") {
    const Case& one = GENERATE(from_range(std::begin(kCases), std::end(kCases)));
    const Written written(one, material());
    const auto other = one.open(written.bytes);
    const auto ours = read_brdf_file(written.bytes, one.name);
    std::vector<double> found(ours->channels().size());
    double largest = 0;
    std::vector<Direction> directions = random_directions(600, 8);
    directions.push_back({1.0, 0.7, 0.0});  // at the edge of every table
    directions.push_back({0.7, 1.0, 0.0});
    for (const Direction& d : directions) {
        ours->evaluate(d, found);
        const auto expected = other->brdf(support::to_light(d), support::to_viewer(d));
        // On the edge of a cell, a rounding error decides which cell it is; no such direction here.
        for (std::size_t c = 0; c < found.size(); ++c)
            largest = std::max(largest, std::abs(found[c] / expected[c] - 1));
    }
    CAPTURE(one.name);
    CHECK(largest <= 1e-6);
}
