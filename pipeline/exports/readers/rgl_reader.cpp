// RGL's measured materials, isotropic, evaluated as powitacq, Mitsuba 3 and pbrt-v4 do.
#include <fmt/format.h>

#include <Eigen/Core>
#include <algorithm>
#include <cmath>
#include <numbers>

#include "pipeline/error.h"
#include "pipeline/exports/readers/bilinear_warp.h"
#include "pipeline/exports/readers/brdf_file.h"
#include "pipeline/exports/readers/tensor_file_reader.h"

namespace miebrdf::exports {
namespace {

constexpr double kPi = std::numbers::pi;

/// A stack of equal tables, one for each incident angle (and channel), where they are in the file.
struct Slices {
    RealView<float> values;
    std::size_t nx = 0, ny = 0;

    double at(std::size_t slice, std::size_t x, std::size_t y) const {
        return values[(slice * ny + y) * nx + x];
    }
    double bilinear(std::size_t slice, Point2 p) const {
        const double x = std::clamp(p.x, 0.0, 1.0) * static_cast<double>(nx - 1);
        const double y = std::clamp(p.y, 0.0, 1.0) * static_cast<double>(ny - 1);
        const std::size_t c = std::min(nx - 2, static_cast<std::size_t>(x));
        const std::size_t r = std::min(ny - 2, static_cast<std::size_t>(y));
        const double s = x - static_cast<double>(c), t = y - static_cast<double>(r);
        return (1 - t) * ((1 - s) * at(slice, c, r) + s * at(slice, c + 1, r)) +
               t * ((1 - s) * at(slice, c, r + 1) + s * at(slice, c + 1, r + 1));
    }
};

std::vector<float> all_of(const RealView<float>& numbers) {
    std::vector<float> list(numbers.size());
    for (std::size_t i = 0; i < list.size(); ++i) list[i] = numbers[i];
    return list;
}

/// theta = u^2 pi / 2, phi = (2 u - 1) pi.
Point2 square_of(const Eigen::Vector3d& m) {
    const double theta = std::atan2(std::hypot(m.x(), m.y()), m.z());
    const double phi = std::atan2(m.y(), m.x());
    return {std::sqrt(2.0 * theta / kPi), (phi + kPi) / (2.0 * kPi)};
}

Eigen::Vector3d on_sphere(double theta, double phi) {
    return {std::sin(theta) * std::cos(phi), std::sin(theta) * std::sin(phi), std::cos(theta)};
}

class RglFile : public BrdfFile {
  public:
    explicit RglFile(std::string content) : content_(std::move(content)) {
        const auto fields = read_tensor_file(content_);
        if (tensor(fields, "phi_i", 1).shape[0] > 2) {
            throw InputError("rgl: the material is anisotropic; only isotropic ones are read here");
        }
        theta_ = all_of(tensor_floats(fields, "theta_i"));
        for (std::size_t t = 0; t < theta_.size(); ++t) {
            if (!(theta_[t] >= (t == 0 ? 0.0f : theta_[t - 1]) && theta_[t] < 1.6f)) {
                throw InputError("rgl: theta_i is not ascending in [0, pi/2]");
            }
        }
        ndf_ = slices(fields, "ndf", 2, 1);
        sigma_ = slices(fields, "sigma", 2, 1);
        vndf_ = slices(fields, "vndf", 4, theta_.size());
        luminance_ = slices(fields, "luminance", 4, theta_.size());
        read_channels(fields);
        const bool spectral = !wavelength_nm_.empty();
        spectra_ =
            slices(fields, spectral ? "spectra" : "rgb", 5, theta_.size() * channels_.size());
        const Tensor& jacobian = tensor(fields, "jacobian", 1);
        jacobian_ = !jacobian.bytes.empty() && jacobian.bytes[0] != 0;
    }

    std::string format() const override { return "rgl"; }
    std::string description() const override {
        return fmt::format("{} x {} half vectors at {} incident angles, {}", spectra_.nx,
                           spectra_.ny, theta_.size(), wavelength_nm_.empty() ? "RGB" : "spectral");
    }
    const std::vector<std::string>& channels() const override { return channels_; }
    const std::vector<double>& wavelength_nm() const override { return wavelength_nm_; }
    Sampling sampling() const override { return Sampling::from_mu_in; }

    void evaluate(const Direction& direction, std::span<double> values) const override {
        const Incidence incidence = locate(direction.mu_in);
        const Eigen::Vector3d in = incident(direction.mu_in);
        const Point2 u = square_of((in + outgoing(direction)).normalized());
        const Point2 s = warp(vndf_, incidence).invert(u);
        const double scale =
            jacobian_ ? ndf_.bilinear(0, u) / (4.0 * sigma_.bilinear(0, square_of(in))) : 1.0;
        const std::size_t count = channels_.size();
        for (std::size_t c = 0; c < count; ++c) {
            const double value =
                (1 - incidence.weight) * spectra_.bilinear(incidence.slice * count + c, s) +
                incidence.weight * spectra_.bilinear(incidence.next * count + c, s);
            values[c] = std::max(value * scale, 0.0) / direction.mu_out;
        }
    }

    std::optional<Direction> sample(double mu_in, double u, double v) const override {
        const Incidence incidence = locate(mu_in);
        const Point2 m = warp(vndf_, incidence).sample(warp(luminance_, incidence).sample({u, v}));
        const Eigen::Vector3d half = on_sphere(m.x * m.x * kPi / 2, (2.0 * m.y - 1.0) * kPi);
        const Eigen::Vector3d in = incident(mu_in);
        const Eigen::Vector3d out = 2.0 * half.dot(in) * half - in;
        if (!(out.z() > 0.0 && in.dot(half) > 0.0)) return {};
        return Direction{mu_in, std::min(out.z(), 1.0), std::atan2(out.y(), -out.x()) * 180 / kPi};
    }

