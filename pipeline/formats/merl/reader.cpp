// MERL tables, interpolated between the lower edges of their bins as libbsdf does.
#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>

#include <miebrdf/brdf_source.h>
#include <miebrdf/formats.h>
#include "pipeline/formats/common/byte_reader.h"
#include "pipeline/solve/vector_pairs.h"

namespace miebrdf {
namespace {

constexpr std::uint32_t kHalf = 90, kDifference = 90, kAzimuth = 180;
constexpr std::size_t kBins = std::size_t{kHalf} * kDifference * kAzimuth;
constexpr double kFactor[3] = {1.0 / 1500.0, 1.15 / 1500.0, 1.66 / 1500.0};
using std::numbers::pi;

/// Rusinkiewicz's angles; phi_d in [0, pi), its other half being the same by reciprocity.
struct HalfDifference {
    double theta_h, theta_d, phi_d;
};

HalfDifference half_difference(const Direction& d) {
    const VectorPair pair = vectors_of(d);
    const Eigen::Vector3d half = (pair.in + pair.out).normalized();
    const double sin_h = std::hypot(half.x(), half.y()), cos_h = half.z();
    const double cos_p = sin_h > 0 ? half.x() / sin_h : 1.0;
    const double sin_p = sin_h > 0 ? half.y() / sin_h : 0.0;
    // Turn by -phi_h about the normal, then by -theta_h about y: the half vector becomes the pole.
    const double x = pair.in.x() * cos_p, y = -pair.in.x() * sin_p, z = pair.in.z();
    const double dx = cos_h * x - sin_h * z, dz = sin_h * x + cos_h * z;
    double phi = std::atan2(y, dx);
    if (phi < 0) phi += pi;
    return {std::atan2(sin_h, cos_h), std::atan2(std::hypot(dx, y), dz), phi};
}

class MerlFile : public BrdfFile {
  public:
    explicit MerlFile(std::string content) : content_(std::move(content)) {
        ByteReader bytes(content_);
        bytes.take(12);
        values_ = bytes.view<double>(3 * kBins);
        if (bytes.remaining() > 0) {
            throw InputError(fmt::format("merl: {} bytes after the last bin", bytes.remaining()));
        }
    }

    std::string format() const override { return "merl"; }
    std::string description() const override { return "90 x 90 x 180 half and difference angles"; }
    const std::vector<std::string>& channels() const override { return channels_; }
    const std::vector<double>& wavelength_nm() const override { return no_wavelengths_; }

    /// Linear in the three angles; as in libbsdf, bins without a value (negative) count as black,
    /// and a direction is missing only where no bin around it has a value.
    void look_up(const Direction& direction, std::span<double> values) const override {
        const HalfDifference angles = half_difference(direction);
        const Axis h = half_axis(angles.theta_h / (pi / 2) * kHalf);
        const Axis d = axis(angles.theta_d / (pi / 2) * kDifference, kDifference);
        const double position = std::clamp(angles.phi_d / pi * kAzimuth, 0.0, kAzimuth - 1e-9);
        const auto p0 = static_cast<std::uint32_t>(position);
        const Axis p = {p0, (p0 + 1) % kAzimuth, position - p0};
        for (std::size_t c = 0; c < 3; ++c) {
            double sum = 0.0;
            bool found = false;
            for (int corner = 0; corner < 8; ++corner) {
                const double weight =
                    h.weight(corner & 1) * d.weight(corner & 2) * p.weight(corner & 4);
                const double value =
                    values_[c * kBins + p.index(corner & 4) + kAzimuth * d.index(corner & 2) +
                            std::size_t{kAzimuth} * kDifference * h.index(corner & 1)];
                if (weight == 0.0 || !(value >= 0.0)) continue;
                sum += weight * value;
                found = true;
            }
            values[c] = found ? sum * kFactor[c] : std::numeric_limits<double>::quiet_NaN();
        }
    }

  private:
    struct Axis {
        std::uint32_t low, high;
        double share;
        double weight(int upper) const { return upper ? share : 1.0 - share; }
        std::size_t index(int upper) const { return upper ? high : low; }
    };

    /// Beyond the lower edge of the last bin its value stays.
    static Axis axis(double position, std::uint32_t count) {
        const double inside = std::clamp(position, 0.0, count - 1e-9);
        const auto low = static_cast<std::uint32_t>(inside);
        return {low, std::min(low + 1, count - 1), inside - low};
    }

    /// Bin i begins at i^2 / 90 degrees.
    static Axis half_axis(double degrees) {
        const Axis bin = axis(std::sqrt(kHalf * degrees), kHalf);
        const double low = double(bin.low) * bin.low / kHalf;
        const double width = (2.0 * bin.low + 1.0) / kHalf;
        return {bin.low, bin.high, std::clamp((degrees - low) / width, 0.0, 1.0)};
    }

    std::string content_;
    RealView<double> values_;  ///< of the content
    std::vector<std::string> channels_ = {"R", "G", "B"};
    std::vector<double> no_wavelengths_;
};

Recognised recognise_merl(std::string_view content) {
    if (content.size() < 12) return Recognised::no;
    ByteReader bytes(content);
    const auto half = bytes.number<std::uint32_t>();
    const auto difference = bytes.number<std::uint32_t>();
    const auto azimuth = bytes.number<std::uint32_t>();
    const bool found = half == kHalf && difference == kDifference && azimuth == kAzimuth;
    return found ? Recognised::by_first_bytes : Recognised::no;
}

std::unique_ptr<BrdfFile> read_merl(std::string content) {
    return std::make_unique<MerlFile>(std::move(content));
}

}  // namespace

FormatReader merl_reader() { return {recognise_merl, read_merl}; }

}  // namespace miebrdf
