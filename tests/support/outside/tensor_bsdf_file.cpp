// Layout: "tensor_file", fields of (name, dimensions, type, offset, shape). Evaluation: powitacq
// (Dupuy and Jakob 2018), isotropic files; all tables are bilinear in (x, y) and linear in theta_i.
#include <algorithm>
#include <array>
#include <cmath>
#include <map>
#include <numbers>

#include "tests/support/outside/bytes.h"
#include "tests/support/outside/outside_file.h"

namespace miebrdf::support {
namespace {

struct Field {
    std::vector<std::uint64_t> shape;
    std::size_t position = 0, count = 1;
};

std::map<std::string, Field> fields_of(const std::string& bytes) {
    std::map<std::string, Field> fields;
    std::size_t at = 18;
    for (auto left = number_at<std::uint32_t>(bytes, 14); left > 0; --left) {
        const auto length = number_at<std::uint16_t>(bytes, at);
        Field& field = fields[bytes.substr(at + 2, length)];
        at += 2u + length;
        const auto dimensions = number_at<std::uint16_t>(bytes, at);
        field.position = number_at<std::uint64_t>(bytes, at + 3);
        field.shape = numbers_at<std::uint64_t>(bytes, at + 11, dimensions);
        for (const std::uint64_t extent : field.shape) field.count *= extent;
        at += 11u + 8u * dimensions;
    }
    return fields;
}

struct Square {
    double x, y;
};

/// A stack of tables [theta_i][channel][y][x]; theta_i by a slice and the share of the next.
struct Tables {
    std::size_t nx = 0, ny = 0;
    std::vector<double> values;

    Tables(const std::string& bytes, const Field& field)
        : nx(field.shape[field.shape.size() - 1]), ny(field.shape[field.shape.size() - 2]) {
        const auto floats = numbers_at<float>(bytes, field.position, field.count);
        values.assign(floats.begin(), floats.end());
    }
    const double* slice(std::size_t index) const { return &values[index * nx * ny]; }
    double bilinear(std::size_t index, Square p) const {
        const double* v = slice(index);
        const double px = p.x * static_cast<double>(nx - 1), py = p.y * static_cast<double>(ny - 1);
        const std::size_t x = std::min(nx - 2, static_cast<std::size_t>(px)),
                          y = std::min(ny - 2, static_cast<std::size_t>(py));
        const double fx = px - static_cast<double>(x), fy = py - static_cast<double>(y);
        return (1 - fy) * ((1 - fx) * v[y * nx + x] + fx * v[y * nx + x + 1]) +
               fy * ((1 - fx) * v[(y + 1) * nx + x] + fx * v[(y + 1) * nx + x + 1]);
    }
};

/// Where t falls under a linear density from a to b over [0, 1]: a x + (b - a) x^2 / 2 = t.
double invert_linear(double a, double b, double t) {
    if (std::abs(a - b) < 1e-4 * (a + b)) return 2 * t / (a + b);
    return (a - std::sqrt(std::max(0.0, a * a - 2 * t * (a - b)))) / (a - b);
}

/// The normalised mixture of two slices as a map of the unit square, row first.
class Marginal {
  public:
    Marginal(const Tables& tables, std::size_t slice, double share)
        : nx_(tables.nx), ny_(tables.ny) {
        density_.assign(nx_ * ny_, 0.0);
        add(tables.slice(slice), 1 - share);
        if (share > 0) add(tables.slice(slice + 1), share);
        conditional_.assign(nx_ * ny_, 0.0);
        marginal_.assign(ny_, 0.0);
        for (std::size_t y = 0; y < ny_; ++y) {
            for (std::size_t x = 1; x < nx_; ++x)
                conditional_[y * nx_ + x] =
                    conditional_[y * nx_ + x - 1] + (d(x - 1, y) + d(x, y)) / 2;
            if (y > 0) marginal_[y] = marginal_[y - 1] + (row(y - 1) + row(y)) / 2;
        }
    }

