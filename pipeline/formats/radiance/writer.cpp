// radiance and klems: Radiance's BSDF XML, as a tensor tree and as a matrix of patches.
// docs/formats/radiance.md
#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <map>
#include <nlohmann/json.hpp>
#include <numbers>
#include <ostream>
#include <tuple>

#include "pipeline/formats/common/export_job.h"
#include "pipeline/io/markup.h"
#include "pipeline/solve/vector_pairs.h"

namespace miebrdf {

FormatReader radiance_reader();  // reader.cpp, of both kinds

namespace {

/// Linear sRGB to CIE XYZ (IEC 61966-2-1).
constexpr double kXyz[3][3] = {
    {0.4124, 0.3576, 0.1805}, {0.2126, 0.7152, 0.0722}, {0.0193, 0.1192, 0.9505}};

/// None below zero.
std::array<double, 3> xyz_of(const double* rgb) {
    std::array<double, 3> xyz{};
    for (std::size_t i = 0; i < 3; ++i) {
        for (std::size_t c = 0; c < 3; ++c) xyz[i] += kXyz[i][c] * rgb[c];
        xyz[i] = std::max(xyz[i], 0.0);
    }
    return xyz;
}

/// From the first line to the definition of directions, with the metadata as a comment.
void write_radiance_head(const RgbSource& source, const std::string& definition,
                         std::ostream& out) {
    const auto description = metadata(source, {.format = "radiance",
                                               .cosine_included = false,
                                               .azimuth_zero = "mirror side",
                                               .colour = source.weights().description});
    out << "<?xml version=\"1.0\" encoding=\"UTF-8\"?>\n<!--\n"
        << in_xml_comment(description.dump(1)) << "\n-->\n";
    out << "<WindowElement xmlns=\"http://windows.lbl.gov\" "
           "xmlns:xsi=\"http://www.w3.org/2001/XMLSchema-instance\" "
           "xsi:schemaLocation=\"http://windows.lbl.gov/BSDF-v1.4.xsd\">\n"
           "<WindowElementType>System</WindowElementType>\n<FileType>BSDF</"
           "FileType>\n<Optical>\n<Layer>\n<Material>\n";
    out << "<Name>" << escape_markup(source.provenance().title) << "</Name>\n<Manufacturer>"
        << escape_markup(source.provenance().version)
        << "</Manufacturer>\n<DeviceType>Other</DeviceType>\n</Material>\n";
    out << definition;
}

/// One WavelengthData element.
struct RadianceBand {
    const char* wavelength;
    const char* detector;
    std::vector<float> values;  ///< of a tree the first half; the rest is zero
};

/// @param basis  elements that name the angle basis
/// @param row    values of a line of a matrix; 0: a tensor tree
void write_radiance_band(const RadianceBand& band, const std::string& basis, std::size_t row,
                         std::ostream& out) {
    // The names are those of a window seen from inside: what Radiance calls the front is its back.
    out << "<WavelengthData>\n<LayerNumber>System</LayerNumber>\n<Wavelength unit=\"Integral\">"
        << band.wavelength
        << "</Wavelength>\n<SourceSpectrum>CIE Illuminant D65 "
           "1nm.ssp</SourceSpectrum>\n<DetectorSpectrum>"
        << band.detector
        << "</DetectorSpectrum>\n<WavelengthDataBlock>\n<WavelengthDataDirection>Reflection "
           "Back</WavelengthDataDirection>\n"
        << basis << "<ScatteringDataType>BRDF</ScatteringDataType>\n<ScatteringData>\n";
    out << (row == 0 ? "{\n" : "");
    const std::size_t line = row == 0 ? 8 : row;
    for (std::size_t i = 0; i < band.values.size(); i += line) {
        const auto first = band.values.begin() + static_cast<std::ptrdiff_t>(i);
        const auto last = band.values.begin() +
                          static_cast<std::ptrdiff_t>(std::min(i + line, band.values.size()));
        out << fmt::format("{:.7g}\n", fmt::join(first, last, row == 0 ? " " : ",\t"));
    }
    if (row == 0) {
        for (std::size_t i = 0; i < band.values.size(); i += line) out << "0 0 0 0 0 0 0 0\n";
        out << "}\n";
    }
    out << "</ScatteringData>\n</WavelengthDataBlock>\n</WavelengthData>\n";
}

/// Closes what write_radiance_head opened.
void write_radiance_tail(std::ostream& out) { out << "</Layer>\n</Optical>\n</WindowElement>\n"; }

/// Shirley and Chiu's area-preserving map of the unit square to the unit disk.
std::pair<double, double> square_to_disk(double x, double y) {
    const double a = 2 * x - 1, b = 2 * y - 1;
    double r = 0, phi = 0;
    if (a > -b) {
        if (a > b) {
            r = a;
            phi = std::numbers::pi / 4 * (b / a);
        } else {
            r = b;
            phi = std::numbers::pi / 4 * (2 - a / b);
        }
    } else if (a < b) {
        r = -a;
        phi = std::numbers::pi / 4 * (4 + b / a);
    } else {
        r = -b;
        phi = b != 0 ? std::numbers::pi / 4 * (6 - a / b) : 0;
    }
    return {r * std::cos(phi), r * std::sin(phi)};
}

/// An isotropic tensor tree (TensorTree3, LBNL/Shirley-Chiu) as one full grid of 2^levels cells a
/// side: luminance, and the chromaticity u', v'.
void write_tree(const ExportJob& job, std::ostream& out) {
    const std::size_t n = std::size_t{1} << job.options.resolution;
    // Incidence along the first axis, from grazing (0) to normal (1/2); its upper half is not used.
    // Seven digits are written: floats.
    RadianceBand bands[3] = {{"Visible", "ASTM E308 1931 Y.dsp", std::vector<float>(n * n * n / 2)},
                             {"CIE-u", "CIE 1976 u.dsp", std::vector<float>(n * n * n / 2)},
                             {"CIE-v", "CIE 1976 v.dsp", std::vector<float>(n * n * n / 2)}};
    for (std::size_t i = 0; i < n / 2; ++i) {
        const double sin_in = 1.0 - 2.0 * (static_cast<double>(i) + 0.5) / static_cast<double>(n);
        std::vector<Direction> directions;
        for (std::size_t x = 0; x < n; ++x) {
            for (std::size_t y = 0; y < n; ++y) {
                const auto [dx, dy] =
                    square_to_disk((static_cast<double>(x) + 0.5) / static_cast<double>(n),
                                   (static_cast<double>(y) + 0.5) / static_cast<double>(n));
                const double mu_out = std::sqrt(std::max(1e-12, 1 - dx * dx - dy * dy));
                directions.push_back(
                    {std::sqrt((1 - sin_in) * (1 + sin_in)), mu_out, std::atan2(dy, dx) / kDegree});
            }
        }
        const auto stage = fmt::format("incidence {} of {}", i + 1, n / 2);
        const std::vector<double> rgb = evaluate_all(job.rgb, directions, stage, job.control);
        for (std::size_t d = 0; d < directions.size(); ++d) {
            const auto [X, Y, Z] = xyz_of(&rgb[3 * d]);
            const double divisor = X + 15 * Y + 3 * Z;
            const std::size_t cell = i * n * n + d;
            bands[0].values[cell] = static_cast<float>(Y);
            bands[1].values[cell] = static_cast<float>(divisor > 0 ? 4 * X / divisor : 0.0);
            bands[2].values[cell] = static_cast<float>(divisor > 0 ? 9 * Y / divisor : 0.0);
        }
    }
    write_radiance_head(
        job.rgb,
        "<DataDefinition>\n<IncidentDataStructure>TensorTree3</IncidentDataStructure>\n</"
        "DataDefinition>\n",
        out);
    for (const RadianceBand& band : bands)
        write_radiance_band(band, "<AngleBasis>LBNL/Shirley-Chiu</AngleBasis>\n", 0, out);
    write_radiance_tail(out);
}

// LBNL/Klems Full: rings of patches of about equal projected solid angle.
constexpr double kEdges_deg[] = {0, 5, 15, 25, 35, 45, 55, 65, 75, 90};
constexpr int kPatches[] = {1, 8, 16, 20, 24, 24, 24, 16, 12};
constexpr int kRings = 9;
constexpr int kPatchPoints = 128;  ///< of both directions in each pair of patches

std::string klems_definition() {
    std::string text =
        "<DataDefinition>\n<IncidentDataStructure>Columns</IncidentDataStructure>\n<AngleBasis>\n"
        "<AngleBasisName>LBNL/Klems Full</AngleBasisName>\n";
    for (int ring = 0; ring < kRings; ++ring) {
        text += fmt::format(
            "<AngleBasisBlock><Theta>{}</Theta><nPhis>{}</nPhis><ThetaBounds><LowerTheta>{}"
            "</LowerTheta><UpperTheta>{}</UpperTheta></ThetaBounds></AngleBasisBlock>\n",
            ring == 0 ? 0.0 : (kEdges_deg[ring] + kEdges_deg[ring + 1]) / 2, kPatches[ring],
            kEdges_deg[ring], kEdges_deg[ring + 1]);
    }
    return text + "</AngleBasis>\n</DataDefinition>\n";
}

/// Cosine at `share` of a ring's projected solid angle.
double ring_cosine(int ring, double share) {
    const double low = std::pow(std::cos(kEdges_deg[ring + 1] * kDegree), 2);
    const double high = std::pow(std::cos(kEdges_deg[ring] * kDegree), 2);
    return std::sqrt(low + (high - low) * share);
}

/// Mean BRDF of two patches; only the difference of their azimuths matters.
std::array<double, 3> patch_mean(const RgbSource& source, int in, int out, double azimuth_deg) {
    // Evenly spread in four dimensions (Roberts 2018, R-sequence): multiples of powers of 1/x,
    // x^5 = x + 1. A grid of three points a side has only five differences of azimuth.
    constexpr double kStep[4] = {0.8566748838545029, 0.733891856627126, 0.6287067210378087,
                                 0.5385972572236101};
    const auto at = [&](int point, int dimension) {
        const double multiple = 0.5 + (point + 1) * kStep[dimension];
        return multiple - std::floor(multiple);
    };
    std::vector<Direction> directions;
    for (int p = 0; p < kPatchPoints; ++p) {
        const double shift_in = 360.0 / kPatches[in] * (at(p, 2) - 0.5);
        const double shift_out = 360.0 / kPatches[out] * (at(p, 3) - 0.5);
        directions.push_back({ring_cosine(in, at(p, 0)), ring_cosine(out, at(p, 1)),
                              azimuth_deg + shift_out - shift_in});
    }
    std::vector<double> values(3 * directions.size());
    source.evaluate(directions, values);
    double rgb[3] = {0, 0, 0};
    for (std::size_t i = 0; i < values.size(); ++i)
        rgb[i % 3] += values[i] / static_cast<double>(directions.size());
    return xyz_of(rgb);
}

/// A matrix of averages over 145 x 145 patches (LBNL/Klems Full), for Y, X and Z.
void write_klems(const ExportJob& job, std::ostream& out) {
    std::vector<std::pair<int, int>> patches;  // ring, index in the ring
    for (int ring = 0; ring < kRings; ++ring) {
        for (int k = 0; k < kPatches[ring]; ++k) patches.emplace_back(ring, k);
    }
    std::map<std::tuple<int, int, int>, std::array<double, 3>> known;
    std::array<std::vector<float>, 3> matrices;
    for (const auto& [ring_out, k_out] : patches) {
        if (job.control.is_cancelled && job.control.is_cancelled()) throw Cancelled();
        for (const auto& [ring_in, k_in] : patches) {
            // Equal indices of incident and outgoing patches are mirror directions.
            const int turn = kPatches[ring_in] * kPatches[ring_out];
            const int difference =
                std::abs(k_out * kPatches[ring_in] - k_in * kPatches[ring_out]) % turn;
            // The central patch is a full turn wide: no azimuth differs from another.
            const bool central = kPatches[ring_in] == 1 || kPatches[ring_out] == 1;
            const int folded = central ? 0 : std::min(difference, turn - difference);
            auto [mean, is_new] = known.try_emplace({ring_in, ring_out, folded});
            if (is_new)
                mean->second = patch_mean(job.rgb, ring_in, ring_out, 360.0 * folded / turn);
            for (std::size_t c = 0; c < 3; ++c)
                matrices[c].push_back(static_cast<float>(mean->second[c]));
        }
    }
    write_radiance_head(job.rgb, klems_definition(), out);
    const std::string basis =
        "<ColumnAngleBasis>LBNL/Klems Full</ColumnAngleBasis>\n<RowAngleBasis>LBNL/Klems "
        "Full</RowAngleBasis>\n";
    write_radiance_band({"Visible", "ASTM E308 1931 Y.dsp", std::move(matrices[1])}, basis,
                        patches.size(), out);
    write_radiance_band({"CIE-X", "ASTM E308 1931 X.dsp", std::move(matrices[0])}, basis,
                        patches.size(), out);
    write_radiance_band({"CIE-Z", "ASTM E308 1931 Z.dsp", std::move(matrices[2])}, basis,
                        patches.size(), out);
    write_radiance_tail(out);
}

}  // namespace

Format radiance_format() {
    return {.name = "radiance",
            .readers = "Radiance",
            .holds = "colour, tensor tree",
            .endings = {".xml"},
            .content = FormatContent::sampled,
            .resolution = {"levels of the tree", 5, 2, 8, 7},
            .takes_colours = true,
            .accepted_error = 0.2,
            .files = {{.colours = true, .write = write_tree}},
            .reader = radiance_reader()};
}

Format klems_format() {
    return {.name = "klems",
            .readers = "Radiance, WINDOW",
            .holds = "colour, 145 x 145 patches",
            .endings = {".xml"},
            .content = FormatContent::sampled,
            .resolution = {"patches", 145, 145, 145, 145},
            .takes_colours = true,
            .accepted_error = 0.2,
            .files = {{.colours = true, .write = write_klems}},
            .reader = radiance_reader()};  // which calls its files radiance
}

}  // namespace miebrdf
