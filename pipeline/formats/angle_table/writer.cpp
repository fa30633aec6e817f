// ssdd and astm: tables over equal steps of polar angle and azimuth. docs/formats/ssdd.md, astm.md
#include <fmt/format.h>

#include <algorithm>
#include <bit>
#include <cstdint>
#include <nlohmann/json.hpp>
#include <ostream>
#include <span>

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

/// Values at the places of a plane of the grid, of `columns` places a line. Readers interpolate
/// linearly: beside the mirror direction and retro-reflection, and where neighbours are not on a
/// line, a place holds the mean over the triangles that interpolation gives it, which carries the
/// light of peaks narrower than a step.
class PolarPlane {
  public:
    struct Place {
        std::size_t in, out, azimuth;
    };

    PolarPlane(const BrdfSource& source, const PolarGrid& grid, std::vector<Place> places,
               std::size_t columns)
        : source_(source), grid_(grid), places_(std::move(places)), columns_(columns) {}

    /// [place * channels + channel]
    std::vector<double> values(const std::string& stage, const Control& control) const {
        constexpr std::size_t kPoints = 64;  // evenly spread (R-sequence of three dimensions)
        constexpr double kStep[3] = {0.8191725133961645, 0.6710436067037893, 0.5497004779019703};
        const std::size_t channels = source_.channels().size();
        std::vector<Direction> directions;
        for (const Place& place : places_) directions.push_back(moved(place, 0.5, 0.5, 0.5));
        std::vector<double> values = evaluate_all(source_, directions, stage, control);
        std::vector<std::size_t> peaks;
        directions.clear();
        for (std::size_t place = 0; place < places_.size(); ++place) {
            if (is_grazing(places_[place])) continue;
            if (!near_peaks(places_[place]) && !bends(place, values)) continue;
            peaks.push_back(place);
            for (std::size_t p = 0; p < kPoints; ++p) {
                const auto number = [&](std::size_t axis) {
                    const double multiple = 0.5 + double(p + 1) * kStep[axis];
                    return multiple - std::floor(multiple);
                };
                directions.push_back(moved(places_[place], number(0), number(1), number(2)));
            }
        }
        const std::vector<double> around = evaluate_all(source_, directions, stage, control);
        for (std::size_t i = 0; i < peaks.size(); ++i) {
            std::vector<double> means(channels, 0.0);
            for (std::size_t p = 0; p < kPoints; ++p) {
                for (std::size_t c = 0; c < channels; ++c)
                    means[c] += around[(i * kPoints + p) * channels + c] / double(kPoints);
            }
            double* const own = &values[peaks[i] * channels];
            if (differ({own, channels}, means)) std::copy(means.begin(), means.end(), own);
        }
        return values;
    }

  private:
    /// A triangle over the intervals below and above; 0.5 is the middle one's own place.
    static double shifted(const std::vector<double>& list, std::size_t at, double uniform) {
        const double x = 2.0 * uniform - 1.0;
        const double share = 1.0 - std::sqrt(1.0 - std::abs(x));
        if (x == 0.0) return list[at];
        // Beyond its ends a list goes on as before: 0 degrees and half turns are mirrors.
        const double step =
            x < 0 ? (at > 0 ? list[at] - list[at - 1] : list[1] - list[0])
                  : (at + 1 < list.size() ? list[at + 1] - list[at] : list[at] - list[at - 1]);
        return list[at] + std::copysign(share * step, x);
    }

    Direction moved(const Place& place, double in, double out, double azimuth) const {
        constexpr double kHighest = 89.9;
        const auto cosine = [&](std::size_t at, double uniform) {
            const double theta = std::abs(shifted(grid_.theta_deg, at, uniform));
            return std::cos(std::min(theta, kHighest) * kDegree);
        };
        return {cosine(place.in, in), cosine(place.out, out),
                180.0 - shifted(grid_.azimuth_deg, place.azimuth, azimuth)};
    }

    /// A smooth BRDF keeps its own values.
    static bool differ(std::span<const double> values, std::span<const double> means) {
        constexpr double kSmooth = 0.05;
        for (std::size_t c = 0; c < values.size(); ++c) {
            if (!(std::abs(means[c] - values[c]) <= kSmooth * std::abs(values[c]))) return true;
        }
        return false;
    }

    /// Near the horizon a BRDF changes by orders of magnitude within a step: its mean would be that
    /// of the last degree.
    bool is_grazing(const Place& place) const {
        constexpr double kHighest = 78.0;  // mu = 0.2
        return std::max(grid_.theta_deg[place.in], grid_.theta_deg[place.out]) > kHighest;
    }

    bool near_peaks(const Place& place) const {
        const std::size_t apart = std::max(place.in, place.out) - std::min(place.in, place.out);
        const std::size_t last = grid_.azimuth_deg.size() - 1;
        return apart <= 1 && (place.azimuth <= 1 || place.azimuth + 1 >= last);
    }

    bool bends(std::size_t place, const std::vector<double>& values) const {
        constexpr double kStraight = 0.1;  // of the value: the mean is off by a twelfth of it
        const std::size_t channels = source_.channels().size();
        const auto along = [&](std::size_t step) {
            for (std::size_t c = 0; c < channels; ++c) {
                const double here = values[place * channels + c];
                const double bend = values[(place - step) * channels + c] - 2.0 * here +
                                    values[(place + step) * channels + c];
                if (std::abs(bend) > kStraight * std::abs(here)) return true;
            }
            return false;
        };
        const std::size_t column = place % columns_;
        const bool inner_column = column > 0 && column + 1 < columns_;
        const bool inner_row = place >= columns_ && place + columns_ < places_.size();
        return (inner_column && along(1)) || (inner_row && along(columns_));
    }

    const BrdfSource& source_;
    const PolarGrid& grid_;
    std::vector<Place> places_;
    std::size_t columns_;
};

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
        const std::size_t thetas = grid.theta_deg.size();
        std::vector<PolarPlane::Place> places;
        for (std::size_t p = 0; p < thetas * thetas; ++p)
            places.push_back({p % thetas, p / thetas, a});
        const auto stage = fmt::format("azimuth {} of {}", a + 1, grid.azimuth_deg.size());
        const std::vector<double> values =
            PolarPlane(source, grid, std::move(places), thetas).values(stage, job.control);
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
        std::vector<PolarPlane::Place> places;
        std::vector<std::string> angles;
        for (std::size_t o = 0; o < thetas; ++o) {
            for (std::size_t a = 0; a < grid.azimuth_deg.size(); ++a) {
                places.push_back({i, o, a});
                angles.push_back(fmt::format("{:.9g},0,{:.9g},{:.9g}", grid.theta_deg[i] * kDegree,
                                             grid.theta_deg[o] * kDegree,
                                             grid.azimuth_deg[a] * kDegree));
            }
        }
        const auto stage = fmt::format("incidence {} of {}", i + 1, thetas);
        const std::vector<double> values =
            PolarPlane(source, grid, std::move(places), grid.azimuth_deg.size())
                .values(stage, job.control);
        for (std::size_t d = 0; d < angles.size(); ++d) {
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
    format.accepted.plain = 0.05;
    return format;
}

Format astm_format() {
    Format format = angle_format("astm", 9, write_astm, astm_reader());
    format.readers = "libbsdf, BSDF Processor, measurement software";
    format.endings = {".astm"};
    format.accepted.plain = 0.1;
    return format;
}

}  // namespace miebrdf
