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

/// XYZ of Radiance's own R, G and B (src/common/color.h: primaries (.640, .330), (.290, .600),
/// (.150, .060), neutral at X = Y = Z): what it renders are then the numbers of linear sRGB, and
/// grey is grey. Relative to D65 every neutral would come out bluish.
constexpr double kXyz[3][3] = {{0.5141446208, 0.3238844797, 0.1619708995},
                               {0.2651058201, 0.6701058201, 0.0647883598},
                               {0.0241005291, 0.1228527337, 0.8530467372}};

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

/// A point in a cell of the tree: `share` of its extent along incidence and both axes of the
/// square.
struct CellPoint {
    double incidence, x, y;
};

/// Directions at points of the cells of one incidence of a tree of n cells a side.
class TreePlane {
  public:
    TreePlane(std::size_t n, std::size_t incidence) : n_(n), incidence_(incidence) {}

    Direction at(std::size_t cell, const CellPoint& share) const {
        const auto side = static_cast<double>(n_);
        const double sin_in = 1.0 - 2.0 * (double(incidence_) + share.incidence) / side;
        const auto [dx, dy] = square_to_disk((double(cell / n_) + share.x) / side,
                                             (double(cell % n_) + share.y) / side);
        return {std::sqrt(std::max(1e-12, (1 - sin_in) * (1 + sin_in))),
                std::sqrt(std::max(1e-12, 1 - dx * dx - dy * dy)), std::atan2(dy, dx) / kDegree};
    }

    /// The same cell on the other side of the plane of incidence.
    std::size_t across(std::size_t cell) const { return cell - cell % n_ + (n_ - 1 - cell % n_); }

    /// Cells in which, or beside which, something narrower than a cell may hide: where neighbours
    /// differ, and about the mirror direction and retro-reflection.
    std::vector<std::size_t> uneven(const std::vector<double>& rgb) const {
        constexpr double kEven = 0.05;  // of neighbours: their cells hold their centre to 1 %
        std::vector<std::size_t> cells;
        for (std::size_t cell = 0; cell < n_ * n_; ++cell) {
            bool flat = !near_peaks(cell);
            const std::size_t x = cell / n_, y = cell % n_;
            const auto compare = [&](std::size_t other) {
                for (std::size_t c = 0; c < 3; ++c) {
                    const double here = rgb[3 * cell + c], there = rgb[3 * other + c];
                    flat = flat && std::abs(there - here) <= kEven * std::max(here, there);
                }
            };
            if (x > 0) compare(cell - n_);
            if (x + 1 < n_) compare(cell + n_);
            if (y > 0) compare(cell - 1);
            if (y + 1 < n_) compare(cell + 1);
            if (!flat) cells.push_back(cell);
        }
        return cells;
    }

  private:
    bool near_peaks(std::size_t cell) const {
        const Direction d = at(cell, {0.5, 0.5, 0.5});
        const double sin_in = std::sqrt((1 - d.mu_in) * (1 + d.mu_in));
        const double sin_out = std::sqrt((1 - d.mu_out) * (1 + d.mu_out));
        const double x = std::abs(sin_out * std::cos(d.azimuth_deg * kDegree));
        const double y = sin_out * std::sin(d.azimuth_deg * kDegree);
        return std::hypot(x - sin_in, y) < 4.0 / double(n_);  // a cell is about 2 / n wide
    }

    std::size_t n_, incidence_;
};

/// Mean colours of the cells of one incidence, [3 * cell + c]. Renderers take a cell for constant:
/// its mean carries the light of peaks that are narrower than it, its centre would lose or
/// exaggerate them.
std::vector<double> plane_of(const RgbSource& source, const TreePlane& plane, std::size_t cells,
                             const std::string& stage, const Control& control) {
    constexpr std::size_t kPoints = 64;  // evenly spread (R-sequence of three dimensions)
    constexpr double kStep[3] = {0.8191725133961645, 0.6710436067037893, 0.5497004779019703};
    std::vector<Direction> directions;
    for (std::size_t cell = 0; cell < cells; ++cell)
        directions.push_back(plane.at(cell, {0.5, 0.5, 0.5}));
    std::vector<double> rgb = evaluate_all(source, directions, stage, control);
    const std::vector<std::size_t> uneven = plane.uneven(rgb);
    directions.clear();
    for (const std::size_t cell : uneven) {
        for (std::size_t p = 0; p < kPoints; ++p) {
            const auto share = [&](std::size_t axis) {
                const double multiple = 0.5 + double(p + 1) * kStep[axis];
                return multiple - std::floor(multiple);
            };
            directions.push_back(plane.at(cell, {share(0), share(1), share(2)}));
        }
    }
    const std::vector<double> inside = evaluate_all(source, directions, stage, control);
    for (std::size_t i = 0; i < uneven.size(); ++i) {
        for (std::size_t c = 0; c < 3; ++c) {
            double sum = 0.0;
            for (std::size_t p = 0; p < kPoints; ++p) sum += inside[3 * (i * kPoints + p) + c];
            rgb[3 * uneven[i] + c] = sum / double(kPoints);
        }
    }
    for (std::size_t cell = 0; cell < cells; ++cell) {  // both sides of the plane of incidence
        const std::size_t across = plane.across(cell);
        for (std::size_t c = 0; c < 3 && across > cell; ++c) {
            double &one = rgb[3 * cell + c], &other = rgb[3 * across + c];
            one = other = (one + other) / 2;
        }
    }
    return rgb;
}

/// Radiance subtracts the least colour of a tree as its diffuse part, and in doing so loses the
/// chromaticity of isotropic trees (bsdf_t.c, subtract_min_RGB: the half of u', v' that is not used
/// is missing from the new trees, which are then dropped, and the rest is painted red). A minimum
/// of less than .01 / pi keeps it from that: a cell at the edge of the hemisphere, and the one
/// across the plane of incidence, are made black.
void keep_chromaticity(std::size_t n, std::vector<float>& luminance) {
    constexpr double kNotSubtracted = 0.005 / std::numbers::pi;  // half of what it looks for
    const float least = *std::min_element(luminance.begin(), luminance.end());
    if (least > kNotSubtracted) luminance[0] = luminance[n - 1] = 0.0F;
}

/// Three trees of text; the half that is not used takes two bytes a cell, the other ten.
std::uintmax_t tree_bytes(const ExportOptions& options, std::size_t) {
    return std::uintmax_t{18} << (3 * options.resolution);
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
        const auto stage = fmt::format("incidence {} of {}", i + 1, n / 2);
        const std::vector<double> rgb =
            plane_of(job.rgb, TreePlane(n, i), n * n, stage, job.control);
        for (std::size_t d = 0; d < n * n; ++d) {
            const auto [X, Y, Z] = xyz_of(&rgb[3 * d]);
            const double divisor = X + 15 * Y + 3 * Z;
            const std::size_t cell = i * n * n + d;
            bands[0].values[cell] = static_cast<float>(Y);
            // Black is neutral: u' = 4/19, v' = 9/19.
            bands[1].values[cell] = static_cast<float>(divisor > 0 ? 4 * X / divisor : 4.0 / 19);
            bands[2].values[cell] = static_cast<float>(divisor > 0 ? 9 * Y / divisor : 9.0 / 19);
        }
    }
    keep_chromaticity(n, bands[0].values);
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
            .accepted = {.plain = 0.2},
            .expected_bytes = tree_bytes,
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
            .accepted = {.plain = 0.2},
            .files = {{.colours = true, .write = write_klems}},
            .reader = radiance_reader()};  // which calls its files radiance
}

}  // namespace miebrdf
