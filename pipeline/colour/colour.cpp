#include <miebrdf/colour.h>

#include <fmt/format.h>

#include <Eigen/LU>
#include <algorithm>
#include <cmath>
#include <stdexcept>

namespace miebrdf {
namespace {

constexpr int kFirst_nm = 360;
constexpr int kLast_nm = 830;

Eigen::Vector3d vector_of(const Xyz& c) { return {c.x, c.y, c.z}; }

/// x, y to X, Y, Z with Y = 1.
Eigen::Vector3d from_chromaticity(double x, double y) { return {x / y, 1.0, (1.0 - x - y) / y}; }

const Eigen::Vector3d& srgb_white() {
    static const Eigen::Vector3d white = from_chromaticity(0.3127, 0.3290);
    return white;
}

/// XYZ to linear sRGB from its primaries and white (IEC 61966-2-1, table 1): red + green + blue is
/// the white to rounding, which the printed four-digit matrix is not.
const Eigen::Matrix3d& xyz_to_srgb() {
    static const Eigen::Matrix3d matrix = [] {
        Eigen::Matrix3d primaries;
        primaries << from_chromaticity(0.64, 0.33), from_chromaticity(0.30, 0.60),
            from_chromaticity(0.15, 0.06);
        const Eigen::Vector3d luminances = primaries.inverse() * srgb_white();
        return Eigen::Matrix3d((primaries * luminances.asDiagonal()).inverse());
    }();
    return matrix;
}

/// Lam 1985: cone-like responses in which adaptation is a scaling.
const Eigen::Matrix3d& bradford() {
    static const Eigen::Matrix3d matrix = (Eigen::Matrix3d() << 0.8951, 0.2664, -0.1614, -0.7502,
                                           1.7135, 0.0367, 0.0389, -0.0685, 1.0296)
                                              .finished();
    return matrix;
}

void check_ascending(const std::vector<double>& wavelength_nm) {
    if (wavelength_nm.empty())
        throw std::invalid_argument("colour of a spectrum without wavelengths");
    for (std::size_t i = 0; i < wavelength_nm.size(); ++i) {
        const double before = i == 0 ? 0.0 : wavelength_nm[i - 1];
        if (!(wavelength_nm[i] > before && std::isfinite(wavelength_nm[i]))) {
            throw std::invalid_argument(fmt::format("wavelengths must ascend: {} nm after {} nm",
                                                    wavelength_nm[i], before));
        }
    }
}

}  // namespace

ObserverWeights observer_weights(const std::vector<double>& wavelength_nm, Illuminant illuminant) {
    check_ascending(wavelength_nm);
    const std::size_t count = wavelength_nm.size();
    ObserverWeights weights{std::vector<double>(count), std::vector<double>(count),
                            std::vector<double>(count)};
    const auto add = [&](std::size_t i, double share, const ColourMatching& c) {
        weights.x[i] += share * c.x;
        weights.y[i] += share * c.y;
        weights.z[i] += share * c.z;
    };
    double luminance = 0;
    for (int nm = kFirst_nm; nm <= kLast_nm; ++nm) {
        const double power = relative_power(illuminant, nm);
        const ColourMatching c = colour_matching(nm);
        luminance += power * c.y;
        const auto above = std::upper_bound(wavelength_nm.begin(), wavelength_nm.end(), double(nm));
        const std::size_t right = static_cast<std::size_t>(above - wavelength_nm.begin());
        if (right == 0 || right == count) {
            add(right == 0 ? 0 : count - 1, power, c);
        } else {
            const double t =
                (nm - wavelength_nm[right - 1]) / (wavelength_nm[right] - wavelength_nm[right - 1]);
            add(right - 1, (1.0 - t) * power, c);
            add(right, t * power, c);
        }
    }
    for (auto* list : {&weights.x, &weights.y, &weights.z}) {
        for (double& weight : *list) weight /= luminance;
    }
    return weights;
}

Xyz to_xyz(const ObserverWeights& weights, const std::vector<double>& reflectance) {
    if (reflectance.size() != weights.y.size()) {
        throw std::invalid_argument(fmt::format("{} reflectances for {} wavelengths",
                                                reflectance.size(), weights.y.size()));
    }
    Xyz sum;
    for (std::size_t i = 0; i < reflectance.size(); ++i) {
        sum.x += weights.x[i] * reflectance[i];
        sum.y += weights.y[i] * reflectance[i];
        sum.z += weights.z[i] * reflectance[i];
    }
    return sum;
}

Xyz white_point(Illuminant illuminant) {
    const auto white_of = [](Illuminant lamp) {
        return to_xyz(observer_weights({560.0}, lamp), {1.0});
    };
    static const std::array<Xyz, 3> whites = {white_of(Illuminant::d65), white_of(Illuminant::e),
                                              white_of(Illuminant::a)};
    return whites[static_cast<std::size_t>(illuminant)];
}

Lab to_lab(const Xyz& xyz, Illuminant illuminant) {
    // f of ISO/CIE 11664-4: a cube root, and below (6/29)^3 its tangent.
    const auto f = [](double t) {
        constexpr double delta = 6.0 / 29.0;
        return t > delta * delta * delta ? std::cbrt(t) : t / (3 * delta * delta) + 4.0 / 29.0;
    };
    const Xyz white = white_point(illuminant);
    const double fx = f(xyz.x / white.x), fy = f(xyz.y / white.y), fz = f(xyz.z / white.z);
    return {116 * fy - 16, 500 * (fx - fy), 200 * (fy - fz)};
}

LinearSrgb to_linear_srgb(const Xyz& xyz, Illuminant illuminant) {
    const Eigen::Vector3d from = bradford() * vector_of(white_point(illuminant));
    const Eigen::Vector3d to = bradford() * srgb_white();
    const Eigen::Vector3d cones =
        (bradford() * vector_of(xyz)).cwiseProduct(to.cwiseQuotient(from));
    const Eigen::Vector3d rgb = xyz_to_srgb() * (bradford().inverse() * cones);
    return {rgb[0], rgb[1], rgb[2]};
}

bool covers_the_visible(const std::vector<double>& wavelength_nm) {
    constexpr std::size_t kFewest = 8;
    constexpr double kBlue_nm = 430.0, kRed_nm = 650.0;
    return wavelength_nm.size() >= kFewest && wavelength_nm.front() <= kBlue_nm &&
           wavelength_nm.back() >= kRed_nm;
}

double encode_srgb(double linear) {
    const double size = std::abs(linear);
    const double encoded =
        size <= 0.0031308 ? 12.92 * size : 1.055 * std::pow(size, 1.0 / 2.4) - 0.055;
    return std::copysign(encoded, linear);
}

std::array<std::uint8_t, 3> to_srgb8(const LinearSrgb& colour) {
    const auto byte = [](double linear) {
        const double encoded = std::clamp(encode_srgb(linear), 0.0, 1.0);
        return static_cast<std::uint8_t>(std::lround(255.0 * encoded));
    };
    return {byte(colour.red), byte(colour.green), byte(colour.blue)};
}

}  // namespace miebrdf
