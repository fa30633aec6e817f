// rgl: the measured materials of RGL (EPFL), which Mitsuba 3 and pbrt-v4 call `measured`.
// docs/formats/rgl.md
#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <nlohmann/json.hpp>
#include <numbers>

#include "pipeline/formats/common/export_job.h"
#include "pipeline/formats/common/tensor_writer.h"
#include "pipeline/formats/rgl/half_vector_table.h"

namespace miebrdf {

FormatReader rgl_reader();  // reader.cpp

namespace {

constexpr double kHalfPi = std::numbers::pi / 2;
/// The last incident angle is stored as 90 degrees but computed here: at 90 itself nothing arrives.
constexpr double kLargestAngle = 89.9 * kDegree;
/// Incident angles crowd at the horizon, where the BRDF bends: at mu = 0.1 the albedo is 0.1 % off
/// instead of 0.9 % with equal steps (24 angles, test material, tests/formats/read_back_test.cpp).
constexpr double kCrowding = 1.75;
/// Stands for the horizon, where mu = 0 is no direction.
constexpr double kHorizon = 1e-9;
/// Every half vector stays reachable by importance sampling, however dark it is.
constexpr double kLuminanceFloor = 1e-6;

/// The value stored at half vector (x, y) of incident angle t: BRDF * cos(theta_out), as readers
/// compute it with ndf = 1, sigma = 1/4 and an identity warp (vndf = 1).
class RglGrid {
  public:
    RglGrid(const BrdfSource& source, const ExportOptions& options)
        : source_(source),
          n_(static_cast<std::size_t>(options.resolution)),
          angles_(static_cast<std::size_t>(options.extra.at("incident_angles"))),
          channels_(source.channels().size()) {}

    void fill(const Control& control) {
        spectra_.assign(angles_ * channels_ * n_ * n_, 0.0f);
        luminance_.assign(angles_ * n_ * n_, 0.0f);
        for (std::size_t t = 0; t < angles_; ++t) fill_incidence(t, control);
    }

    std::vector<TensorField> fields(const std::string& description) {
        std::vector<float> theta(angles_);
        for (std::size_t t = 0; t < angles_; ++t) theta[t] = static_cast<float>(theta_in(t));
        std::vector<TensorField> fields;
        fields.push_back(byte_field("description", description));
        fields.push_back(float_field("phi_i", {1}, {0.0f}));
        fields.push_back(float_field("theta_i", {angles_}, std::move(theta)));
        fields.push_back(float_field("ndf", {2, 2}, std::vector<float>(4, 1.0f)));
        fields.push_back(float_field("sigma", {2, 2}, std::vector<float>(4, 0.25f)));
        fields.push_back(
            float_field("vndf", {1, angles_, 2, 2}, std::vector<float>(4 * angles_, 1.0f)));
        fields.push_back(float_field("luminance", {1, angles_, n_, n_}, std::move(luminance_)));
        fields.push_back(byte_field("jacobian", "\1"));
        if (source_.wavelength_nm().empty()) {
            fields.push_back(
                float_field("rgb", {1, angles_, channels_, n_, n_}, std::move(spectra_)));
        } else {
            std::vector<float> wavelengths(source_.wavelength_nm().begin(),
                                           source_.wavelength_nm().end());
            fields.push_back(float_field("wavelengths", {channels_}, std::move(wavelengths)));
            fields.push_back(
                float_field("spectra", {1, angles_, channels_, n_, n_}, std::move(spectra_)));
        }
        return fields;
    }

  private:
    double theta_in(std::size_t t) const {
        const double x = static_cast<double>(t) / static_cast<double>(angles_ - 1);
        return kHalfPi * (1.0 - std::pow(1.0 - x, kCrowding));
    }

