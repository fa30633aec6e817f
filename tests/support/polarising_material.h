// A BRDF of polarised light in closed form: what is scattered once by any scattering matrix, with
// some unpolarised light on top.
#pragma once

#include <cmath>
#include <numbers>

#include "rte/first_order/first_order.h"
#include "rte/first_order/meridian_planes.h"
#include "tests/support/test_material.h"

namespace miebrdf::support {

/// A matrix of everything that spheres may have, b2 included; not of any real sphere.
inline rte::ScatteringMatrix some_matrix(double cos_theta) {
    const double s = (1.0 - cos_theta) * (1.0 + cos_theta);
    return {.a1 = 1.0 + 0.3 * cos_theta,
            .a2 = 0.9 + 0.3 * cos_theta - 0.1 * s,
            .a3 = 0.8 * cos_theta + 0.1 * s,
            .a4 = 0.7 * cos_theta,
            .b1 = -0.4 * s,
            .b2 = 0.2 * s};
}

class PolarisingMaterial : public BrdfSource {
  public:
    PolarisingMaterial(std::vector<double> wavelength_nm, int components, double unpolarised)
        : wavelength_nm_(std::move(wavelength_nm)),
          channels_(channel_names(wavelength_nm_)),
          components_(components),
          unpolarised_(unpolarised) {
        provenance_ = {.version = "miebrdf test", .title = "test"};
    }

    const std::vector<std::string>& channels() const override { return channels_; }
    const std::vector<double>& wavelength_nm() const override { return wavelength_nm_; }
    const Provenance& provenance() const override { return provenance_; }
    int components() const override { return components_; }

    void evaluate(std::span<const Direction> directions, std::span<double> values) const override {
        for (std::size_t i = 0; i < values.size(); ++i)
            values[i] = matrix(directions[i / channels_.size()], i % channels_.size())(0, 0);
    }
    void evaluate_mueller(std::span<const Direction> directions,
                          std::span<double> values) const override {
        double* next = values.data();
        for (const Direction& direction : directions) {
            for (std::size_t c = 0; c < channels_.size(); ++c) {
                const Eigen::Matrix4d M = matrix(direction, c);
                for (int row = 0; row < components_; ++row)
                    for (int column = 0; column < components_; ++column) *next++ = M(row, column);
            }
        }
    }

    /// Brighter from channel to channel.
    Eigen::Matrix4d matrix(const Direction& d, std::size_t channel) const {
        const double cosine = rte::cos_scattering_angle(
            d.mu_in, d.mu_out, std::cos(d.azimuth_deg * std::numbers::pi / 180));
        Eigen::Matrix4d M =
            rte::turned_to_meridians(some_matrix(cosine), d.mu_in, d.mu_out, d.azimuth_deg);
        M(0, 0) += unpolarised_;
        return M * (0.1 * double(1 + channel));
    }

  private:
    std::vector<double> wavelength_nm_;
    std::vector<std::string> channels_;
    int components_;
    double unpolarised_;
    Provenance provenance_;
};

}  // namespace miebrdf::support
