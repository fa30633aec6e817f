// RGL's measured materials, isotropic, evaluated as powitacq, Mitsuba 3 and pbrt-v4 do.
#include <fmt/format.h>

#include <Eigen/Core>
#include <algorithm>
#include <cmath>
#include <memory>
#include <mutex>
#include <numbers>

#include <miebrdf/brdf_source.h>
#include <miebrdf/formats.h>
#include "pipeline/formats/rgl/tables.h"

namespace miebrdf {
namespace {

using std::numbers::pi;

/// theta = u^2 pi / 2, phi = (2 u - 1) pi.
Point2 square_of(const Eigen::Vector3d& m) {
    const double theta = std::atan2(std::hypot(m.x(), m.y()), m.z());
    const double phi = std::atan2(m.y(), m.x());
    return {std::sqrt(2.0 * theta / pi), (phi + pi) / (2.0 * pi)};
}

Eigen::Vector3d on_sphere(double theta, double phi) {
    return {std::sin(theta) * std::cos(phi), std::sin(theta) * std::sin(phi), std::cos(theta)};
}

class RglFile : public BrdfFile {
  public:
    explicit RglFile(std::string content)
        : content_(std::move(content)), tables_(read_rgl_tables(content_)) {}

    std::string format() const override { return "rgl"; }
    std::string description() const override {
        return fmt::format("{} x {} half vectors at {} incident angles, {}", tables_.spectra.nx,
                           tables_.spectra.ny, tables_.theta.size(),
                           tables_.wavelength_nm.empty() ? "RGB" : "spectral");
    }
    const std::vector<std::string>& channels() const override { return tables_.channels; }
    const std::vector<double>& wavelength_nm() const override { return tables_.wavelength_nm; }
    Sampling sampling() const override { return Sampling::from_mu_in; }

    void look_up(const Direction& direction, std::span<double> values) const override {
        const Incidence incidence = locate(direction.mu_in);
        const Eigen::Vector3d in = incident(direction.mu_in);
        const Point2 u = square_of((in + outgoing(direction)).normalized());
        const Point2 s = warp(tables_.vndf, incidence).invert(u);
        const double scale = tables_.jacobian ? tables_.ndf.bilinear(0, u) /
                                                    (4.0 * tables_.sigma.bilinear(0, square_of(in)))
                                              : 1.0;
        const std::size_t count = tables_.channels.size();
        for (std::size_t c = 0; c < count; ++c) {
            const double value =
                (1 - incidence.weight) * tables_.spectra.bilinear(incidence.slice * count + c, s) +
                incidence.weight * tables_.spectra.bilinear(incidence.next * count + c, s);
            values[c] = std::max(value * scale, 0.0) / direction.mu_out;
        }
    }

    std::optional<Direction> sample(double mu_in, double u, double v) const override {
        const auto warps = warps_at(mu_in);
        const Point2 m = warps->visible.sample(warps->luminance.sample({u, v}));
        const Eigen::Vector3d half = on_sphere(m.x * m.x * pi / 2, (2.0 * m.y - 1.0) * pi);
        const Eigen::Vector3d in = incident(mu_in);
        const Eigen::Vector3d out = 2.0 * half.dot(in) * half - in;
        if (!(out.z() > 0.0 && in.dot(half) > 0.0)) return {};
        return Direction{mu_in, std::min(out.z(), 1.0), std::atan2(out.y(), -out.x()) * 180 / pi};
    }

    double density(const Direction& direction) const override {
        const auto warps = warps_at(direction.mu_in);
        const Eigen::Vector3d in = incident(direction.mu_in);
        const Eigen::Vector3d half = (in + outgoing(direction)).normalized();
        const Point2 m = square_of(half);
        const double jacobian =
            std::max(2.0 * pi * pi * m.x * std::hypot(half.x(), half.y()), 1e-6) * 4.0 *
            in.dot(half);
        return warps->luminance.density(warps->visible.invert(m)) * warps->visible.density(m) /
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
                         pi - direction.azimuth_deg * pi / 180);
    }

    Incidence locate(double mu_in) const {
        const double theta = std::acos(std::clamp(mu_in, -1.0, 1.0));
        const auto above = std::upper_bound(tables_.theta.begin(), tables_.theta.end(), theta) -
                           tables_.theta.begin();
        const std::size_t last = tables_.theta.size() - 1;
        const std::size_t slice =
            std::min<std::size_t>(last, above > 0 ? static_cast<std::size_t>(above) - 1 : 0);
        const std::size_t next = std::min(last, slice + 1);
        const double width = double(tables_.theta[next]) - tables_.theta[slice];
        return {slice, next,
                width > 0 ? std::clamp((theta - tables_.theta[slice]) / width, 0.0, 1.0) : 0.0};
    }

    /// Readers normalise each slice, then mix neighbours.
    static BilinearWarp warp(const RglSlices& slices, const Incidence& incidence) {
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

    /// The tables that directions are drawn by at one incidence; the last one is kept.
    struct Warps {
        double mu_in;
        BilinearWarp visible, luminance;
    };

    std::shared_ptr<const Warps> warps_at(double mu_in) const {
        const std::lock_guard lock(mutex_);
        if (warps_ == nullptr || warps_->mu_in != mu_in) {
            const Incidence incidence = locate(mu_in);
            warps_ = std::make_shared<const Warps>(
                Warps{mu_in, warp(tables_.vndf, incidence), warp(tables_.luminance, incidence)});
        }
        return warps_;
    }

    std::string content_;
    RglTables tables_;  // views into content_
    mutable std::mutex mutex_;
    mutable std::shared_ptr<const Warps> warps_;
};

Recognised recognise_rgl(std::string_view content) {
    const bool found = content.starts_with(std::string_view("tensor_file\0", 12));
    return found ? Recognised::by_first_bytes : Recognised::no;
}

std::unique_ptr<BrdfFile> read_rgl(std::string content) {
    return std::make_unique<RglFile>(std::move(content));
}

}  // namespace

FormatReader rgl_reader() { return {recognise_rgl, read_rgl}; }

}  // namespace miebrdf