    double density(const Direction& direction) const override {
        const Incidence incidence = locate(direction.mu_in);
        const Eigen::Vector3d in = incident(direction.mu_in);
        const Eigen::Vector3d half = (in + outgoing(direction)).normalized();
        const Point2 m = square_of(half);
        const BilinearWarp visible = warp(vndf_, incidence);
        const double jacobian =
            std::max(2.0 * kPi * kPi * m.x * std::hypot(half.x(), half.y()), 1e-6) * 4.0 *
            in.dot(half);
        return warp(luminance_, incidence).density(visible.invert(m)) * visible.density(m) /
               jacobian;
    }

  private:
    /// Between two stored incident angles.
    struct Incidence {
        std::size_t slice, next;
        double weight;  ///< of next
    };

    static Eigen::Vector3d incident(double mu) { return {std::sqrt((1 - mu) * (1 + mu)), 0.0, mu}; }

    /// Azimuth 0 is the mirror side, where the outgoing vector leans away from the incident one.
    static Eigen::Vector3d outgoing(const Direction& direction) {
        return on_sphere(std::acos(std::clamp(direction.mu_out, -1.0, 1.0)),
                         kPi - direction.azimuth_deg * kPi / 180);
    }

    Incidence locate(double mu_in) const {
        const double theta = std::acos(std::clamp(mu_in, -1.0, 1.0));
        const auto above = std::upper_bound(theta_.begin(), theta_.end(), theta) - theta_.begin();
        const std::size_t last = theta_.size() - 1;
        const std::size_t slice =
            std::min<std::size_t>(last, above > 0 ? static_cast<std::size_t>(above) - 1 : 0);
        const std::size_t next = std::min(last, slice + 1);
        const double width = double(theta_[next]) - theta_[slice];
        return {slice, next,
                width > 0 ? std::clamp((theta - theta_[slice]) / width, 0.0, 1.0) : 0.0};
    }

    /// Readers normalise each slice, then mix neighbours.
    static BilinearWarp warp(const Slices& slices, const Incidence& incidence) {
        const std::size_t size = slices.nx * slices.ny;
        std::vector<double> mixed(size, 0.0);
        const auto add = [&](std::size_t slice, double weight) {
            double total = 0.0;
            for (std::size_t y = 0; y + 1 < slices.ny; ++y) {
                for (std::size_t x = 0; x + 1 < slices.nx; ++x) {
                    total += (slices.at(slice, x, y) + slices.at(slice, x + 1, y) +
                              slices.at(slice, x, y + 1) + slices.at(slice, x + 1, y + 1)) /
                             4;
                }
            }
            if (!(total > 0.0)) return;
            for (std::size_t i = 0; i < size; ++i) {
                mixed[i] += weight / total * std::max(0.0, double(slices.values[slice * size + i]));
            }
        };
        add(incidence.slice, 1.0 - incidence.weight);
        add(incidence.next, incidence.weight);
        return {std::move(mixed), slices.nx, slices.ny};
    }

    static Slices slices(const std::map<std::string, Tensor>& fields, const std::string& name,
                         std::size_t dimensions, std::size_t count) {
        const Tensor& field = tensor(fields, name, dimensions);
        Slices result;
        result.ny = field.shape[dimensions - 2];
        result.nx = field.shape[dimensions - 1];
        result.values = tensor_floats(fields, name);
        if (result.nx < 2 || result.ny < 2 ||
            result.values.size() / result.nx / result.ny != count) {
            throw InputError(fmt::format(
                "rgl: field '{}' has {} tables of {} x {}; expected {} of at "
                "least 2 x 2",
                name, result.values.size() / std::max<std::size_t>(1, result.nx * result.ny),
                result.nx, result.ny, count));
        }
        for (std::size_t i = 0; i < result.values.size(); ++i) {
            if (!std::isfinite(result.values[i]))
                throw InputError(fmt::format("rgl: field '{}' is not finite", name));
        }
        return result;
    }

    void read_channels(const std::map<std::string, Tensor>& fields) {
        if (theta_.empty()) throw InputError("rgl: no incident angles");
        if (!fields.contains("wavelengths")) {
            if (tensor(fields, "rgb", 5).shape[2] != 3)
                throw InputError("rgl: 'rgb' has not 3 channels");
            channels_ = {"R", "G", "B"};
            return;
        }
        const std::vector<float> wavelengths = all_of(tensor_floats(fields, "wavelengths"));
        wavelength_nm_.assign(wavelengths.begin(), wavelengths.end());
        channels_ = channel_names(wavelength_nm_);
        if (channels_.empty()) throw InputError("rgl: no wavelengths");
    }

    std::string content_;
    std::vector<float> theta_;
    Slices ndf_, sigma_, vndf_, luminance_, spectra_;
    std::vector<double> wavelength_nm_;
    std::vector<std::string> channels_;
    bool jacobian_ = false;
};

}  // namespace

bool looks_like_rgl(std::string_view content) {
    return content.starts_with(std::string_view("tensor_file\0", 12));
}

std::unique_ptr<BrdfFile> read_rgl(std::string content) {
    return std::make_unique<RglFile>(std::move(content));
}

}  // namespace miebrdf::exports
