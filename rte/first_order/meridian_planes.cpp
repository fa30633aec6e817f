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

// F from the plane of scattering to those of which the other ray has the components (x, y).
Eigen::Matrix4d turned_from_plane(const ScatteringMatrix& matrix, double x_in, double y_in,
                                  double x_out, double y_out) {
    Eigen::Matrix4d F = Eigen::Matrix4d::Zero();
    F(0, 0) = matrix.a1, F(1, 1) = matrix.a2, F(2, 2) = matrix.a3, F(3, 3) = matrix.a4;
    F(0, 1) = F(1, 0) = matrix.b1;
    F(2, 3) = matrix.b2, F(3, 2) = -matrix.b2;
    return turn(x_out, -y_out) * F * turn(x_in, y_in);
}

constexpr double kStraight = 1e-28;  // squared sine below which any plane of scattering will do

}  // namespace

Eigen::Matrix4d turned_to_meridians(const ScatteringMatrix& matrix, double mu_in, double mu_out,
                                    double azimuth_deg) {
    const double sine_in = std::sqrt((1.0 - mu_in) * (1.0 + mu_in));
    const double sine_out = std::sqrt((1.0 - mu_out) * (1.0 + mu_out));
    const double half = 0.5 * azimuth_deg * (std::numbers::pi / 180.0);
    const double c = std::cos(half), sine_azimuth = 2.0 * std::sin(half) * c;
    // The other ray along the two axes of a ray's meridian plane, times sin Theta. Near
    // backscattering both components are small: mu_in sine_out - mu_out sine_in is written without
    // cancellation, and cos(azimuth) = 2 c^2 - 1.
    const double sum = mu_in * sine_out + mu_out * sine_in;
    const double skew = sum > 0.0 ? (mu_in - mu_out) * (mu_in + mu_out) / sum : 0.0;
    double x_in = skew - 2.0 * mu_in * sine_out * c * c;
    double y_in = sine_out * sine_azimuth;
    double x_out = -skew - 2.0 * mu_out * sine_in * c * c;
    double y_out = sine_in * sine_azimuth;
    if (x_in * x_in + y_in * y_in < kStraight) {  // straight back
        x_in = 1.0, y_in = 0.0;
        const double cos_azimuth = 2.0 * c * c - 1.0;
        x_out = mu_in * mu_out * cos_azimuth - sine_in * sine_out;
        y_out = -mu_in * sine_azimuth;
    }
    return turned_from_plane(matrix, x_in, y_in, x_out, y_out);
}

Eigen::Matrix4d turned_forward(const ScatteringMatrix& matrix, double mu_in, double mu_out,
                               double azimuth_deg) {
    const double sine_in = std::sqrt((1.0 - mu_in) * (1.0 + mu_in));
    const double sine_out = std::sqrt((1.0 - mu_out) * (1.0 + mu_out));
    const double half = 0.5 * azimuth_deg * (std::numbers::pi / 180.0);
    const double s = std::sin(half), sine_azimuth = 2.0 * s * std::cos(half);
    // The components are those of turned_to_meridians with both rays on one side:
    // cos(azimuth) = 1 - 2 s^2.
    const double sum = mu_in * sine_out + mu_out * sine_in;
    const double skew = sum > 0.0 ? (mu_in - mu_out) * (mu_in + mu_out) / sum : 0.0;
    double x_in = -skew + 2.0 * mu_in * sine_out * s * s;
    double y_in = sine_out * sine_azimuth;
    double x_out = skew + 2.0 * mu_out * sine_in * s * s;
    double y_out = -sine_in * sine_azimuth;
    if (x_in * x_in + y_in * y_in < kStraight) {  // straight on
        x_in = 1.0, y_in = 0.0;
        x_out = mu_in * mu_out * (1.0 - 2.0 * s * s) + sine_in * sine_out;
        y_out = mu_in * sine_azimuth;
    }
    return turned_from_plane(matrix, x_in, y_in, x_out, y_out);
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
