#include "pipeline/exports/radiance_writer.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <functional>
#include <map>
#include <nlohmann/json.hpp>
#include <numbers>
#include <tuple>

#include "pipeline/error.h"
#include "pipeline/exports/half_vector.h"
#include "pipeline/exports/metadata.h"

namespace miebrdf::exports {
namespace {

/// Linear sRGB to CIE XYZ (IEC 61966-2-1).
constexpr double kXyz[3][3] = {
    {0.4124, 0.3576, 0.1805}, {0.2126, 0.7152, 0.0722}, {0.0193, 0.1192, 0.9505}};

std::array<double, 3> xyz_of(const double* rgb) {
    std::array<double, 3> xyz{};
    for (std::size_t i = 0; i < 3; ++i) {
        for (std::size_t c = 0; c < 3; ++c) xyz[i] += kXyz[i][c] * rgb[c];
        xyz[i] = std::max(xyz[i], 0.0);
    }
    return xyz;
}

std::string escaped(const std::string& text) {
    std::string result;
    for (const char c : text) {
        switch (c) {
            case '&':
                result += "&amp;";
                break;
            case '<':
                result += "&lt;";
                break;
            case '>':
                result += "&gt;";
                break;
            default:
                result += c;
        }
    }
    return result;
}

/// One line of the XML's matrices: wavelength's name, detector, value of (row, column).
struct Band {
    const char* wavelength;
    const char* detector;
    std::vector<float> values;  ///< of a tree the first half; the rest is zero
};

void write_head(const RgbSource& source, const std::string& definition, std::ostream& out) {
    auto description = metadata(source, {.format = "radiance",
                                         .cosine_included = false,
                                         .azimuth_zero = "mirror side",
                                         .colour = source.weights().description});
    std::string comment = description.dump(1);
    // Two hyphens end an XML comment.
    for (std::size_t at; (at = comment.find("--")) != comment.npos;) comment.replace(at, 2, "- -");
    out << "<?xml version=\"1.0\" encoding=\"UTF-8\"?>\n<!--\n" << comment << "\n-->\n";
    out << "<WindowElement xmlns=\"http://windows.lbl.gov\" "
           "xmlns:xsi=\"http://www.w3.org/2001/XMLSchema-instance\" "
           "xsi:schemaLocation=\"http://windows.lbl.gov/BSDF-v1.4.xsd\">\n"
           "<WindowElementType>System</WindowElementType>\n<FileType>BSDF</"
           "FileType>\n<Optical>\n<Layer>\n<Material>\n";
    out << "<Name>" << escaped(source.provenance().title) << "</Name>\n<Manufacturer>"
        << escaped(source.provenance().version)
        << "</Manufacturer>\n<DeviceType>Other</DeviceType>\n</Material>\n";
    out << definition;
}

void write_band(const Band& band, const std::string& basis, std::size_t row, std::ostream& out) {
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

// LBNL/Klems Full: rings of patches of about equal projected solid angle.
constexpr double kEdges_deg[] = {0, 5, 15, 25, 35, 45, 55, 65, 75, 90};
constexpr int kPatches[] = {1, 8, 16, 20, 24, 24, 24, 16, 12};
constexpr int kRings = 9;
constexpr int kPoints = 3;  ///< per side of a patch, in cos^2 theta and azimuth

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

/// Cosine of point j of a ring, evenly spaced in projected solid angle.
double ring_cosine(int ring, int j) {
    const double low = std::pow(std::cos(kEdges_deg[ring + 1] * kDegree), 2);
    const double high = std::pow(std::cos(kEdges_deg[ring] * kDegree), 2);
    return std::sqrt(low + (high - low) * (j + 0.5) / kPoints);
}

/// Mean BRDF of two patches; only the difference of their azimuths matters.
std::array<double, 3> patch_mean(const RgbSource& source, int in, int out, double azimuth_deg) {
    std::vector<Direction> directions;
    for (int i = 0; i < kPoints; ++i) {
        for (int o = 0; o < kPoints; ++o) {
            for (int a = 0; a < kPoints; ++a) {
                for (int b = 0; b < kPoints; ++b) {
                    const double shift_in = 360.0 / kPatches[in] * ((a + 0.5) / kPoints - 0.5);
                    const double shift_out = 360.0 / kPatches[out] * ((b + 0.5) / kPoints - 0.5);
                    directions.push_back({ring_cosine(in, i), ring_cosine(out, o),
                                          azimuth_deg + shift_out - shift_in});
                }
            }
        }
    }
    std::vector<double> values(3 * directions.size());
    source.evaluate(directions, values);
    double rgb[3] = {0, 0, 0};
    for (std::size_t i = 0; i < values.size(); ++i)
        rgb[i % 3] += values[i] / static_cast<double>(directions.size());
    return xyz_of(rgb);
}

}  // namespace

void write_radiance_klems(const RgbSource& source, std::ostream& out, const RunControl& control) {
    std::vector<std::pair<int, int>> patches;  // ring, index in the ring
    for (int ring = 0; ring < kRings; ++ring) {
        for (int k = 0; k < kPatches[ring]; ++k) patches.emplace_back(ring, k);
    }
    std::map<std::tuple<int, int, int>, std::array<double, 3>> known;
    std::array<std::vector<float>, 3> matrices;
    for (const auto& [ring_out, k_out] : patches) {
        if (control.cancelled != nullptr && *control.cancelled) throw Cancelled();
        for (const auto& [ring_in, k_in] : patches) {
            // Equal indices of incident and outgoing patches are mirror directions.
            const int turn = kPatches[ring_in] * kPatches[ring_out];
            const int difference =
                std::abs(k_out * kPatches[ring_in] - k_in * kPatches[ring_out]) % turn;
            const int folded = std::min(difference, turn - difference);
            auto [mean, is_new] = known.try_emplace({ring_in, ring_out, folded});
            if (is_new) mean->second = patch_mean(source, ring_in, ring_out, 360.0 * folded / turn);
            for (std::size_t c = 0; c < 3; ++c)
                matrices[c].push_back(static_cast<float>(mean->second[c]));
        }
    }
    write_head(source, klems_definition(), out);
    const std::string basis =
        "<ColumnAngleBasis>LBNL/Klems Full</ColumnAngleBasis>\n<RowAngleBasis>LBNL/Klems "
        "Full</RowAngleBasis>\n";
    write_band({"Visible", "ASTM E308 1931 Y.dsp", std::move(matrices[1])}, basis, patches.size(),
               out);
    write_band({"CIE-X", "ASTM E308 1931 X.dsp", std::move(matrices[0])}, basis, patches.size(),
               out);
    write_band({"CIE-Z", "ASTM E308 1931 Z.dsp", std::move(matrices[2])}, basis, patches.size(),
               out);
    out << "</Layer>\n</Optical>\n</WindowElement>\n";
}

namespace {

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

}  // namespace

void write_radiance_tree(const RgbSource& source, int levels, std::ostream& out,
                         const RunControl& control) {
    if (!(levels >= 2 && levels <= 8)) {
        throw UsageError(
            fmt::format("radiance: {} levels are out of range; allowed: 2 to 8", levels));
    }
    const std::size_t n = std::size_t{1} << levels;
    // Incidence along the first axis, from grazing (0) to normal (1/2); its upper half is not used.
    // Seven digits are written: floats.
    Band bands[3] = {{"Visible", "ASTM E308 1931 Y.dsp", std::vector<float>(n * n * n / 2)},
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
        const std::vector<double> rgb = evaluate_all(source, directions, stage, control);
        for (std::size_t d = 0; d < directions.size(); ++d) {
            const auto [X, Y, Z] = xyz_of(&rgb[3 * d]);
            const double divisor = X + 15 * Y + 3 * Z;
            const std::size_t cell = i * n * n + d;
            bands[0].values[cell] = static_cast<float>(Y);
            bands[1].values[cell] = static_cast<float>(divisor > 0 ? 4 * X / divisor : 0.0);
            bands[2].values[cell] = static_cast<float>(divisor > 0 ? 9 * Y / divisor : 0.0);
        }
    }
    write_head(source,
               "<DataDefinition>\n<IncidentDataStructure>TensorTree3</IncidentDataStructure>\n</"
               "DataDefinition>\n",
               out);
    for (const Band& band : bands)
        write_band(band, "<AngleBasis>LBNL/Shirley-Chiu</AngleBasis>\n", 0, out);
    out << "</Layer>\n</Optical>\n</WindowElement>\n";
}

}  // namespace miebrdf::exports