    void fill_incidence(std::size_t t, const Control& control) {
        const Eigen::Vector3d in = spherical(std::min(theta_in(t), kLargestAngle), 0.0);
        const HalfVectorTable table(n_, in);
        std::vector<Direction> directions;
        std::vector<double> cosines;
        for (const std::size_t node : table.needed()) {
            const Eigen::Vector3d out = table.outgoing(node);
            Direction d = direction_of(in, out);
            d.mu_out = std::clamp(std::abs(out.z()), kHorizon, 1.0);
            directions.push_back(d);
            cosines.push_back(out.z());
        }
        const auto stage = fmt::format("incidence {} of {}", t + 1, angles_);
        const std::vector<double> values = evaluate_all(source_, directions, stage, control);
        std::vector<double> fitted(table.size()), mean(table.size(), 0.0);
        for (std::size_t c = 0; c < channels_; ++c) {
            for (std::size_t i = 0; i < cosines.size(); ++i)
                fitted[table.needed()[i]] = values[i * channels_ + c] * cosines[i];
            table.fit(fitted);
            std::copy(fitted.begin(), fitted.end(),
                      spectra_.begin() + (t * channels_ + c) * table.size());
            for (std::size_t i = 0; i < mean.size(); ++i) mean[i] += fitted[i];
        }
        for (std::size_t i = 0; i < mean.size(); ++i)
            luminance_[t * table.size() + i] = luminance(mean[i] / double(channels_), table, i);
    }

    /// Readers divide the density of (x, y) by the Jacobian to get one per solid angle; times it,
    /// sampling by luminance follows BRDF * cosine.
    static float luminance(double mean, const HalfVectorTable& table, std::size_t node) {
        return static_cast<float>(std::max(mean * table.jacobian(node), kLuminanceFloor));
    }

    const BrdfSource& source_;
    std::size_t n_, angles_, channels_;
    std::vector<float> spectra_, luminance_;
};

void write_rgl(const BrdfSource& source, const std::string& colour, const ExportJob& job,
               std::ostream& out) {
    RglGrid grid(source, job.options);
    grid.fill(job.control);
    const auto description = metadata(source, {.format = "rgl",
                                               .cosine_included = true,
                                               .azimuth_zero = "towards the source",
                                               .colour = colour});
    write_tensor_file(grid.fields(description.dump(1)), out);
}

/// Every wavelength, for pbrt-v4 and Mitsuba's spectral variants.
void write_rgl_spectral(const ExportJob& job, std::ostream& out) {
    write_rgl(job.spectral, "", job, out);
}

/// For Mitsuba's RGB variants; they refuse the spectral file.
void write_rgl_rgb(const ExportJob& job, std::ostream& out) {
    write_rgl(job.rgb, job.rgb.weights().description, job, out);
}

/// The spectral file has a slice for each wavelength and one of luminance at every incidence.
std::uintmax_t rgl_bytes(const ExportOptions& options, std::size_t wavelengths) {
    const auto n = static_cast<std::uintmax_t>(options.resolution);
    const auto angles = static_cast<std::uintmax_t>(options.extra.at("incident_angles"));
    return angles * (wavelengths + 1) * n * n * sizeof(float);
}

}  // namespace

Format rgl_format() {
    return {.name = "rgl",
            .readers = "Mitsuba 3 and pbrt-v4 `measured`, powitacq, Tekari",
            .holds = "every wavelength (and RGB in a second file), importance sampling",
            .endings = {".bsdf"},
            .content = FormatContent::sampled,
            .resolution = {"half vectors a side", 64, 4, 1024, 256},
            .takes_colours = true,
            .extra = {{.name = "incident_angles",
                       .help = "angles of incidence, from the normal to the horizon",
                       .standard = 24,
                       .lowest = 2,
                       .highest = 512}},
            .accepted = {.plain = 0.05},
            .needs_ascending_wavelengths = true,
            .expected_bytes = rgl_bytes,
            .files = {{.suffix = "_spec", .write = write_rgl_spectral},
                      {.suffix = "_rgb", .colours = true, .write = write_rgl_rgb}},
            .reader = rgl_reader()};
}

}  // namespace miebrdf