    Square sample(Square u) const {
        const std::size_t y = below(marginal_.data(), ny_, u.y);
        const double fy = invert_linear(row(y), row(y + 1), u.y - marginal_[y]);
        std::vector<double> running(nx_);
        for (std::size_t x = 0; x < nx_; ++x)
            running[x] =
                (1 - fy) * conditional_[y * nx_ + x] + fy * conditional_[(y + 1) * nx_ + x];
        const double target = u.x * running.back();
        const std::size_t x = below(running.data(), nx_, target);
        const double fx =
            invert_linear((1 - fy) * d(x, y) + fy * d(x, y + 1),
                          (1 - fy) * d(x + 1, y) + fy * d(x + 1, y + 1), target - running[x]);
        return {(static_cast<double>(x) + fx) / static_cast<double>(nx_ - 1),
                (static_cast<double>(y) + fy) / static_cast<double>(ny_ - 1)};
    }

    Square invert(Square p) const {
        const auto [x, y, fx, fy] = cell(p);
        const double v0 = (1 - fy) * d(x, y) + fy * d(x, y + 1);
        const double v1 = (1 - fy) * d(x + 1, y) + fy * d(x + 1, y + 1);
        const double before =
            (1 - fy) * conditional_[y * nx_ + x] + fy * conditional_[(y + 1) * nx_ + x];
        const double whole = (1 - fy) * row(y) + fy * row(y + 1);
        return {(before + fx * (v0 + fx * (v1 - v0) / 2)) / whole,
                marginal_[y] + fy * (row(y) + fy * (row(y + 1) - row(y)) / 2)};
    }

    double density(Square p) const {
        const auto [x, y, fx, fy] = cell(p);
        return ((1 - fy) * ((1 - fx) * d(x, y) + fx * d(x + 1, y)) +
                fy * ((1 - fx) * d(x, y + 1) + fx * d(x + 1, y + 1))) *
               static_cast<double>((nx_ - 1) * (ny_ - 1));
    }

  private:
    struct Cell {
        std::size_t x, y;
        double fx, fy;
    };
    Cell cell(Square p) const {
        const double px = std::clamp(p.x, 0.0, 1.0) * static_cast<double>(nx_ - 1);
        const double py = std::clamp(p.y, 0.0, 1.0) * static_cast<double>(ny_ - 1);
        const std::size_t x = std::min(nx_ - 2, static_cast<std::size_t>(px));
        const std::size_t y = std::min(ny_ - 2, static_cast<std::size_t>(py));
        return {x, y, px - static_cast<double>(x), py - static_cast<double>(y)};
    }
    void add(const double* values, double weight) {
        double total = 0;
        for (std::size_t y = 0; y + 1 < ny_; ++y) {
            for (std::size_t x = 0; x + 1 < nx_; ++x) {
                const double* v = values + y * nx_ + x;
                total += (v[0] + v[1] + v[nx_] + v[nx_ + 1]) / 4;
            }
        }
        for (std::size_t i = 0; i < density_.size(); ++i) density_[i] += weight * values[i] / total;
    }
    static std::size_t below(const double* running, std::size_t count, double target) {
        std::size_t i = 0;
        while (i + 2 < count && running[i + 1] < target) ++i;
        return i;
    }
    double d(std::size_t x, std::size_t y) const { return density_[y * nx_ + x]; }
    double row(std::size_t y) const { return conditional_[y * nx_ + nx_ - 1]; }

    std::size_t nx_, ny_;
    std::vector<double> density_, conditional_, marginal_;
};

Square square_of(const Vector& v, double phi_zero) {
    const double theta = std::acos(std::clamp(v.z(), -1.0, 1.0));
    const double y =
        (std::atan2(v.y(), v.x()) - phi_zero + std::numbers::pi) / (2 * std::numbers::pi);
    return {std::sqrt(theta * 2 / std::numbers::pi), y - std::floor(y)};
}

class TensorBsdfFile : public OutsideFile {
  public:
    explicit TensorBsdfFile(const std::string& bytes) : TensorBsdfFile(bytes, fields_of(bytes)) {}

