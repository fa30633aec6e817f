#include "pipeline/render/lighting.h"

#include <fmt/format.h>
#include <miebrdf/error.h>
#include <Eigen/Dense>
#include <Eigen/Geometry>

#include <algorithm>
#include <cmath>
#include <numbers>
#include <stdexcept>

#include <miebrdf/colour.h>
#include "pipeline/scene/number_list.h"

namespace miebrdf::render {

namespace {

/// Planck's law up to a factor; second radiation constant h c / k of CODATA 2018.
double planck(double wavelength_nm, double kelvin) {
    constexpr double kSecondConstant_nm_K = 1.438776877e7;
    return std::pow(wavelength_nm, -5.0) /
           std::expm1(kSecondConstant_nm_K / (wavelength_nm * kelvin));
}

/// Wavelengths beyond the eye get the illuminant's value at its end.
double white_power(double wavelength_nm) {
    return relative_power(Illuminant::d65,
                          std::clamp(wavelength_nm, kObserverShortest_nm, kObserverLongest_nm));
}

/// 3 x wavelengths: from a spectrum to linear sRGB.
Eigen::MatrixXd srgb_matrix(const std::vector<double>& wavelength_nm) {
    const auto count = Eigen::Index(wavelength_nm.size());
    if (is_rgb(wavelength_nm)) return Eigen::MatrixXd::Identity(3, 3);
    const ObserverWeights weights = observer_weights(wavelength_nm);
    Eigen::MatrixXd matrix(3, count);
    for (Eigen::Index w = 0; w < count; ++w) {
        const auto i = std::size_t(w);
        const LinearSrgb colour = to_linear_srgb(Xyz{weights.x[i], weights.y[i], weights.z[i]});
        matrix.col(w) << colour.red, colour.green, colour.blue;
    }
    return matrix;
}

}  // namespace

bool is_rgb(const std::vector<double>& wavelength_nm) {
    return wavelength_nm.size() == 3 && wavelength_nm[0] > wavelength_nm[1] &&
           wavelength_nm[1] > wavelength_nm[2];
}

Spectrum light_spectrum(const std::string& text, const std::vector<double>& wavelength_nm) {
    constexpr double kReference_nm = 560.0;
    const bool is_black_body = text.rfind("blackbody:", 0) == 0;
    double kelvin = 0.0;
    if (is_black_body) {
        kelvin = parse_number(text.substr(10), "temperature of a black body");
        if (!(kelvin >= 500.0 && kelvin <= 40000.0)) {
            throw UsageError(fmt::format("black body of {} K; allowed: 500 to 40000", kelvin));
        }
    } else if (text != "white" && text != "equal") {
        throw UsageError(fmt::format(
            "unknown light spectrum '{}'; allowed: white, equal, blackbody:KELVIN", text));
    }
    Spectrum spectrum;
    for (const double w : wavelength_nm) {
        double power = white_power(w) / white_power(kReference_nm);
        if (text == "equal") power = 1.0;
        if (is_black_body) power = planck(w, kelvin) / planck(kReference_nm, kelvin);
        spectrum.push_back(power * white_power(kReference_nm) / white_power(w));
    }
    return spectrum;
}

std::array<Spectrum, 3> colour_basis(const std::vector<double>& wavelength_nm) {
    const auto count = Eigen::Index(wavelength_nm.size());
    if (count < 3) throw UsageError("a coloured map of light needs three wavelengths or more");
    // Minimise |D s|^2 under M s = e_c: stationary points of the Lagrangian.
    const Eigen::MatrixXd M = srgb_matrix(wavelength_nm);
    Eigen::MatrixXd system = Eigen::MatrixXd::Zero(count + 3, count + 3);
    for (Eigen::Index w = 0; w + 1 < count; ++w) {
        system(w, w) += 1;
        system(w + 1, w + 1) += 1;
        system(w, w + 1) -= 1;
        system(w + 1, w) -= 1;
    }
    system.topRightCorner(count, 3) = M.transpose();
    system.bottomLeftCorner(3, count) = M;
    const Eigen::FullPivLU<Eigen::MatrixXd> solver(system);
    std::array<Spectrum, 3> basis;
    for (Eigen::Index c = 0; c < 3; ++c) {
        const Eigen::VectorXd solution = solver.solve(Eigen::VectorXd::Unit(count + 3, count + c));
        basis[std::size_t(c)].assign(solution.data(), solution.data() + count);
    }
    return basis;
}

Image to_linear_srgb(const Image& radiance, const std::vector<double>& wavelength_nm) {
    const Eigen::MatrixXd M = srgb_matrix(wavelength_nm);
    Image rgb(radiance.width, radiance.height, 3);
    for (int y = 0; y < rgb.height; ++y) {
        for (int x = 0; x < rgb.width; ++x) {
            const Eigen::Map<const Eigen::VectorXf> spectrum(radiance.pixel(x, y), M.cols());
            const Eigen::Vector3d colour = M * spectrum.cast<double>();
            for (int c = 0; c < 3; ++c) rgb.pixel(x, y)[c] = float(colour[c]);
        }
    }
    return rgb;
}

AreaLight square_light(const Eigen::Vector3d& target, const Eigen::Vector3d& towards,
                       double distance, double size_deg, const Spectrum& irradiance) {
    if (!(size_deg > 0.0 && size_deg <= 150.0)) {
        throw std::invalid_argument(
            fmt::format("area light of {} degrees; allowed: (0, 150]", size_deg));
    }
    const double half = std::tan(0.5 * size_deg * std::numbers::pi / 180);
    const bool is_vertical = std::abs(towards.y()) > 0.999;
    const Eigen::Vector3d up = is_vertical ? Eigen::Vector3d::UnitX() : Eigen::Vector3d::UnitY();
    AreaLight light;
    light.centre = target + distance * towards;
    const Eigen::Vector3d right = up.cross(-towards).normalized();
    light.half_width = half * distance * right;
    light.half_height = half * distance * (-towards).cross(right);
    // A square of half-side t at distance 1, parallel to the receiver, has the form factor
    // (4/pi) t/sqrt(1+t^2) atan(t/sqrt(1+t^2)): irradiance = pi * form factor * radiance.
    const double s = half / std::sqrt(1 + half * half);
    for (const double e : irradiance) light.radiance.push_back(e / (4 * s * std::atan(s)));
    return light;
}

}  // namespace miebrdf::render
