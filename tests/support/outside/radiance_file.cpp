// WINDOW's XML as Radiance reads it: src/common/bsdf_m.c (matrices), bsdf_t.c (tensor trees), with
// colours as its ccolor.c adds them up and its color.h turns them into R, G, B. The text is cut out
// by its tags, without an XML parser.
#include <Eigen/Dense>
#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>
#include <sstream>

#include "tests/support/outside/outside_file.h"

namespace miebrdf::support {
namespace {

std::string between(const std::string& text, const std::string& open, const std::string& close) {
    const std::size_t from = text.find(open);
    if (from == text.npos) return {};
    const std::size_t first = from + open.size();
    return text.substr(first, text.find(close, first) - first);
}

/// ScatteringData of the reflection from above, "Reflection Back" in WINDOW's words.
std::vector<double> data_of(const std::string& xml, const std::string& band) {
    for (std::size_t at = 0; (at = xml.find("<WavelengthData>", at)) != xml.npos; ++at) {
        const std::string part = xml.substr(at, xml.find("</WavelengthData>", at) - at);
        if (between(part, "<Wavelength unit=\"Integral\">", "<") != band) continue;
        if (between(part, "<WavelengthDataDirection>", "<") != "Reflection Back") continue;
        std::string numbers = between(part, "<ScatteringData>", "<");
        for (char& c : numbers)
            if (c == ',' || c == '{' || c == '}') c = ' ';
        std::istringstream stream(numbers);
        std::vector<double> values;
        for (double x; stream >> x;) values.push_back(x);
        return values;
    }
    return {};
}

struct Xyz {
    double x = 0, y = 0, z = 0;
};

/// Converts luminance and the chromaticity (x, y), as ccy2rgb, with primaries of a nominal CRT and
/// white at (1/3, 1/3).
std::vector<double> rgb_of(const Xyz& colour) {
    // Chromaticities of the primaries; their luminances make equal parts of them white.
    constexpr double kX[3] = {0.640, 0.290, 0.150}, kY[3] = {0.330, 0.600, 0.060};
    constexpr double kLuminance[3] = {0.265105820106, 0.670105820106, 0.064788359788};
    Eigen::Matrix3d xyz;
    for (int c = 0; c < 3; ++c) {
        xyz.col(c) = kLuminance[c] / kY[c] * Vector(kX[c], kY[c], 1 - kX[c] - kY[c]);
    }
    const Vector rgb = xyz.inverse() * Vector(colour.x, colour.y, colour.z);
    return {rgb.x(), rgb.y(), rgb.z()};
}

/// c_cmix: colours add up.
Xyz sum_of(const Xyz& a, const Xyz& b) { return {a.x + b.x, a.y + b.y, a.z + b.z}; }

/// SDyuv2rgb: chromaticity (x, y) of (u', v'), then X and Z of Y.
Xyz of_uv(double luminance, double u, double v) {
    const double divisor = 6 * u - 16 * v + 12;
    const double x = 9 * u / divisor, y = 4 * v / divisor;
    return {x / y * luminance, luminance, (1 - x - y) / y * luminance};
}

class KlemsFile : public OutsideFile {
  public:
    explicit KlemsFile(const std::string& xml)
        : x_(data_of(xml, "CIE-X")), y_(data_of(xml, "Visible")), z_(data_of(xml, "CIE-Z")) {}

    std::vector<double> brdf(const Vector& light, const Vector& viewer) const override {
        // The incident basis is that of the vector in which light travels.
        const std::size_t index = patch(viewer) * 145 + patch({-light.x(), -light.y(), light.z()});
        return rgb_of({x_.at(index), y_.at(index), z_.at(index)});
    }

  private:
    static std::size_t patch(const Vector& v) {
        constexpr std::array<double, 9> kUpper = {5, 15, 25, 35, 45, 55, 65, 75, 90};
        constexpr std::array<int, 9> kCount = {1, 8, 16, 20, 24, 24, 24, 16, 12};
        const double theta = std::acos(std::min(1.0, v.z())) * 180 / std::numbers::pi;
        std::size_t ring = 0;
        int first = 0;
        while (ring + 1 < kUpper.size() && theta >= kUpper[ring]) first += kCount[ring++];
        double azimuth = std::atan2(v.y(), v.x()) / (2 * std::numbers::pi);
        if (azimuth < 0) azimuth += 1;
        return static_cast<std::size_t>(first + int(azimuth * kCount[ring] + 0.5) % kCount[ring]);
    }

