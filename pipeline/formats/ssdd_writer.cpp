#include "pipeline/formats/ssdd_writer.h"

#include <fmt/format.h>

#include <bit>
#include <cstdint>
#include <nlohmann/json.hpp>

#include "pipeline/formats/binary_writer.h"
#include "pipeline/formats/metadata.h"
#include "pipeline/formats/polar_grid.h"
#include "pipeline/solve/vector_pairs.h"

namespace miebrdf::exports {
namespace {

bool begin_with_hash(const std::vector<float>& values) {
    for (const float value : values) {
        const auto bits = std::bit_cast<std::uint32_t>(value);
        for (int shift = 0; shift < 32; shift += 8) {  // little endian, as in the file
            const std::uint32_t byte = (bits >> shift) & 0xff;
            if (byte != ' ' && (byte < '\t' || byte > '\r')) return byte == '#';
        }
    }
    return false;
}

/// libbsdf looks for comments after every line, that of DATA included: figures whose first byte
/// after white space is '#' would be skipped up to the next line feed. Units in the last place of
/// the first figure make it another byte.
void keep_from_looking_like_a_comment(std::vector<float>& values) {
    while (begin_with_hash(values)) {
        values[0] = std::bit_cast<float>(std::bit_cast<std::uint32_t>(values[0]) + 1);
    }
}

}  // namespace

void write_ssdd(const BrdfSource& source, int intervals, std::ostream& out,
                const RunControl& control) {
    require_wavelengths(source, "ssdd");
    const PolarGrid grid = make_polar_grid("ssdd", intervals);
    const Provenance& origin = source.provenance();
    const auto description = metadata(source, {.format = "ssdd",
                                               .cosine_included = false,
                                               .azimuth_zero = "towards the source",
                                               .colour = ""});
    out << "VERSION 0.2\nSOFTWARE " << origin.version << "\n\n# " << description.dump() << '\n';
    out << "DATA_TYPE brdf\nCOLOR_MODEL spectrum\n";
    out << fmt::format("WAVELENGTH_LIST {}\n", fmt::join(source.wavelength_nm(), " "));
    out << "PARAM_TYPE spherical_coordinate_system\nREDUCTION_TYPE bilateral_symmetry\n";
    out << fmt::format("PARAM0_LIST {0}\nPARAM2_LIST {0}\n", fmt::join(grid.theta_deg, " "));
    out << fmt::format("PARAM3_LIST {}\n", fmt::join(grid.azimuth_deg, " "));
    out << "NAME " << origin.title << "\nSOURCE_TYPE generated\nDATA binary\n";
    BinaryWriter binary(out);
    // Incident angle fastest, then outgoing, then azimuth: one azimuth at a time.
    for (std::size_t a = 0; a < grid.azimuth_deg.size(); ++a) {
        std::vector<Direction> directions;
        for (const double theta_out : grid.theta_deg) {
            for (const double theta_in : grid.theta_deg) {
                directions.push_back({std::cos(theta_in * kDegree), std::cos(theta_out * kDegree),
                                      180.0 - grid.azimuth_deg[a]});
            }
        }
        const auto stage = fmt::format("azimuth {} of {}", a + 1, grid.azimuth_deg.size());
        const std::vector<double> values = evaluate_all(source, directions, stage, control);
        std::vector<float> figures(values.begin(), values.end());
        if (a == 0) keep_from_looking_like_a_comment(figures);
        binary.put_all(figures);
    }
}

}  // namespace miebrdf::exports
