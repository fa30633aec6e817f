// merl: the MERL `.binary` table. docs/formats/merl.md
#include <array>
#include <cmath>
#include <limits>
#include <nlohmann/json.hpp>
#include <numbers>

#include "pipeline/formats/common/byte_writer.h"
#include "pipeline/formats/common/export_job.h"
#include "pipeline/solve/parallel.h"
#include "pipeline/solve/vector_pairs.h"

namespace miebrdf {

FormatReader merl_reader();  // reader.cpp

namespace {

constexpr std::size_t kHalfBins = 90, kDifferenceBins = 90, kAzimuthBins = 180;
constexpr std::size_t kPlane = kDifferenceBins * kAzimuthBins;
/// Azimuths p and 180 - p degrees are the same pair of directions with light and viewer exchanged,
/// mirrored: the values of a reciprocal BRDF, the only one that the format holds, are equal.
constexpr std::size_t kComputedAzimuths = kAzimuthBins / 2 + 1;
/// The inverse of the factors that readers multiply the stored numbers by.
constexpr double kScale[3] = {1500.0 / 1.0, 1500.0 / 1.15, 1500.0 / 1.66};

/// Rusinkiewicz's angles to a pair of vectors: the half vector tilted by theta_h in the x-z plane,
/// the incident one by (theta_d, phi_d) about it.
VectorPair from_half_difference(double theta_h, double theta_d, double phi_d) {
    const Eigen::Vector3d difference = spherical(theta_d, phi_d);
    const Eigen::Vector3d in(
        std::cos(theta_h) * difference.x() + std::sin(theta_h) * difference.z(), difference.y(),
        -std::sin(theta_h) * difference.x() + std::cos(theta_h) * difference.z());
    return {in, mirrored(in, spherical(theta_h, 0.0))};
}

/// The bin of 180 degrees minus the azimuth of bin p.
std::size_t mirrored_bin(std::size_t p, double shift) {
    return shift > 0.0 ? kAzimuthBins - 1 - p : (kAzimuthBins - p) % kAzimuthBins;
}

/// Angles of one bin, at its lower edges or centres.
struct BinAngles {
    double theta_h, theta_d, phi_d;
};

/// The difference angle may be any: features of the phase function depend on it alone.
BinAngles angles_of(std::size_t half_bin, double difference, std::size_t azimuth_bin,
                    double shift) {
    const double position = (static_cast<double>(half_bin) + shift) / kHalfBins;
    return {position * position * std::numbers::pi / 2, difference * kDegree,
            (static_cast<double>(azimuth_bin) + shift) * kDegree};
}

/// The bins of one half angle, half of their azimuths: [d * kComputedAzimuths + p], three colours
/// each; not a number where no pair of directions is above the horizon.
class HalfPlane {
  public:
    HalfPlane(const RgbSource& source, std::size_t half_bin, double shift)
        : source_(source), half_bin_(half_bin), shift_(shift) {
        std::vector<Place> places;
        for (std::size_t bin = 0; bin < kDifferenceBins * kComputedAzimuths; ++bin)
            places.push_back({bin, double(bin / kComputedAzimuths) + shift});
        values_.assign(3 * places.size(), std::numeric_limits<double>::quiet_NaN());
        for (const auto& [bin, rgb] : evaluate(places))
            std::copy(rgb.begin(), rgb.end(), values_.begin() + std::ptrdiff_t(3 * bin));
        average_peaks();
    }

    const double* at(std::size_t bin) const { return &values_[3 * bin]; }

  private:
    struct Place {
        std::size_t bin;
        double difference;  ///< degrees
    };
    using Found = std::pair<std::size_t, std::array<double, 3>>;

    std::vector<Found> evaluate(const std::vector<Place>& places) const {
        std::vector<Direction> directions;
        std::vector<Found> found;
        for (const Place& place : places) {
            const BinAngles angles =
                angles_of(half_bin_, place.difference, place.bin % kComputedAzimuths, shift_);
            const VectorPair pair =
                from_half_difference(angles.theta_h, angles.theta_d, angles.phi_d);
            if (!(pair.in.z() > 0.0 && pair.out.z() > 0.0)) continue;
            directions.push_back(direction_of(pair.in, pair.out));
            found.push_back({place.bin, {}});
        }
        std::vector<double> values(3 * directions.size());
        source_.evaluate(directions, values);
        for (std::size_t i = 0; i < values.size(); ++i) found[i / 3].second[i % 3] = values[i];
        return found;
    }

