// Every format through a reader that owes nothing to this project, against the BRDF itself at
// random directions. Bounds are twice what a correct writer of the format reached on this material.
#include <cmath>
#include <limits>
#include <random>
#include <sstream>

#include "pipeline/formats/astm_writer.h"
#include "pipeline/formats/deviation.h"
#include "pipeline/formats/exr_writer.h"
#include "pipeline/formats/klems_writer.h"
#include "pipeline/formats/merl_writer.h"
#include "pipeline/formats/pbrt_writer.h"
#include "pipeline/formats/rgl_writer.h"
#include "pipeline/formats/ssdd_writer.h"
#include "pipeline/formats/table_writer.h"
#include "pipeline/formats/tensor_tree_writer.h"
#include "pipeline/solve/solved_source.h"
#include "tests/support/catch.h"
#include "tests/support/outside/outside_file.h"
#include "tests/support/sampling.h"
#include "tests/support/temporary_folder.h"
#include "tests/support/test_material.h"

using namespace miebrdf;
using namespace miebrdf::exports;
using support::material;

namespace {

constexpr double kAny = std::numeric_limits<double>::max();

/// The same kind of half-space, solved.
const BrdfSource& solved() {
    static const SolvedSource instance(
        [] {
            Request request;
            request.scene.base = HenyeyGreensteinMedium{0.9, 0.4};
            request.wavelength_nm = {480, 535, 620};
            return request;
        }(),
        Component::total, "", {});
    return instance;
}

struct Format {
    const char* name;
    bool spectral;
    std::array<double, 3> bounds;  ///< rms at mu > 0.2, 0.05-0.2, below 0.05
    void (*write)(const BrdfSource& spectral, const RgbSource& rgb, std::ostream& out);
    std::unique_ptr<support::OutsideFile> (*open)(const std::string& bytes);
};

const Format kFormats[] = {
    {"pbrt, 34 nodes",
     false,
     {1.0e-3, 2.2e-3, 2.2e-2},
     [](const auto&, const auto& rgb, auto& out) { write_pbrt(rgb, {.intervals = 16}, out); },
     support::scatfun_file},
    {"pbrt, 98 nodes",
     false,
     {1.04e-4, 1.68e-4, 1.74e-3},
     [](const auto&, const auto& rgb, auto& out) { write_pbrt(rgb, {.intervals = 48}, out); },
     support::scatfun_file},
    {"rgl spectral, 16",
     true,
     {7.4e-2, 0.30, 2.4},
     [](const auto& f, const auto&, auto& out) { write_rgl_spectral(f, {.resolution = 16}, out); },
     support::tensor_bsdf_file},
    {"rgl spectral, 32",
     true,
     {1.68e-2, 9.8e-2, 1.12},
     [](const auto& f, const auto&, auto& out) { write_rgl_spectral(f, {.resolution = 32}, out); },
     support::tensor_bsdf_file},
    {"rgl spectral, 64",
     true,
     {4.4e-3, 3.2e-2, 0.52},
     [](const auto& f, const auto&, auto& out) { write_rgl_spectral(f, {}, out); },
     support::tensor_bsdf_file},
    {"rgl RGB, 64",
     false,
     {4.4e-3, 3.2e-2, 0.52},
     [](const auto&, const auto& rgb, auto& out) { write_rgl_rgb(rgb, {}, out); },
     support::tensor_bsdf_file},
    {"merl",
     false,
     {6.2e-4, kAny, kAny},
     [](const auto&, const auto& rgb, auto& out) { write_merl(rgb, {}, out); },
     support::merl_file},
    {"ssdd, 5 x 5 x 10 degrees",
     true,
     {5.6e-3, kAny, kAny},
     [](const auto& f, const auto&, auto& out) { write_ssdd(f, 18, out); },
     support::ssdd_file},
    {"astm, 10 x 10 x 20 degrees",
     true,
     {2.6e-2, kAny, kAny},
     [](const auto& f, const auto&, auto& out) { write_astm(f, 9, out); },
     support::astm_file},
    {"klems",
     false,
     {0.158, kAny, kAny},
     [](const auto&, const auto& rgb, auto& out) { write_radiance_klems(rgb, out); },
     support::klems_file},
    {"radiance, 16 cells",
     false,
     {0.188, kAny, kAny},
     [](const auto&, const auto& rgb, auto& out) { write_radiance_tree(rgb, 4, out); },
     support::tensor_tree_file},
    {"radiance, 32 cells",
     false,
     {0.132, kAny, kAny},
     [](const auto&, const auto& rgb, auto& out) { write_radiance_tree(rgb, 5, out); },
     support::tensor_tree_file},
    {"radiance, 64 cells",
     false,
     {0.074, kAny, kAny},
     [](const auto&, const auto& rgb, auto& out) { write_radiance_tree(rgb, 6, out); },
     support::tensor_tree_file},
};

struct Written {
    RgbSource rgb;
    std::string bytes;
    const BrdfSource& truth;

