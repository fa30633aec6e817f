// merl: the MERL `.binary` table. docs/formats/merl.md
#include <cmath>
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
/// What readers multiply the stored numbers by, upside down.
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

/// Half of the bins of one half angle.
std::vector<VectorPair> pairs_of(std::size_t half_bin, double shift) {
    const double position = (static_cast<double>(half_bin) + shift) / kHalfBins;
    const double theta_h = position * position * std::numbers::pi / 2;
    std::vector<VectorPair> pairs;
    pairs.reserve(kDifferenceBins * kComputedAzimuths);
    for (std::size_t d = 0; d < kDifferenceBins; ++d) {
        for (std::size_t p = 0; p < kComputedAzimuths; ++p) {
            pairs.push_back(from_half_difference(theta_h,
                                                 (static_cast<double>(d) + shift) * kDegree,
                                                 (static_cast<double>(p) + shift) * kDegree));
        }
    }
    return pairs;
}

/// 90 x 90 x 180 bins of (half angle, difference angle, azimuth of the difference), three channels
/// of doubles, 34,992,012 bytes always. Bins that no pair of directions reaches hold -1.
void write_merl(const ExportJob& job, std::ostream& out) {
    const double shift = job.options.extra.at("bin_centres") != 0 ? 0.5 : 0.0;
    std::vector<double> table(3 * kHalfBins * kPlane, -1.0);
    run_parallel("half angles", kHalfBins, job.control, [&](std::size_t h) {
        std::vector<Direction> directions;
        std::vector<std::size_t> bins;
        const std::vector<VectorPair> pairs = pairs_of(h, shift);
        for (std::size_t i = 0; i < pairs.size(); ++i) {
            if (!(pairs[i].in.z() > 0.0 && pairs[i].out.z() > 0.0)) continue;
            directions.push_back(direction_of(pairs[i].in, pairs[i].out));
            bins.push_back(i);
        }
        std::vector<double> values(3 * directions.size());
        job.rgb.evaluate(directions, values);
        for (std::size_t i = 0; i < bins.size(); ++i) {
            const std::size_t p = bins[i] % kComputedAzimuths;
            const std::size_t first = h * kPlane + bins[i] / kComputedAzimuths * kAzimuthBins;
            for (std::size_t c = 0; c < 3; ++c) {
                // Out-of-gamut colours are negative, which would read as "no value".
                const double value = std::max(values[3 * i + c], 0.0) * kScale[c];
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