    /// Glories and rainbows may be narrower than a bin: where neighbours along the difference angle
    /// are not on a line, and at retro-reflection, a bin holds the mean that its reader gives it,
    /// over a triangle (linear interpolation between lower edges) or over itself.
    void average_peaks() {
        constexpr int kPoints = 16;
        std::vector<Place> places;
        std::vector<std::size_t> bins;
        for (std::size_t bin = 0; bin < kDifferenceBins * kComputedAzimuths; ++bin) {
            if (!is_grazing(bin) && bends(bin)) bins.push_back(bin);
        }
        for (const std::size_t bin : bins) {
            const double difference = double(bin / kComputedAzimuths) + shift_;
            for (int p = 0; p < kPoints; ++p) {
                const double x = 2.0 * (p + 0.5) / kPoints - 1.0;
                const double width = 1.0 - std::sqrt(1.0 - std::abs(x));  // of a triangle
                const double moved = shift_ > 0.0 ? 0.5 * x : std::copysign(width, x);
                places.push_back({bin, std::abs(difference + moved)});
            }
        }
        std::vector<double> sums(values_.size(), 0.0), counts(values_.size() / 3, 0.0);
        for (const auto& [bin, rgb] : evaluate(places)) {
            for (std::size_t c = 0; c < 3; ++c) sums[3 * bin + c] += rgb[c];
            counts[bin] += 1.0;
        }
        for (const std::size_t bin : bins) {
            for (std::size_t c = 0; c < 3 && counts[bin] > 0.0; ++c)
                values_[3 * bin + c] = sums[3 * bin + c] / counts[bin];
        }
    }

    /// Near the horizon a BRDF changes by orders of magnitude within a bin: its mean would be that
    /// of the last degree.
    bool is_grazing(std::size_t bin) const {
        constexpr double kLowest = 0.2;
        const BinAngles angles = angles_of(half_bin_, double(bin / kComputedAzimuths) + shift_,
                                           bin % kComputedAzimuths, shift_);
        const VectorPair pair = from_half_difference(angles.theta_h, angles.theta_d, angles.phi_d);
        return !(pair.in.z() > kLowest && pair.out.z() > kLowest);
    }

    bool bends(std::size_t bin) const {
        constexpr double kStraight = 0.05;  // of the value: the mean is off by a twelfth of it
        const std::size_t d = bin / kComputedAzimuths;
        const std::size_t below = d == 0 ? bin + kComputedAzimuths : bin - kComputedAzimuths;
        const std::size_t above = d + 1 < kDifferenceBins ? bin + kComputedAzimuths : bin;
        for (std::size_t c = 0; c < 3; ++c) {
            const double here = values_[3 * bin + c];
            const double bend = values_[3 * below + c] - 2.0 * here + values_[3 * above + c];
            if (std::abs(bend) > kStraight * here) return true;  // not beside the horizon: NaN
        }
        return false;
    }

    const RgbSource& source_;
    std::size_t half_bin_;
    double shift_;
    std::vector<double> values_;
};

/// 90 x 90 x 180 bins of (half angle, difference angle, azimuth of the difference), three channels
/// of doubles, 34,992,012 bytes always. Bins that no pair of directions reaches hold -1.
void write_merl(const ExportJob& job, std::ostream& out) {
    const double shift = job.options.extra.at("bin_centres") != 0 ? 0.5 : 0.0;
    std::vector<double> table(3 * kHalfBins * kPlane, -1.0);
    run_parallel("half angles", kHalfBins, job.control, [&](std::size_t h) {
        const HalfPlane plane(job.rgb, h, shift);
        for (std::size_t bin = 0; bin < kDifferenceBins * kComputedAzimuths; ++bin) {
            const double* rgb = plane.at(bin);
            if (std::isnan(rgb[0])) continue;
            const std::size_t p = bin % kComputedAzimuths;
            const std::size_t first = h * kPlane + bin / kComputedAzimuths * kAzimuthBins;
            for (std::size_t c = 0; c < 3; ++c) {
                // Out-of-gamut colours are negative, which would read as "no value".
                const double value = std::max(rgb[c], 0.0) * kScale[c];
                table[c * kHalfBins * kPlane + first + p] = value;
                table[c * kHalfBins * kPlane + first + mirrored_bin(p, shift)] = value;
            }
        }
    });
    ByteWriter bytes(out);
    for (const std::size_t extent : {kHalfBins, kDifferenceBins, kAzimuthBins}) {
        bytes.put(static_cast<std::int32_t>(extent));
    }
    bytes.put_all(table);
}

/// The one format without room for a word.
std::string merl_sidecar(const ExportJob& job) {
    auto description = metadata(job.rgb, {.format = "merl",
                                          .cosine_included = false,
                                          .azimuth_zero = "difference angle, Rusinkiewicz",
                                          .colour = job.rgb.weights().description});
    description["wavelength_nm"] = job.spectral.wavelength_nm();
    return description.dump(1) + '\n';
}

}  // namespace

Format merl_format() {
    return {.name = "merl",
            .readers = "BRDF Explorer, libbsdf and many research codes",
            .holds = "RGB, 90 x 90 x 180 bins",
            .endings = {".binary"},
            .content = FormatContent::sampled,
            .resolution = {"bins", 90, 90, 90, 90},
            .takes_colours = true,
            // Programs that interpolate (libbsdf) want the lower edge of a bin; programs that take
            // the bin as it is (BRDF Explorer) are served better by its centre.
            .extra = {{.name = "bin_centres",
                       .help = "sample bins at their centres, for readers that do not interpolate",
                       .is_switch = true}},
            .files = {{.colours = true, .write = write_merl}},
            .sidecar = merl_sidecar,
            .reader = merl_reader()};
}

}  // namespace miebrdf
