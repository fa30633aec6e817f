// Polarised BRDFs as Mitsuba 3's `measured_polarized` evaluates them: linear in the three angles
// and the wavelength.
#include <fmt/format.h>

#include <Eigen/Dense>
#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>

#include <miebrdf/brdf_source.h>
#include <miebrdf/formats.h>
#include "pipeline/formats/common/tensor_reader.h"
#include "pipeline/solve/vector_pairs.h"

namespace miebrdf {
namespace {

using std::numbers::pi;

/// Angles of one axis, ascending; clamped at both ends.
struct PbsdfAxis {
    std::vector<double> nodes;

    struct Place {
        std::size_t low, high;
        double share;  ///< of high
    };
    Place locate(double value) const {
        const auto above = std::upper_bound(nodes.begin(), nodes.end(), value) - nodes.begin();
        const std::size_t last = nodes.size() - 1;
        const std::size_t low =
            std::min<std::size_t>(last, above > 0 ? static_cast<std::size_t>(above) - 1 : 0);
        const std::size_t high = std::min(last, low + 1);
        const double width = nodes[high] - nodes[low];
        return {low, high, width > 0 ? std::clamp((value - nodes[low]) / width, 0.0, 1.0) : 0.0};
    }
};

PbsdfAxis read_axis(const TensorFields& fields, const std::string& name, double lowest,
                    double highest) {
    const Tensor& field = tensor(fields, name, 2);
    const RealView<float> values = tensor_floats(fields, name);
    if (field.shape[0] != 1 || values.size() < 2)
        throw InputError(fmt::format("pbsdf: '{}' is no list of at least two angles", name));
    constexpr double rounding = 1e-5;
    PbsdfAxis axis;
    for (std::size_t i = 0; i < values.size(); ++i) {
        const double angle = values[i];
        const bool ascends = axis.nodes.empty() || angle > axis.nodes.back();
        if (!(angle >= lowest - rounding && angle <= highest + rounding && ascends)) {
            throw InputError(fmt::format("pbsdf: '{}' is not ascending in [{:.3g}, {:.3g}] radians",
                                         name, lowest, highest));
        }
        axis.nodes.push_back(angle);
    }
    return axis;
}

std::vector<double> read_wavelengths(const TensorFields& fields) {
    const Tensor& field = tensor(fields, "wvls", 1);
    if (field.type != kTensorShort || field.shape[0] == 0)
        throw InputError("pbsdf: 'wvls' is no list of unsigned 16-bit numbers");
    ByteReader bytes(field.bytes);
    std::vector<double> wavelengths;
    for (std::uint64_t i = 0; i < field.shape[0]; ++i) {
        const double nm = bytes.number<std::uint16_t>();
        if (!(nm > 0 && (wavelengths.empty() || nm > wavelengths.back())))
            throw InputError("pbsdf: 'wvls' is not ascending");
        wavelengths.push_back(nm);
    }
    return wavelengths;
}

/// The rays of a direction, away from the surface: the light's in the x-z plane.
struct Rays {
    Eigen::Vector3d light, eye;

    explicit Rays(const Direction& d) {
        const auto [in, out] = vectors_of(d);
        light = {-in.x(), 0.0, in.z()};
        eye = {-out.x(), out.y(), out.z()};
    }
};

struct Rusinkiewicz {
    double phi_d, theta_d, theta_h;

    explicit Rusinkiewicz(const Rays& rays) {
        const Eigen::Vector3d half = (rays.light + rays.eye).normalized();
        const Eigen::Vector3d normal(0, 0, 1);
        Eigen::Vector3d b = normal.cross(half);
        b = b.norm() > 0 ? Eigen::Vector3d(b.normalized()) : Eigen::Vector3d(0, 1, 0);
        const Eigen::Vector3d t = b.cross(half);
        const Eigen::Vector3d rest = rays.light - rays.light.dot(half) * half;
        phi_d = std::atan2(b.dot(rest), t.dot(rest));
        theta_d = std::atan2(rest.norm(), rays.light.dot(half));
        theta_h = std::atan2(std::hypot(half.x(), half.y()), half.z());
    }
};

/// Turns Stokes vectors of light that travels along `ray` from one axis to another, both across it:
/// by twice the angle, counterclockwise for who is met by the light.
Eigen::Matrix4d turn(const Eigen::Vector3d& ray, const Eigen::Vector3d& from,
                     const Eigen::Vector3d& to) {
    const double angle = std::atan2(ray.dot(from.cross(to)), from.dot(to));
    Eigen::Matrix4d result = Eigen::Matrix4d::Identity();
    result(1, 1) = result(2, 2) = std::cos(2 * angle);
    result(1, 2) = std::sin(2 * angle);
    result(2, 1) = -result(1, 2);
    return result;
}

class PbsdfFile : public BrdfFile {
  public:
    explicit PbsdfFile(std::string content) : content_(std::move(content)) {
        const TensorFields fields = read_tensor_file(content_);
        phi_d_ = read_axis(fields, "phi_d", -pi, pi);
        theta_d_ = read_axis(fields, "theta_d", 0, pi / 2);
        theta_h_ = read_axis(fields, "theta_h", 0, pi / 2);
        wavelength_nm_ = read_wavelengths(fields);
        channels_ = channel_names(wavelength_nm_);
        const Tensor& matrices = tensor(fields, "M", 6);
        const std::vector<std::uint64_t> expected = {phi_d_.nodes.size(),
                                                     theta_d_.nodes.size(),
                                                     theta_h_.nodes.size(),
                                                     wavelength_nm_.size(),
                                                     4,
                                                     4};
        if (matrices.shape != expected)
            throw InputError("pbsdf: the shape of 'M' does not fit its axes");
        values_ = tensor_floats(fields, "M");
    }

