// Radiance's tensor trees of three dimensions, full grids only.
#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <numbers>

#include <miebrdf/error.h>
#include "pipeline/formats/readers/radiance_file.h"

namespace miebrdf::exports {
namespace {

constexpr double kPi = std::numbers::pi;

/// Shirley and Chiu's map from the unit disk to the unit square.
std::pair<double, double> disk_to_square(double dx, double dy) {
    const double r = std::hypot(dx, dy);
    double phi = std::atan2(dy, dx);
    if (phi < -kPi / 4) phi += 2 * kPi;
    double a = 0, b = 0;
    if (phi < kPi / 4) {
        a = r, b = phi * r / (kPi / 4);
    } else if (phi < 3 * kPi / 4) {
        b = r, a = -(phi - kPi / 2) * r / (kPi / 4);
    } else if (phi < 5 * kPi / 4) {
        a = -r, b = (phi - kPi) * a / (kPi / 4);
    } else {
        b = -r, a = -(phi - 3 * kPi / 2) * b / (kPi / 4);
    }
    return {(a + 1) / 2, (b + 1) / 2};
}

class TreeFile : public RadianceFile {
  public:
    TreeFile(const pugi::xml_node& layer, std::size_t largest) {
        y_ = radiance_block(layer, "Visible", largest);
        u_ = radiance_block(layer, "CIE-u", largest);
        v_ = radiance_block(layer, "CIE-v", largest);
        while (side_ * side_ * side_ < y_.size()) side_ *= 2;
        if (y_.empty() || side_ * side_ * side_ != y_.size()) {
            throw InputError(fmt::format(
                "radiance: a tree of {} values is no full grid; nested trees are not read",
                y_.size()));
        }
        if ((!u_.empty() && u_.size() != y_.size()) || (!v_.empty() && v_.size() != y_.size())) {
            throw InputError("radiance: the trees of colour and luminance differ");
        }
    }
    std::string description() const override {
        return fmt::format("tensor tree, {} cells a side", side_);
    }

  private:
    std::size_t index(double x) const {
        return std::min(side_ - 1,
                        static_cast<std::size_t>(std::max(x, 0.0) * static_cast<double>(side_)));
    }
    std::size_t cell_of(const Direction& d) const override {
        const double sin_in = std::sqrt((1 - d.mu_in) * (1 + d.mu_in)),
                     sin_out = std::sqrt((1 - d.mu_out) * (1 + d.mu_out));
        const auto [x, y] = disk_to_square(sin_out * std::cos(d.azimuth_deg * kPi / 180),
                                           sin_out * std::sin(d.azimuth_deg * kPi / 180));
        // Normal incidence belongs to the last cell in use, as in Radiance.
        return (index(0.5 - 1e-6 - 0.5 * sin_in) * side_ + index(x)) * side_ + index(y);
    }
    std::array<double, 3> colour_of(std::size_t cell) const override {
        const double Y = y_[cell];
        if (u_.empty() || v_.empty() || !(v_[cell] > 0)) return {Y, Y, Y};
        const double X = Y * 9 * u_[cell] / (4 * v_[cell]);
        const double Z = Y * (12 - 3 * u_[cell] - 20 * v_[cell]) / (4 * v_[cell]);
        return srgb_of(X, Y, Z);
    }

    std::size_t side_ = 1;
    std::vector<float> y_, u_, v_;
};

}  // namespace

std::unique_ptr<BrdfFile> read_tensor_tree(const pugi::xml_node& layer, std::size_t largest) {
    return std::make_unique<TreeFile>(layer, largest);
}

}  // namespace miebrdf::exports
