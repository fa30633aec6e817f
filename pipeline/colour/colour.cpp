#include <miebrdf/colour.h>

#include <fmt/format.h>

#include <Eigen/LU>
#include <algorithm>
#include <cmath>
#include <numbers>

#include <miebrdf/error.h>
#include <miebrdf/value_derivatives.h>

namespace miebrdf {
namespace {

constexpr int kFirst_nm = 360;
constexpr int kLast_nm = 830;

Eigen::Vector3d vector_of(const Xyz& c) { return {c.x, c.y, c.z}; }

/// x, y to X, Y, Z with Y = 1.
Eigen::Vector3d from_chromaticity(double x, double y) { return {x / y, 1.0, (1.0 - x - y) / y}; }

/// A space of linear red, green and blue: its white, and XYZ to RGB from its primaries, so that red
/// + green + blue is the white to rounding, which printed four-digit matrices are not.
struct RgbSpace {
    Eigen::Vector3d white;
    Eigen::Matrix3d from_xyz;

    RgbSpace(const Eigen::Vector3d& red, const Eigen::Vector3d& green, const Eigen::Vector3d& blue,
             const Eigen::Vector3d& white_point)
        : white(white_point) {
        Eigen::Matrix3d primaries;
        primaries << red, green, blue;
        const Eigen::Vector3d luminances = primaries.inverse() * white;
        from_xyz = (primaries * luminances.asDiagonal()).inverse();
    }
};

/// Lam 1985: cone-like responses in which adaptation is a scaling.
const Eigen::Matrix3d& bradford() {
    static const Eigen::Matrix3d matrix = (Eigen::Matrix3d() << 0.8951, 0.2664, -0.1614, -0.7502,
                                           1.7135, 0.0367, 0.0389, -0.0685, 1.0296)
                                              .finished();
    return matrix;
}

void check_ascending(const std::vector<double>& wavelength_nm) {
    if (wavelength_nm.empty()) throw UsageError("colour of a spectrum without wavelengths");
    for (std::size_t i = 0; i < wavelength_nm.size(); ++i) {
        const double before = i == 0 ? 0.0 : wavelength_nm[i - 1];
        if (!(wavelength_nm[i] > before && std::isfinite(wavelength_nm[i]))) {
            throw UsageError(fmt::format("wavelengths must ascend: {} nm after {} nm",
                                         wavelength_nm[i], before));
        }
    }
}

struct Share {
    std::size_t place;
    double weight;
};

/// The neighbours that a value at `nm` is made of.
std::vector<Share> interpolation_at(const std::vector<double>& x, double nm, Between between) {
    const auto above = std::upper_bound(x.begin(), x.end(), nm);
    const std::size_t right = static_cast<std::size_t>(above - x.begin());
    if (right == 0) return {{0, 1.0}};
    if (right == x.size()) return {{right - 1, 1.0}};
    if (between == Between::cubic && right >= 2 && right + 1 < x.size()) {
        const std::size_t first = right - 2;
        const double steps[3] = {x[right - 1] - x[first], x[right] - x[right - 1],
                                 x[right + 1] - x[right]};
        // Lagrange's polynomial swings where its points are spaced very unevenly.
        constexpr double kMostUneven = 3.0;
        if (*std::max_element(steps, steps + 3) <=
            kMostUneven * *std::min_element(steps, steps + 3)) {
            std::vector<Share> shares;
            for (std::size_t i = first; i < first + 4; ++i) {
                double weight = 1.0;
                for (std::size_t j = first; j < first + 4; ++j) {
                    if (j != i) weight *= (nm - x[j]) / (x[i] - x[j]);
                }
                shares.push_back({i, weight});
            }
            return shares;
        }
    }
    const double t = (nm - x[right - 1]) / (x[right] - x[right - 1]);
    return {{right - 1, 1.0 - t}, {right, t}};
}

template <typename Value>
std::vector<Value> chosen(const std::vector<Value>& all, const std::vector<std::size_t>& places) {
    std::vector<Value> some(places.size());
    std::transform(places.begin(), places.end(), some.begin(),
                   [&](std::size_t i) { return all[i]; });
    return some;
}

}  // namespace

ObserverWeights observer_weights(const std::vector<double>& wavelength_nm, const Viewing& viewing,
                                 Between between) {
    check_ascending(wavelength_nm);
    const std::size_t count = wavelength_nm.size();
    ObserverWeights weights{std::vector<double>(count), std::vector<double>(count),
                            std::vector<double>(count)};
    double luminance = 0;
    for (int nm = kFirst_nm; nm <= kLast_nm; ++nm) {
        const double power = relative_power(viewing.illuminant, nm);
        const ColourMatching c = colour_matching(nm, viewing.observer);
        luminance += power * c.y;
        for (const auto& [i, share] : interpolation_at(wavelength_nm, nm, between)) {
            weights.x[i] += share * power * c.x;
            weights.y[i] += share * power * c.y;
            weights.z[i] += share * power * c.z;
        }
    }
    for (auto* list : {&weights.x, &weights.y, &weights.z}) {
        for (double& weight : *list) weight /= luminance;
    }
    return weights;
}

Xyz to_xyz(const ObserverWeights& weights, const std::vector<double>& reflectance) {
    if (reflectance.size() != weights.y.size()) {
        throw UsageError(fmt::format("{} reflectances for {} wavelengths", reflectance.size(),
                                     weights.y.size()));
    }
    Xyz sum;
    for (std::size_t i = 0; i < reflectance.size(); ++i) {
        sum.x += weights.x[i] * reflectance[i];
        sum.y += weights.y[i] * reflectance[i];
        sum.z += weights.z[i] * reflectance[i];
    }
    return sum;
}

Xyz white_point(const Viewing& viewing) {
    const auto white_of = [](Illuminant light, Observer eye) {
        return to_xyz(observer_weights({560.0}, {light, eye}), {1.0});
    };
    static const auto whites = [&] {
        std::array<std::array<Xyz, 2>, 4> all;
        for (const Illuminant light :
             {Illuminant::d65, Illuminant::e, Illuminant::a, Illuminant::d50}) {
            for (const Observer eye : {Observer::two_degrees, Observer::ten_degrees})
                all[std::size_t(light)][std::size_t(eye)] = white_of(light, eye);
        }
        return all;
    }();
    return whites[std::size_t(viewing.illuminant)][std::size_t(viewing.observer)];
}

namespace {

// f of ISO/CIE 11664-4: a cube root, and below (6/29)^3 its tangent.
constexpr double kLabDelta = 6.0 / 29.0;

bool is_cube_root(double t) { return t > kLabDelta * kLabDelta * kLabDelta; }

double lab_f(double t) {
    return is_cube_root(t) ? std::cbrt(t) : t / (3 * kLabDelta * kLabDelta) + 4.0 / 29.0;
}

double lab_f_slope(double t) {
    const double root = is_cube_root(t) ? std::cbrt(t) : kLabDelta;
    return 1.0 / (3 * root * root);
}

Lab lab_of(double fx, double fy, double fz) { return {116 * fy, 500 * (fx - fy), 200 * (fy - fz)}; }

}  // namespace

Lab to_lab(const Xyz& xyz, const Viewing& viewing) {
    const Xyz white = white_point(viewing);
    Lab lab = lab_of(lab_f(xyz.x / white.x), lab_f(xyz.y / white.y), lab_f(xyz.z / white.z));
    lab.l -= 16;
    return lab;
}

namespace {

/// The colour adapted from the illuminant to the white of the space.
Eigen::Vector3d adapted(const Xyz& xyz, const Viewing& viewing, const RgbSpace& space) {
    const Eigen::Vector3d from = bradford() * vector_of(white_point(viewing));
    const Eigen::Vector3d to = bradford() * space.white;
    const Eigen::Vector3d cones =
        (bradford() * vector_of(xyz)).cwiseProduct(to.cwiseQuotient(from));
    return space.from_xyz * (bradford().inverse() * cones);
}

}  // namespace

LinearSrgb to_linear_srgb(const Xyz& xyz, const Viewing& viewing) {
    static const RgbSpace srgb(from_chromaticity(0.64, 0.33), from_chromaticity(0.30, 0.60),
                               from_chromaticity(0.15, 0.06), from_chromaticity(0.3127, 0.3290));
    const Eigen::Vector3d rgb = adapted(xyz, viewing, srgb);
    return {rgb[0], rgb[1], rgb[2]};
}

std::array<double, 3> to_acescg(const Xyz& xyz, const Viewing& viewing) {
    static const RgbSpace ap1(from_chromaticity(0.713, 0.293), from_chromaticity(0.165, 0.830),
                              from_chromaticity(0.128, 0.044), from_chromaticity(0.32168, 0.33767));
    const Eigen::Vector3d rgb = adapted(xyz, viewing, ap1);
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

namespace {

double encode_srgb_slope(double linear) {
    const double size = std::abs(linear);
    return size <= 0.0031308 ? 12.92 : 1.055 / 2.4 * std::pow(size, 1.0 / 2.4 - 1.0);
}

}  // namespace

std::array<std::uint8_t, 3> to_srgb8(const LinearSrgb& colour) {
    const auto byte = [](double linear) {
        const double encoded = std::clamp(encode_srgb(linear), 0.0, 1.0);
        if (std::isnan(encoded)) return std::uint8_t{0};
        return static_cast<std::uint8_t>(std::lround(255.0 * encoded));
    };
    return {byte(colour.red), byte(colour.green), byte(colour.blue)};
}

Colorimeter::Colorimeter(const std::vector<double>& wavelength_nm, const Viewing& viewing)
    : viewing_(viewing), weights_(observer_weights(wavelength_nm, viewing, Between::cubic)) {
    if (wavelength_nm.size() < 3) {
        throw UsageError(
            fmt::format("a colour from {} wavelengths; allowed: 3 or more", wavelength_nm.size()));
    }
    for (std::size_t i = 0; i < wavelength_nm.size(); i += 2) every_other_.push_back(i);
    if (wavelength_nm.size() % 2 == 0) every_other_.push_back(wavelength_nm.size() - 1);
    coarse_weights_ =
        observer_weights(chosen(wavelength_nm, every_other_), viewing, Between::cubic);
}

Colour Colorimeter::operator()(const std::vector<double>& reflectance) const {
    Colour colour;
    colour.xyz = to_xyz(weights_, reflectance);
    colour.lab = to_lab(colour.xyz, viewing_);
    colour.lch = to_lch(colour.lab);
    colour.srgb = to_linear_srgb(colour.xyz, viewing_);
    const Xyz coarse = to_xyz(coarse_weights_, chosen(reflectance, every_other_));
    colour.error_estimate = delta_e_76(colour.lab, to_lab(coarse, viewing_));
    return colour;
}

ColourDerivative derivative_of_colour(const Colorimeter& colorimeter,
                                      const std::vector<double>& reflectance,
                                      const std::vector<double>& slope) {
    const Colour at = colorimeter(reflectance), change = colorimeter(slope);
    const Xyz white = white_point(colorimeter.viewing());
    const auto& [dx, dy, dz] = change.xyz;
    ColourDerivative all;
    all.xyz = change.xyz;
    all.srgb = change.srgb;
    all.lab = lab_of(lab_f_slope(at.xyz.x / white.x) * dx / white.x,
                     lab_f_slope(at.xyz.y / white.y) * dy / white.y,
                     lab_f_slope(at.xyz.z / white.z) * dz / white.z);
    const double a = at.lab.a, b = at.lab.b, chroma = at.lch.c;
    constexpr double degrees = 180.0 / std::numbers::pi;
    all.lch = {all.lab.l, (a * all.lab.a + b * all.lab.b) / chroma,
               degrees * (a * all.lab.b - b * all.lab.a) / (chroma * chroma)};
    all.encoded = {encode_srgb_slope(at.srgb.red) * change.srgb.red,
                   encode_srgb_slope(at.srgb.green) * change.srgb.green,
                   encode_srgb_slope(at.srgb.blue) * change.srgb.blue};
    return all;
}

}  // namespace miebrdf