    std::string format() const override { return "pbsdf"; }
    std::string description() const override {
        return fmt::format("{} x {} x {} Mueller matrices (phi_d, theta_d, theta_h)",
                           phi_d_.nodes.size(), theta_d_.nodes.size(), theta_h_.nodes.size());
    }
    const std::vector<std::string>& channels() const override { return channels_; }
    const std::vector<double>& wavelength_nm() const override { return wavelength_nm_; }
    int components() const override { return 4; }

    /// Where one of the nodes around it has no value (NaN: measured materials), Mitsuba is black.
    void look_up(const Direction& direction, std::span<double> values) const override {
        const Rusinkiewicz angles{Rays(direction)};
        for (std::size_t w = 0; w < wavelength_nm_.size(); ++w) {
            const double value = element(angles, w, 0);
            values[w] = std::isnan(value) ? 0.0 : std::max(0.0, value);
        }
    }

    void look_up_mueller(const Direction& direction, std::span<double> values) const override {
        const Rays rays(direction);
        const Rusinkiewicz angles(rays);
        // The file's axis, across both rays; where they are the same, whichever their azimuths say.
        const Eigen::Vector3d in = -rays.light, out = rays.eye;
        Eigen::Vector3d across = out.cross(rays.light);
        if (across.norm() < 1e-12) across = Eigen::Vector3d(0, 1, 0);
        across.normalize();
        const Eigen::Matrix4d from_in = turn(in, meridian(in, 0.0), across);
        const Eigen::Matrix4d to_out =
            turn(out, across, meridian(out, direction.azimuth_deg * pi / 180));
        for (std::size_t w = 0; w < wavelength_nm_.size(); ++w) {
            Eigen::Matrix4d M;
            for (std::size_t e = 0; e < 16; ++e)
                M(Eigen::Index(e / 4), Eigen::Index(e % 4)) = element(angles, w, e);
            M = (to_out * M * from_in).eval();
            M.row(3) = -M.row(3);
            M.col(3) = -M.col(3);
            for (std::size_t e = 0; e < 16; ++e)
                values[16 * w + e] = M(Eigen::Index(e / 4), Eigen::Index(e % 4));
        }
    }

  private:
    /// The axis in the plane of the ray and the normal, at the ray's azimuth.
    static Eigen::Vector3d meridian(const Eigen::Vector3d& ray, double azimuth) {
        const double sine = std::hypot(ray.x(), ray.y());
        return {ray.z() * std::cos(azimuth), ray.z() * std::sin(azimuth), -sine};
    }

    double element(const Rusinkiewicz& angles, std::size_t wavelength, std::size_t element) const {
        const std::array places = {phi_d_.locate(angles.phi_d), theta_d_.locate(angles.theta_d),
                                   theta_h_.locate(angles.theta_h)};
        double sum = 0.0;
        for (int corner = 0; corner < 8; ++corner) {
            double weight = 1.0;
            std::array<std::size_t, 3> at{};
            for (std::size_t axis = 0; axis < 3; ++axis) {
                const bool upper = (corner >> axis & 1) != 0;
                at[axis] = upper ? places[axis].high : places[axis].low;
                weight *= upper ? places[axis].share : 1.0 - places[axis].share;
            }
            if (weight == 0.0) continue;
            const std::size_t node =
                (at[0] * theta_d_.nodes.size() + at[1]) * theta_h_.nodes.size() + at[2];
            sum += weight * values_[(node * wavelength_nm_.size() + wavelength) * 16 + element];
        }
        return sum;
    }

    std::string content_;
    PbsdfAxis phi_d_, theta_d_, theta_h_;
    std::vector<double> wavelength_nm_;
    std::vector<std::string> channels_;
    RealView<float> values_;  ///< of the content
};

Recognised recognise_pbsdf(std::string_view content) {
    if (!content.starts_with(std::string_view("tensor_file\0", 12))) return Recognised::no;
    try {
        return read_tensor_file(content).contains("theta_h") ? Recognised::by_first_bytes
                                                             : Recognised::no;
    } catch (const InputError&) {  // whoever reads it says what is wrong
        return Recognised::no;
    }
}

std::unique_ptr<BrdfFile> read_pbsdf(std::string content) {
    return std::make_unique<PbsdfFile>(std::move(content));
}

}  // namespace

FormatReader pbsdf_reader() { return {recognise_pbsdf, read_pbsdf}; }

}  // namespace miebrdf
