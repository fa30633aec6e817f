// WINDOW's XML as Radiance reads it: src/common/bsdf_m.c (matrices), bsdf_t.c (tensor trees). The
// text is cut out by its tags, without an XML parser.
#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>
#include <sstream>

#include "tests/support/outside/outside_file.h"

namespace miebrdf::support {
namespace {

constexpr double kPi = std::numbers::pi;

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

std::vector<double> rgb_of(double x, double y, double z) {
    // Inverse of the matrix of IEC 61966-2-1, to the digits of that standard.
    return {3.2406 * x - 1.5372 * y - 0.4986 * z, -0.9689 * x + 1.8758 * y + 0.0415 * z,
            0.0557 * x - 0.2040 * y + 1.0570 * z};
}

class KlemsFile : public OutsideFile {
  public:
    explicit KlemsFile(const std::string& xml)
        : x_(data_of(xml, "CIE-X")), y_(data_of(xml, "Visible")), z_(data_of(xml, "CIE-Z")) {}

    std::vector<double> brdf(const Vector& light, const Vector& viewer) const override {
        // The incident basis is that of the vector in which light travels.
        const std::size_t index = patch(viewer) * 145 + patch({-light.x(), -light.y(), light.z()});
        return rgb_of(x_.at(index), y_.at(index), z_.at(index));
    }

  private:
    static std::size_t patch(const Vector& v) {
        constexpr std::array<double, 9> kUpper = {5, 15, 25, 35, 45, 55, 65, 75, 90};
        constexpr std::array<int, 9> kCount = {1, 8, 16, 20, 24, 24, 24, 16, 12};
        const double theta = std::acos(std::min(1.0, v.z())) * 180 / kPi;
        std::size_t ring = 0;
        int first = 0;
        while (ring + 1 < kUpper.size() && theta >= kUpper[ring]) first += kCount[ring++];
        double azimuth = std::atan2(v.y(), v.x()) / (2 * kPi);
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
    }

    std::vector<double> brdf(const Vector& light, const Vector& viewer) const override {
        // Turned so that light travels towards +x; then the square of Shirley and Chiu.
        const double turn = -std::atan2(-light.y(), -light.x());
        const double x = viewer.x() * std::cos(turn) - viewer.y() * std::sin(turn);
        const double y = viewer.x() * std::sin(turn) + viewer.y() * std::cos(turn);
        const auto [a, b] = square(x, y);
        const double first = 0.5 - 1e-6 - 0.5 * std::hypot(light.x(), light.y());
        const std::size_t index = (cell(first) * side_ + cell(a)) * side_ + cell(b);
        const double Y = y_.at(index), u = u_.at(index), v = v_.at(index);
        return rgb_of(Y * 9 * u / (4 * v), Y, Y * (12 - 3 * u - 20 * v) / (4 * v));
    }

  private:
    std::size_t cell(double x) const {
        return std::min(side_ - 1,
                        static_cast<std::size_t>(std::max(0.0, x) * static_cast<double>(side_)));
    }

    /// Concentric: the sector of 90 degrees about each half axis becomes a triangle of the square.
    static std::pair<double, double> square(double x, double y) {
        const double radius = std::hypot(x, y);
        const bool along_x = std::abs(x) > std::abs(y);
        const double large = std::copysign(radius, along_x ? x : y);
        const double ratio = radius > 0 ? (along_x ? y / x : x / y) : 0.0;
        const double small = large * std::atan(ratio) / (kPi / 4);
        return along_x ? std::pair{(large + 1) / 2, (small + 1) / 2}
                       : std::pair{(small + 1) / 2, (large + 1) / 2};
    }

    std::vector<double> y_, u_, v_;
    std::size_t side_ = 0;
};

}  // namespace

std::unique_ptr<OutsideFile> klems_file(const std::string& bytes) {
    return std::make_unique<KlemsFile>(bytes);
}

std::unique_ptr<OutsideFile> tensor_tree_file(const std::string& bytes) {
    return std::make_unique<TensorTreeFile>(bytes);
}

}  // namespace miebrdf::support
