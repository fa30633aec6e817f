#include "rte/first_order/meridian_planes.h"

#include <cmath>
#include <memory>
#include <numbers>
#include <utility>

#include "rte/phase/matrix_strengths.h"

namespace miebrdf::rte {
namespace {

// Turns Q and U by an angle of which a vector (cosine, sine) of any length is known.
Eigen::Matrix4d turn(double x, double y) {
    const double square = x * x + y * y;
    const double cosine = (x - y) * (x + y) / square, sine = 2.0 * x * y / square;
    Eigen::Matrix4d result = Eigen::Matrix4d::Identity();
    result(1, 1) = result(2, 2) = cosine;
    result(1, 2) = sine;
    result(2, 1) = -sine;
    return result;
}

// The other ray along the two axes of a ray's meridian plane, times sin Theta.
struct OtherRay {
    double x_in, y_in, x_out, y_out;
};

constexpr double kStraight = 1e-28;  // squared sine below which any plane of scattering will do

// @param c, s  cosine and sine of half the azimuth
OtherRay ray_back(double mu_in, double mu_out, double c, double s) {
    const double sine_in = std::sqrt((1.0 - mu_in) * (1.0 + mu_in));
    const double sine_out = std::sqrt((1.0 - mu_out) * (1.0 + mu_out));
    const double sine_azimuth = 2.0 * s * c;
    // Near backscattering both components are small: mu_in sine_out - mu_out sine_in is written
    // without cancellation, and cos(azimuth) = 2 c^2 - 1.
    const double sum = mu_in * sine_out + mu_out * sine_in;
    const double skew = sum > 0.0 ? (mu_in - mu_out) * (mu_in + mu_out) / sum : 0.0;
    const OtherRay ray{skew - 2.0 * mu_in * sine_out * c * c, sine_out * sine_azimuth,
                       -skew - 2.0 * mu_out * sine_in * c * c, sine_in * sine_azimuth};
    if (ray.x_in * ray.x_in + ray.y_in * ray.y_in >= kStraight) return ray;
    const double cos_azimuth = 2.0 * c * c - 1.0;  // straight back
    return {1.0, 0.0, mu_in * mu_out * cos_azimuth - sine_in * sine_out, -mu_in * sine_azimuth};
}

// Light that goes on is light that turns back, with the outgoing ray mirrored at the horizontal and
// the azimuth counted from the other side.
OtherRay ray_forward(double mu_in, double mu_out, double c, double s) {
    const OtherRay back = ray_back(mu_in, mu_out, s, c);
    return {-back.x_in, back.y_in, -back.x_out, -back.y_out};
}

// F from the plane of scattering to the meridian planes.
Eigen::Matrix4d turned_from_plane(const ScatteringMatrix& matrix, const OtherRay& other) {
    Eigen::Matrix4d F = Eigen::Matrix4d::Zero();
    F(0, 0) = matrix.a1, F(1, 1) = matrix.a2, F(2, 2) = matrix.a3, F(3, 3) = matrix.a4;
    F(0, 1) = F(1, 0) = matrix.b1;
    F(2, 3) = matrix.b2, F(3, 2) = -matrix.b2;
    return turn(other.x_out, -other.y_out) * F * turn(other.x_in, other.y_in);
}

// The upper left of turned_from_plane.
Eigen::Matrix2d intensity_from_plane(const ScatteringMatrix& F, const OtherRay& other) {
    const auto& [x_in, y_in, x_out, y_out] = other;
    const double in = 1.0 / (x_in * x_in + y_in * y_in);
    const double out = 1.0 / (x_out * x_out + y_out * y_out);
    const double c_in = (x_in - y_in) * (x_in + y_in) * in, s_in = 2.0 * x_in * y_in * in;
    const double c_out = (x_out - y_out) * (x_out + y_out) * out, s_out = 2.0 * x_out * y_out * out;
    Eigen::Matrix2d result;
    result << F.a1, F.b1 * c_in, F.b1 * c_out, F.a2 * c_out * c_in + F.a3 * s_out * s_in;
    return result;
}

}  // namespace

Eigen::Matrix4d turned_to_meridians(const ScatteringMatrix& matrix, double mu_in, double mu_out,
                                    double azimuth_deg) {
    const double half = 0.5 * azimuth_deg * (std::numbers::pi / 180.0);
    return turned_from_plane(matrix, ray_back(mu_in, mu_out, std::cos(half), std::sin(half)));
}

Eigen::Matrix4d turned_forward(const ScatteringMatrix& matrix, double mu_in, double mu_out,
                               double azimuth_deg) {
    const double half = 0.5 * azimuth_deg * (std::numbers::pi / 180.0);
    return turned_from_plane(matrix, ray_forward(mu_in, mu_out, std::cos(half), std::sin(half)));
}

Eigen::Matrix2d turned_intensity(const ScatteringMatrix& matrix, double mu_in, double mu_out,
                                 double half_cosine, double half_sine) {
    return intensity_from_plane(matrix, ray_back(mu_in, mu_out, half_cosine, half_sine));
}

Eigen::Matrix2d turned_forward_intensity(const ScatteringMatrix& matrix, double mu_in,
                                         double mu_out, double half_cosine, double half_sine) {
    return intensity_from_plane(matrix, ray_forward(mu_in, mu_out, half_cosine, half_sine));
}

Optics as_seen_by_equations(const ScaledMedium& medium) {
    const MatrixStrengths strengths = matrix_strengths(medium);
    const ScaledOptics& scaled = medium.scaled;
    Optics seen;
    seen.single_scattering_albedo = scaled.albedo * scaled.depth_factor;
    seen.chi.assign(scaled.chi.data(), scaled.chi.data() + scaled.chi.size());
    if (!medium.exact.polarisation || scaled.albedo == 0.0) return seen;
    Polarisation polarisation;
    for (Eigen::Index l = 0; l < strengths.first.size(); ++l) {
        const double c = strengths.cosine[l], s = strengths.sine[l];
        const double first = strengths.first[l], second = strengths.second[l];
        polarisation.a2.push_back((first * s * s + second * c * c) / scaled.albedo);
        polarisation.a3.push_back(strengths.a3[l] / scaled.albedo);
        polarisation.a4.push_back(strengths.a4[l] / scaled.albedo);
        polarisation.b1.push_back((first - second) * c * s / scaled.albedo);
        polarisation.b2.push_back(strengths.b2[l] / scaled.albedo);
    }
    seen.polarisation = std::make_shared<const Polarisation>(std::move(polarisation));
    return seen;
}

}  // namespace miebrdf::rte