    Written(const Format& format, const BrdfSource& spectral)
        : rgb(spectral, nearest_wavelengths(spectral.wavelength_nm())),
          truth(format.spectral ? spectral : static_cast<const BrdfSource&>(rgb)) {
        std::ostringstream out;
        format.write(spectral, rgb, out);
        bytes = out.str();
    }
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
          "[exports][read_back]") {
    const Format& format = GENERATE(from_range(std::begin(kFormats), std::end(kFormats)));
    const bool closed_form = GENERATE(true, false);
    const Written written(format, closed_form ? material() : solved());
    const auto errors = relative_errors(*format.open(written.bytes), written.truth);
    CAPTURE(format.name, closed_form, written.bytes.size(), errors);
    // The bounds are of the closed form; the solved half-space is a little brighter at the horizon.
    const double room = closed_form ? 1.0 : 1.1;
    for (std::size_t band = 0; band < 3; ++band) CHECK(errors[band] <= room * format.bounds[band]);
}

TEST_CASE("bin centres serve readers of MERL that do not interpolate", "[exports][read_back]") {
    const RgbSource rgb(material(), nearest_wavelengths(material().wavelength_nm()));
    std::ostringstream edges, centres;
    write_merl(rgb, {MerlSample::lower_edge}, edges);
    write_merl(rgb, {MerlSample::centre}, centres);
    const auto from_edges = relative_errors(*support::merl_bins_file(edges.str()), rgb);
    const auto from_centres = relative_errors(*support::merl_bins_file(centres.str()), rgb);
    CAPTURE(from_edges, from_centres);
    // A value uniform in its bin is on average half as far (rms) from the centre as from the edge.
    CHECK(from_centres[0] <= 0.6 * from_edges[0]);
}

TEST_CASE("npz and exr hold the axes and values that other readers find", "[exports][read_back]") {
    const TableGrid grid{{0.125, 0.5, 1.0}, {0.25, 0.75, 1.0}, {0, 45, 90, 135, 180}};
    const support::TemporaryFolder folder;
    write_table_npz(material(), grid, folder / "a.npz");
    check_table(support::npz_table(support::read_file(folder / "a.npz")), material(), 0.0);
    std::ostringstream exr;
    write_exr(material(), nearest_wavelengths(material().wavelength_nm()), grid, exr);
    check_table(support::exr_table(exr.str()), material(), 6e-8);
}

TEST_CASE("sampled with the stored tables, the albedo is complete and the density true",
          "[exports][read_back]") {
    // Albedo within what sampling reached: 0.1 % with Fourier files, 0.5 % with tensor files (1.7 %
    // in one number, 2.3 % at the worst incidence, at N = 16).
    const auto [index, bound] =
        GENERATE(std::pair{0, 1e-3}, std::pair{1, 1e-3}, std::pair{2, 2.3e-2}, std::pair{3, 5e-3},
                 std::pair{4, 5e-3}, std::pair{5, 5e-3});
    const bool closed_form = GENERATE(true, false);
    const Format& format = kFormats[index];
    const Written written(format, closed_form ? material() : solved());
    const auto file = format.open(written.bytes);
    for (const double mu : {0.1, 0.15, 0.2, 0.3, 0.5, 0.7, 0.9, 1.0}) {
        const support::Sampling sampling = support::sampling_of(*file, mu);
        const auto sampled = support::sampled_albedo(sampling, 10000);
        const auto expected = support::integrated_albedo(written.truth, mu);
        CAPTURE(format.name, closed_form, mu, sampled, expected);
        for (std::size_t c = 0; c < expected.size(); ++c)
            CHECK(std::abs(sampled[c] / expected[c] - 1) <= bound);
        if (mu == 0.1 || mu == 0.3 || mu == 0.9) {
            CHECK(support::chi_square_probability(sampling, 20000) >= 1e-3);
        }
    }
}

TEST_CASE("the sampling that `check` judges by carries the albedo and draws by its density",
          "[exports][read_back]") {
    const Format& format = kFormats[GENERATE(0, 3)];
    const Written written(format, material());
    const auto file = read_brdf_file(written.bytes, format.name);
    for (const double mu : {0.3, 0.9}) {
        const support::Sampling sampling = support::sampling_of(*file, mu);
        const auto sampled = support::sampled_albedo(sampling, 4000);
        const auto expected = support::integrated_albedo(written.truth, mu);
        CAPTURE(format.name, mu, sampled, expected);
        for (std::size_t c = 0; c < expected.size(); ++c)
            CHECK(std::abs(sampled[c] / expected[c] - 1) <= 1e-2);
        CHECK(support::chi_square_probability(sampling, 20000) >= 1e-3);
    }
}

TEST_CASE("the readers of `check` see what the other readers see", "[exports][read_back]") {
    const Format& format = GENERATE(from_range(std::begin(kFormats), std::end(kFormats)));
    const Written written(format, material());
    const auto other = format.open(written.bytes);
    const auto ours = read_brdf_file(written.bytes, format.name);
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
    CAPTURE(format.name);
    CHECK(largest <= 1e-6);
}
