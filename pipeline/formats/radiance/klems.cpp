// klems: averages over the patches of LBNL/Klems Full, in Radiance's BSDF XML.
// docs/formats/radiance.md
#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <map>
#include <ostream>
#include <tuple>

#include "pipeline/formats/common/export_job.h"
#include "pipeline/formats/radiance/bsdf_xml.h"
#include "pipeline/solve/vector_pairs.h"

namespace miebrdf {
namespace {

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
    return radiance_xyz(rgb);
}

/// Matrices of averages over 145 x 145 patches (LBNL/Klems Full), for Y, X and Z.
void write_klems(const ExportJob& job, std::ostream& out) {
    std::vector<std::pair<int, int>> patches;  // ring, index in the ring
    for (int ring = 0; ring < kRings; ++ring) {
        for (int k = 0; k < kPatches[ring]; ++k) patches.emplace_back(ring, k);
    }
    std::map<std::tuple<int, int, int>, std::array<double, 3>> known;
    const auto mean_of = [&](std::size_t from, std::size_t to) {
        const auto [ring_in, k_in] = patches[from];
        const auto [ring_out, k_out] = patches[to];
        // Equal indices of incident and outgoing patches are mirror directions, and straight on.
        const int turn = kPatches[ring_in] * kPatches[ring_out];
        const int difference =
            std::abs(k_out * kPatches[ring_in] - k_in * kPatches[ring_out]) % turn;
        // The central patch is a full turn wide: no azimuth differs from another.
        const bool central = kPatches[ring_in] == 1 || kPatches[ring_out] == 1;
        const int folded = central ? 0 : std::min(difference, turn - difference);
        auto [mean, is_new] = known.try_emplace({ring_in, ring_out, folded});
        if (is_new) mean->second = patch_mean(job.rgb, ring_in, ring_out, 360.0 * folded / turn);
        return mean->second;
    };
    const std::string basis =
        "<ColumnAngleBasis>LBNL/Klems Full</ColumnAngleBasis>\n<RowAngleBasis>LBNL/Klems "
        "Full</RowAngleBasis>\n";
    write_radiance_head(job.rgb, klems_definition(), out);
    /// @param is_turned  light comes from below: the same with both directions exchanged
    const auto write_bands = [&](const char* direction, bool is_turned) {
        std::array<std::vector<float>, 3> matrices;
        for (std::size_t row = 0; row < patches.size(); ++row) {
            if (job.control.is_cancelled && job.control.is_cancelled()) throw Cancelled();
            for (std::size_t column = 0; column < patches.size(); ++column) {
                const auto mean = is_turned ? mean_of(row, column) : mean_of(column, row);
                for (std::size_t c = 0; c < 3; ++c)
                    matrices[c].push_back(static_cast<float>(mean[c]));
            }
        }
        constexpr std::array<std::array<const char*, 2>, 3> kNames = {
            {{"Visible", "ASTM E308 1931 Y.dsp"},
             {"CIE-X", "ASTM E308 1931 X.dsp"},
             {"CIE-Z", "ASTM E308 1931 Z.dsp"}}};
        constexpr std::array<std::size_t, 3> kChannels = {1, 0, 2};
        for (std::size_t k = 0; k < kNames.size(); ++k)
            write_radiance_band(
                {kNames[k][0], kNames[k][1], std::move(matrices[kChannels[k]]), direction}, basis,
                patches.size(), out);
    };
    if (job.rgb.provenance().component == "transmitted") {
        write_bands("Transmission Back", false);
        write_bands("Transmission Front", true);
    } else {
        write_bands("Reflection Back", false);
    }
    write_radiance_tail(out);
}

}  // namespace

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