    std::vector<double> x_, y_, z_;
};

class TensorTreeFile : public OutsideFile {
  public:
    explicit TensorTreeFile(const std::string& xml)
        : y_(data_of(xml, "Visible")), u_(data_of(xml, "CIE-u")), v_(data_of(xml, "CIE-v")) {
        side_ = static_cast<std::size_t>(std::lround(std::cbrt(double(y_.size()))));
        subtract_min_rgb();
    }

    std::vector<double> brdf(const Vector& light, const Vector& viewer) const override {
        // Turned so that light travels towards +x; then the square of Shirley and Chiu.
        const double turn = -std::atan2(-light.y(), -light.x());
        const double x = viewer.x() * std::cos(turn) - viewer.y() * std::sin(turn);
        const double y = viewer.x() * std::sin(turn) + viewer.y() * std::cos(turn);
        const auto [a, b] = square(x, y);
        const double first = 0.5 - 1e-6 - 0.5 * std::hypot(light.x(), light.y());
        const std::size_t index = (cell(first) * side_ + cell(a)) * side_ + cell(b);
        const double Y = y_.at(index);
        if (u_.empty()) {  // one channel, in the first of the primaries that it adds up
            const double sharp = std::max(Y - diffuse_.y, 0.0) / 0.3791;
            return rgb_of(sum_of(diffuse_, {0.8156 * sharp, 0.3791 * sharp, -0.0123 * sharp}));
        }
        return rgb_of(of_uv(Y, u_.at(index), v_.at(index)));
    }

  private:
    std::size_t cell(double x) const {
        return std::min(side_ - 1,
                        static_cast<std::size_t>(std::max(0.0, x) * static_cast<double>(side_)));
    }

    /// Subtracts in the half in use. The new trees of u' and v' lack the other half, and are
    /// dropped.
    void subtract_min_rgb() {
        double least[3] = {1e10, 1e10, 1e10};
        for (std::size_t i = 0; i < y_.size() / 2; ++i) {
            const Xyz c = of_uv(y_[i], u_[i], v_[i]);
            const double sharp[3] = {1.2694 * c.x - 0.0988 * c.y - 0.1706 * c.z,
                                     -0.8364 * c.x + 1.8006 * c.y + 0.0357 * c.z,
                                     0.0297 * c.x - 0.0315 * c.y + 1.0018 * c.z};
            for (int k = 0; k < 3; ++k) least[k] = std::min(least[k], sharp[k]);
        }
        const auto [r, g, b] = least;
        const double y = 0.3791 * r + 0.5769 * g + 0.0440 * b;
        if (y <= 0.01 / std::numbers::pi) return;
        diffuse_ = {0.8156 * r + 0.0472 * g + 0.1372 * b, y, -0.0123 * r + 0.0167 * g + 0.9955 * b};
        u_.clear();
        v_.clear();
    }

    /// Concentric: the sector of 90 degrees about each half axis becomes a triangle of the square.
    static std::pair<double, double> square(double x, double y) {
        const double radius = std::hypot(x, y);
        const bool along_x = std::abs(x) > std::abs(y);
        const double large = std::copysign(radius, along_x ? x : y);
        const double ratio = radius > 0 ? (along_x ? y / x : x / y) : 0.0;
        const double small = large * std::atan(ratio) / (std::numbers::pi / 4);
        return along_x ? std::pair{(large + 1) / 2, (small + 1) / 2}
                       : std::pair{(small + 1) / 2, (large + 1) / 2};
    }

    std::vector<double> y_, u_, v_;
    std::size_t side_ = 0;
    Xyz diffuse_;
};

}  // namespace

std::unique_ptr<OutsideFile> klems_file(const std::string& bytes) {
    return std::make_unique<KlemsFile>(bytes);
}

std::unique_ptr<OutsideFile> tensor_tree_file(const std::string& bytes) {
    return std::make_unique<TensorTreeFile>(bytes);
}

}  // namespace miebrdf::support
