// ssdd and astm: tables over equal steps of polar angle and azimuth. docs/formats/ssdd.md, astm.md
#include <fmt/format.h>

#include <algorithm>
#include <bit>
#include <cstdint>
#include <nlohmann/json.hpp>
#include <ostream>

#include "pipeline/formats/common/byte_writer.h"
#include "pipeline/formats/common/export_job.h"
#include "pipeline/solve/vector_pairs.h"

namespace miebrdf {

FormatReader ssdd_reader();  // reader.cpp
FormatReader astm_reader();

namespace {

struct PolarGrid {
    std::vector<double> theta_deg;    ///< 0 ... 89
    std::vector<double> azimuth_deg;  ///< 0 ... 180
};

/// Steps of 90 / n and 180 / n degrees. The last polar angle is 89 degrees, since readers
/// interpolate linearly and a BRDF may be steep at the horizon.
PolarGrid make_polar_grid(int intervals) {
    constexpr double kLargestAngle = 89.0;
    PolarGrid grid;
    for (int i = 0; i <= intervals; ++i) {
        const double theta = std::min(90.0 * i / intervals, kLargestAngle);
        if (grid.theta_deg.empty() || theta > grid.theta_deg.back())
            grid.theta_deg.push_back(theta);
        grid.azimuth_deg.push_back(180.0 * i / intervals);
    }
    return grid;
}

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

/// Surface scattering distribution data: every wavelength at equal steps of angle.
void write_ssdd(const ExportJob& job, std::ostream& out) {
    const BrdfSource& source = job.spectral;
    const PolarGrid grid = make_polar_grid(job.options.resolution);
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
    ByteWriter bytes(out);
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
        const std::vector<double> values = evaluate_all(source, directions, stage, job.control);
        std::vector<float> figures(values.begin(), values.end());
        if (a == 0) keep_from_looking_like_a_comment(figures);
        bytes.put_all(figures);
    }
}

/// ASTM E1392: one row for each direction, angles in radians, BRDF at each wavelength.
void write_astm(const ExportJob& job, std::ostream& out) {
    const BrdfSource& source = job.spectral;
    const PolarGrid grid = make_polar_grid(job.options.resolution);
    const auto description = metadata(source, {.format = "astm",
                                               .cosine_included = false,
                                               .azimuth_zero = "towards the source",
                                               .colour = ""});
    out << "TITLE " << source.provenance().title << "\nCOMMENT " << description.dump() << '\n';
    const std::size_t thetas = grid.theta_deg.size();
    out << "NUM_POINTS " << thetas * thetas * grid.azimuth_deg.size()
        << "\nVARS theta_i,phi_i,theta_s,phi_s";
    for (const double wavelength : source.wavelength_nm()) out << fmt::format(",{}nm", wavelength);
    out << '\n';
    const std::size_t channels = source.wavelength_nm().size();
    for (std::size_t i = 0; i < thetas; ++i) {  // one incidence at a time
        std::vector<Direction> directions;
        std::vector<std::string> angles;
        for (const double theta_out : grid.theta_deg) {
            for (const double azimuth : grid.azimuth_deg) {
                directions.push_back({std::cos(grid.theta_deg[i] * kDegree),
                                      std::cos(theta_out * kDegree), 180.0 - azimuth});
                angles.push_back(fmt::format("{:.9g},0,{:.9g},{:.9g}", grid.theta_deg[i] * kDegree,
                                             theta_out * kDegree, azimuth * kDegree));
            }
        }
        const auto stage = fmt::format("incidence {} of {}", i + 1, thetas);
        const std::vector<double> values = evaluate_all(source, directions, stage, job.control);
        for (std::size_t d = 0; d < directions.size(); ++d) {
            const auto row = std::span(values).subspan(d * channels, channels);
            out << angles[d] << ',' << fmt::format("{:.9g}\n", fmt::join(row, ","));
        }
    }
}

Format angle_format(const char* name, int steps, void (*write)(const ExportJob&, std::ostream&),
                    const FormatReader& reader) {
    return {.name = name,
            .holds = "every wavelength, listed angles",
            .content = FormatContent::sampled,
            .resolution = {"steps of a quarter turn", steps, 3, 180, 90},
            .files = {{.write = write}},
            .reader = reader};
}

}  // namespace

Format ssdd_format() {
    Format format = angle_format("ssdd", 18, write_ssdd, ssdd_reader());
    format.readers = "libbsdf, BSDF Processor";
    format.endings = {".ssdd"};
    format.accepted_error = 0.05;
    return format;
}

Format astm_format() {
    Format format = angle_format("astm", 9, write_astm, astm_reader());
    format.readers = "libbsdf, BSDF Processor, measurement software";
    format.endings = {".astm"};
    format.accepted_error = 0.1;
    return format;
}

}  // namespace miebrdf