    bool starts_from_light() const override { return true; }

    std::vector<double> brdf(const Vector& light, const Vector& viewer) const override {
        const auto [slice, share] = incidence(light);
        const Square m = square_of((light + viewer).normalized(), azimuth(light));
        const Square s = at(slice, share).visible.invert(m);
        const double scale = ndf_.bilinear(0, m) / (4 * sigma_.bilinear(0, square_of(light, 0.0)));
        std::vector<double> values(channels_);
        for (std::size_t c = 0; c < channels_; ++c) {
            double value = (1 - share) * spectra_.bilinear(slice * channels_ + c, s);
            if (share > 0) value += share * spectra_.bilinear((slice + 1) * channels_ + c, s);
            values[c] = std::max(0.0, value * scale / viewer.z());
        }
        return values;
    }

    std::optional<Vector> sample(const Vector& light, double u, double v) const override {
        const auto [slice, share] = incidence(light);
        const Warps& warps = at(slice, share);
        const Square m = warps.visible.sample(warps.luminance.sample({u, v}));
        const double theta = m.x * m.x * std::numbers::pi / 2,
                     phi = (2 * m.y - 1) * std::numbers::pi + azimuth(light);
        const Vector half(std::sin(theta) * std::cos(phi), std::sin(theta) * std::sin(phi),
                          std::cos(theta));
        const Vector viewer = 2 * half.dot(light) * half - light;
        if (!(viewer.z() > 0)) return {};
        return viewer;
    }

    double density(const Vector& light, const Vector& viewer) const override {
        const auto [slice, share] = incidence(light);
        const Vector half = (light + viewer).normalized();
        const Square m = square_of(half, azimuth(light));
        const Warps& warps = at(slice, share);
        const double jacobian =
            std::max(2 * std::numbers::pi * std::numbers::pi * m.x * std::hypot(half.x(), half.y()),
                     1e-6) *
            4 * light.dot(half);
        return warps.visible.density(m) * warps.luminance.density(warps.visible.invert(m)) /
               jacobian;
    }

  private:
    TensorBsdfFile(const std::string& bytes, std::map<std::string, Field> fields)
        : theta_(numbers_at<float>(bytes, fields["theta_i"].position, fields["theta_i"].count)),
          ndf_(bytes, fields["ndf"]),
          sigma_(bytes, fields["sigma"]),
          vndf_(bytes, fields["vndf"]),
          luminance_(bytes, fields["luminance"]),
          spectra_(bytes, fields[fields.count("spectra") ? "spectra" : "rgb"]),
          channels_(spectra_.values.size() / spectra_.nx / spectra_.ny / theta_.size()) {}

    /// The warps of one incidence, kept for the next call, which in these tests mostly has the
    /// same.
    struct Warps {
        std::size_t slice;
        double share;
        Marginal visible, luminance;
    };
    const Warps& at(std::size_t slice, double share) const {
        if (!last_ || last_->slice != slice || last_->share != share) {
            last_.emplace(Warps{slice, share, Marginal(vndf_, slice, share),
                                Marginal(luminance_, slice, share)});
        }
        return *last_;
    }

    static double azimuth(const Vector& v) { return std::atan2(v.y(), v.x()); }

    std::pair<std::size_t, double> incidence(const Vector& light) const {
        const double theta = std::acos(std::clamp(light.z(), -1.0, 1.0));
        std::size_t i = 0;
        while (i + 2 < theta_.size() && theta_[i + 1] <= theta) ++i;
        return {i, std::clamp((theta - theta_[i]) / (double(theta_[i + 1]) - theta_[i]), 0.0, 1.0)};
    }

    std::vector<float> theta_;
    Tables ndf_, sigma_, vndf_, luminance_, spectra_;
    std::size_t channels_;
    mutable std::optional<Warps> last_;
};

}  // namespace

std::unique_ptr<OutsideFile> tensor_bsdf_file(const std::string& bytes) {
    return std::make_unique<TensorBsdfFile>(bytes);
}

}  // namespace miebrdf::support
