// radiance: an isotropic tensor tree of Radiance's BSDF XML. docs/formats/radiance.md
#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>
#include <ostream>

#include "pipeline/formats/common/export_job.h"
#include "pipeline/formats/radiance/bsdf_xml.h"
#include "pipeline/solve/vector_pairs.h"

namespace miebrdf {
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
        const std::size_t row = cell / n_;
        const auto [dx, dy] =
            square_to_disk((double(row) + share.x) / side, (double(cell % n_) + share.y) / side);
        return {std::sqrt(std::max(1e-12, (1 - sin_in) * (1 + sin_in))),
                std::sqrt(std::max(1e-12, 1 - dx * dx - dy * dy)), std::atan2(dy, dx) / kDegree};
    }

    /// The mirror image of a cell on the other side of the plane of incidence.
    std::size_t across(std::size_t cell) const { return cell - cell % n_ + (n_ - 1 - cell % n_); }

    /// Points for the mean over each cell of one side of the plane of incidence. Something narrower
    /// than a cell may hide about the mirror direction and retro-reflection, and where neighbours
    /// differ much; where they differ by less than 5 % their cells hold their centre to 1 %, where
    /// by less than half a few points know the mean as well.
    std::vector<std::pair<std::size_t, std::size_t>> points(const std::vector<double>& rgb) const {
        std::vector<std::pair<std::size_t, std::size_t>> cells;
        for (std::size_t cell = 0; cell < n_ * n_; ++cell) {
            if (across(cell) < cell) continue;
            double largest = 0.0;
            const std::size_t x = cell / n_, y = cell % n_;
            const auto compare = [&](std::size_t other) {
                for (std::size_t c = 0; c < 3; ++c) {
                    const double here = rgb[3 * cell + c], there = rgb[3 * other + c];
                    const double scale = std::max(here, there);
                    if (scale > 0.0) largest = std::max(largest, std::abs(there - here) / scale);
                }
            };
            if (x > 0) compare(cell - n_);
            if (x + 1 < n_) compare(cell + n_);
            if (y > 0) compare(cell - 1);
            if (y + 1 < n_) compare(cell + 1);
            if (largest > 0.5 || near_peaks(cell)) {
                cells.emplace_back(cell, 64);
            } else if (largest > 0.05) {
                cells.emplace_back(cell, 16);
            }
        }
        return cells;
    }

  private:
    bool near_peaks(std::size_t cell) const {
        const Direction d = at(cell, {0.5, 0.5, 0.5});
        const auto [in, out] = vectors_of(d);
        // A cell is about 2 / n wide.
        return std::hypot(std::abs(out.x()) - in.x(), out.y()) < 4.0 / double(n_);
    }

    std::size_t n_, incidence_;
};

/// Mean colours of the cells of one incidence, [3 * cell + c]. Renderers take a cell for constant:
/// its mean carries the light of peaks that are narrower than it, its centre would lose or
/// exaggerate them.
std::vector<double> plane_of(const RgbSource& source, const TreePlane& plane, std::size_t cells,
                             const std::string& stage, const Control& control) {
    constexpr double kStep[3] = {0.8191725133961645, 0.6710436067037893, 0.5497004779019703};
    std::vector<Direction> directions;
    std::vector<std::size_t> one_side;
    for (std::size_t cell = 0; cell < cells; ++cell) {
        if (plane.across(cell) < cell) continue;
        one_side.push_back(cell);
        directions.push_back(plane.at(cell, {0.5, 0.5, 0.5}));
    }
    std::vector<double> rgb(3 * cells);
    const auto keep = [&](std::size_t cell, std::size_t c, double value) {
        rgb[3 * cell + c] = rgb[3 * plane.across(cell) + c] = value;
    };
    const std::vector<double> centres = evaluate_all(source, directions, stage, control);
    for (std::size_t i = 0; i < centres.size(); ++i) keep(one_side[i / 3], i % 3, centres[i]);
    const auto points = plane.points(rgb);
    directions.clear();
    for (const auto& [cell, count] : points) {
        for (std::size_t p = 0; p < count; ++p) {
            // Evenly spread: the R-sequence of three dimensions.
            const auto share = [&](std::size_t axis) {
                const double multiple = 0.5 + double(p + 1) * kStep[axis];
                return multiple - std::floor(multiple);
            };
            directions.push_back(plane.at(cell, {share(0), share(1), share(2)}));
        }
    }
    const std::vector<double> inside = evaluate_all(source, directions, stage, control);
    auto next = inside.begin();
    for (const auto& [cell, count] : points) {
        for (std::size_t c = 0; c < 3; ++c) {
            double sum = 0.0;
            for (std::size_t p = 0; p < count; ++p) sum += next[std::ptrdiff_t(3 * p + c)];
            keep(cell, c, sum / double(count));
        }
        next += std::ptrdiff_t(3 * count);
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
            const auto [X, Y, Z] = radiance_xyz(&rgb[3 * d]);
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

}  // namespace miebrdf
