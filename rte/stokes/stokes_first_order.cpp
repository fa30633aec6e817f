#include "rte/stokes/stokes_first_order.h"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <utility>

#include "rte/first_order/first_order.h"
#include "rte/first_order/narrow_features.h"
#include "rte/math/tolerance_budget.h"
#include "rte/phase/polarisation.h"
#include "rte/stokes/matrix_strengths.h"

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
    // As there, with both rays on one side: cos(azimuth) = 1 - 2 s^2.
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

std::vector<Optics> media_of_first_order(const std::vector<ScaledMedium>& media, bool exact) {
    std::vector<Optics> optics;
    optics.reserve(media.size());
    for (const ScaledMedium& medium : media)
        optics.push_back(exact ? medium.exact : as_seen_by_equations(medium));
    return optics;
}

Eigen::Matrix4d scattered_once(const std::vector<ScaledMedium>& media,
                               const std::vector<Optics>& optics, double mu_in, double mu_out,
                               double azimuth_deg) {
    std::vector<double> weights(media.size());
    first_order_weights(media, mu_in, mu_out, weights);
    const double cosine =
        cos_scattering_angle(mu_in, mu_out, std::cos(azimuth_deg * (std::numbers::pi / 180.0)));
    Eigen::Matrix4d sum = Eigen::Matrix4d::Zero();
    for (std::size_t k = 0; k < media.size(); ++k) {
        if (weights[k] == 0.0) continue;
        const double strength =
            weights[k] * optics[k].single_scattering_albedo / media[k].scaled.depth_factor;
        sum += strength *
               turned_to_meridians(exact_matrix(optics[k], cosine), mu_in, mu_out, azimuth_deg);
    }
    return sum;
}

StokesFirstOrder::StokesFirstOrder(const Directions& directions, int components,
                                   const SolverOptions& options)
    : directions_(directions), components_(components), options_(options) {}

std::vector<double> StokesFirstOrder::turned(const std::vector<Optics>& media) const {
    const std::size_t azimuths = directions_.azimuth_deg.size();
    const std::size_t c = std::size_t(components_), elements = c * c;
    std::vector<double> result(media.size() * directions_.mu_in.size() * directions_.mu_out.size() *
                               azimuths * elements);
    double* block = result.data();
    for (const Optics& optics : media) {
        for (const double mu_in : directions_.mu_in) {
            for (const double mu_out : directions_.mu_out) {
                for (std::size_t a = 0; a < azimuths; ++a) {
                    const double azimuth_deg = directions_.azimuth_deg[a];
                    const double cosine = cos_scattering_angle(
                        mu_in, mu_out, std::cos(azimuth_deg * (std::numbers::pi / 180.0)));
                    const Eigen::Matrix4d M = turned_to_meridians(exact_matrix(optics, cosine),
                                                                  mu_in, mu_out, azimuth_deg);
                    for (std::size_t e = 0; e < elements; ++e)
                        block[e * azimuths + a] = M(Eigen::Index(e / c), Eigen::Index(e % c));
                }
                block += elements * azimuths;
            }
        }
    }
    return result;
}

void StokesFirstOrder::add_to(std::vector<double>& reflection,
                              const std::vector<ScaledMedium>& media) {
    const bool exact = options_.single_scattering_correction;
    std::vector<double> approximate;
    const std::vector<Optics> optics = media_of_first_order(media, exact);
    if (exact && exact_.empty()) {
        exact_ = turned(optics);
    } else if (!exact) {
        approximate = turned(optics);
    }
    const std::vector<double>& matrices = exact ? exact_ : approximate;
    const std::size_t pairs = directions_.mu_in.size() * directions_.mu_out.size();
    const std::size_t block = pairs > 0 ? reflection.size() / pairs : 0;
    std::vector<double> first_order(reflection.size(), 0.0);
    std::vector<double> weights(media.size());
    for (std::size_t pair = 0; pair < pairs; ++pair) {
        first_order_weights(media, directions_.mu_in[pair / directions_.mu_out.size()],
                            directions_.mu_out[pair % directions_.mu_out.size()], weights);
        for (std::size_t k = 0; k < media.size(); ++k) {
            const double scale =
                weights[k] * optics[k].single_scattering_albedo / media[k].scaled.depth_factor;
            const double* matrix = matrices.data() + (k * pairs + pair) * block;
            for (std::size_t v = 0; v < block; ++v)
                first_order[pair * block + v] += scale * matrix[v];
        }
    }
    if (exact) add_narrow_features(first_order, media);
    for (std::size_t v = 0; v < reflection.size(); ++v) reflection[v] += first_order[v];
}

// What R11 is corrected by, the whole matrix is: light of a glory keeps its polarisation.
void StokesFirstOrder::add_narrow_features(std::vector<double>& first_order,
                                           const std::vector<ScaledMedium>& media) const {
    constexpr std::size_t many_directions = 2000;  // from here on a table pays
    double mu_least = 1.0;
    for (const double mu : directions_.mu_in) mu_least = std::min(mu_least, mu);
    for (const double mu : directions_.mu_out) mu_least = std::min(mu_least, mu);
    NarrowFeatures narrow({&media, 1}, mu_least, kNarrowFeaturesShare * options_.tolerance);
    if (narrow.none()) return;
    std::vector<double> cos_azimuth;
    for (const double azimuth_deg : directions_.azimuth_deg)
        cos_azimuth.push_back(std::cos(azimuth_deg * (std::numbers::pi / 180.0)));
    const std::size_t azimuths = cos_azimuth.size();
    const std::size_t elements = std::size_t(components_ * components_);
    std::vector<double> change(first_order.size() / elements, 0.0);
    if (change.size() > many_directions) narrow.tabulate();
    narrow.add_to(change.data(), directions_.mu_in, directions_.mu_out, cos_azimuth);
    for (std::size_t pair = 0; pair * azimuths < change.size(); ++pair) {
        double* matrix = first_order.data() + pair * elements * azimuths;
        for (std::size_t a = 0; a < azimuths; ++a) {
            if (!(matrix[a] > 0.0)) continue;
            const double factor = 1.0 + change[pair * azimuths + a] / matrix[a];
            for (std::size_t e = 0; e < elements; ++e) matrix[e * azimuths + a] *= factor;
        }
    }
}

}  // namespace miebrdf::rte
