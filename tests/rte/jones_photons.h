// Photons that carry their electric field: Rayleigh scattering under a smooth boundary, over a
// black ground, a Lambertian one or a mirror. Nothing here knows of Stokes vectors but the last
// line of record(): a dipole and Fresnel's amplitudes act on vectors in space.
#pragma once

#include <Eigen/Dense>
#include <array>
#include <cmath>
#include <complex>
#include <limits>
#include <numbers>
#include <random>

namespace miebrdf::support {

struct PhotonScene {
    double index = 1.5;   ///< of the medium, under air
    double albedo = 0.9;  ///< of single scattering
    double depth = std::numeric_limits<double>::infinity();
    double ground_albedo = 0.0;
    std::complex<double> mirror = 0.0;  ///< n + ik; 0: none
};

/// The reflection matrix at one pair of directions, mirror's delta left out, with the standard
/// errors of its elements.
struct PhotonMatrix {
    Eigen::Matrix4d mean, error;
};

class JonesPhotons {
  public:
    using Field = Eigen::Vector3cd;
    using Ray = Eigen::Vector3d;

    JonesPhotons(const PhotonScene& scene, unsigned seed) : scene_(scene), random_(seed) {}

    /// @param photons  of each of six states of polarisation
    PhotonMatrix reflect(double mu_in, double mu_out, double azimuth_deg, int photons) {
        const double azimuth = azimuth_deg * std::numbers::pi / 180.0;
        const double n2 = scene_.index * scene_.index;
        const auto inside = [&](double mu) { return std::sqrt(1.0 - (1.0 - mu * mu) / n2); };
        out_ = ray(inside(mu_out), azimuth);
        const Ray in = ray(-inside(mu_in), 0.0);
        const double half = std::numbers::sqrt2 / 2.0;
        const std::complex<double> i(0.0, 1.0);
        // V = -2 Im(E_theta E_phi*): E_phi = +i E_theta has V = +1.
        const std::array<std::array<std::complex<double>, 2>, 6> states{{{1.0, 0.0},
                                                                         {0.0, 1.0},
                                                                         {half, half},
                                                                         {half, -half},
                                                                         {half, half * i},
                                                                         {half, -half * i}}};
        std::array<Eigen::Vector4d, 6> mean, square;
        for (std::size_t s = 0; s < 6; ++s) {
            mean[s] = square[s] = Eigen::Vector4d::Zero();
            for (int k = 0; k < photons; ++k) {
                signal_.setZero();
                const auto [p, e] = passing(-in.z());
                walk(in, p * states[s][0] * theta(in) + e * states[s][1] * phi(in));
                mean[s] += signal_;
                square[s] += signal_.cwiseAbs2();
            }
            mean[s] /= photons;
            square[s] = (square[s] / photons - mean[s].cwiseAbs2()) / photons;
        }
        PhotonMatrix matrix;
        matrix.mean.col(0).setZero();
        matrix.error.col(0).setZero();
        for (std::size_t s = 0; s < 6; ++s) {
            matrix.mean.col(0) += mean[s] / 6.0;
            matrix.error.col(0) += square[s] / 36.0;
        }
        for (std::size_t pair = 0; pair < 3; ++pair) {
            matrix.mean.col(Eigen::Index(pair) + 1) = 0.5 * (mean[2 * pair] - mean[2 * pair + 1]);
            matrix.error.col(Eigen::Index(pair) + 1) =
                0.25 * (square[2 * pair] + square[2 * pair + 1]);
        }
        matrix.error = matrix.error.cwiseSqrt();
        return matrix;
    }

  private:
    static Ray ray(double cosine, double azimuth) {
        const double sine = std::sqrt(1.0 - cosine * cosine);
        return {sine * std::cos(azimuth), sine * std::sin(azimuth), cosine};
    }
    static Ray phi(const Ray& k) {
        const double sine = std::hypot(k.x(), k.y());
        return {-k.y() / sine, k.x() / sine, 0.0};
    }
    static Ray theta(const Ray& k) { return phi(k).cross(k); }

    double uniform() { return std::generate_canonical<double, 53>(random_); }

    // Roots of the shares that pass between air and the medium, parallel and across.
    std::array<double, 2> passing(double mu) const {
        const auto [p, s] = amplitudes(1.0 / scene_.index, mu);
        return {std::sqrt(std::max(0.0, 1.0 - std::norm(p))),
                std::sqrt(std::max(0.0, 1.0 - std::norm(s)))};
    }
    // r_p, r_s from inside to something of relative index m.
    static std::array<std::complex<double>, 2> amplitudes(std::complex<double> m, double mu) {
        std::complex<double> far = std::sqrt(1.0 - (1.0 - mu * mu) / (m * m));
        if (far.imag() < 0.0) far = -far;  // decays on the far side, time factor exp(-i omega t)
        return {(m * mu - far) / (m * mu + far), (mu - m * far) / (mu + m * far)};
    }
    // The field after reflection at a horizontal plane; the ray is turned.
    static Field reflected(const std::array<std::complex<double>, 2>& r, const Field& E, Ray& k) {
        const Ray s = phi(k);
        const std::complex<double> across = s.cast<std::complex<double>>().dot(E);
        const std::complex<double> parallel = s.cross(k).cast<std::complex<double>>().dot(E);
        k.z() = -k.z();
        return r[1] * across * s + r[0] * parallel * s.cross(k);
    }

    // Records what a wave going up at the depth sends to the observer, with all that comes back
    // from the boundary by way of the mirror.
    void record(Field E, double depth) {
        Ray k = out_;
        E *= std::exp(-0.5 * depth / k.z());
        const auto [p, e] = passing(k.z());
        for (;;) {
            const std::complex<double> a = p * theta(k).cast<std::complex<double>>().dot(E);
            const std::complex<double> b = e * phi(k).cast<std::complex<double>>().dot(E);
            signal_ +=
                Eigen::Vector4d(std::norm(a) + std::norm(b), std::norm(a) - std::norm(b),
                                2.0 * (a * std::conj(b)).real(), -2.0 * (a * std::conj(b)).imag()) *
                (std::numbers::pi / (scene_.index * scene_.index * k.z()));
            if (scene_.mirror == 0.0 || E.squaredNorm() < 1e-9) return;
            E = reflected(amplitudes(1.0 / scene_.index, k.z()), E, k);
            E *= std::exp(-scene_.depth / -k.z());  // there and back
            E = reflected(amplitudes(scene_.mirror / scene_.index, -k.z()), E, k);
        }
    }

    void record_scattered(const Field& E, double depth) {
        const double share = std::sqrt(3.0 / (8.0 * std::numbers::pi));
        record(share * dipole(E, out_), depth);
        if (scene_.mirror == 0.0) return;
        Ray down = out_;
        down.z() = -down.z();
        Field F = share * dipole(E, down);
        F *= std::exp(-0.5 * (scene_.depth - depth) / out_.z());
        record(reflected(amplitudes(scene_.mirror / scene_.index, out_.z()), F, down),
               scene_.depth);
    }

    static Field dipole(const Field& E, const Ray& k) {
        return E - k * k.cast<std::complex<double>>().dot(E);
    }

    // The square of the field is the photon's weight.
    void walk(Ray k, Field E) {
        double depth = 0.0;
        for (;;) {
            constexpr double faint = 1e-3;
            const double weight = E.squaredNorm();
            if (weight < faint) {
                if (uniform() > weight / faint) return;
                E *= std::sqrt(faint / weight);
            }
            depth -= k.z() * -std::log(1.0 - uniform());
            if (depth < 0.0) {
                depth = 0.0;
                E = reflected(amplitudes(1.0 / scene_.index, k.z()), E, k);
            } else if (depth > scene_.depth) {
                depth = scene_.depth;
                if (scene_.mirror != 0.0) {
                    E = reflected(amplitudes(scene_.mirror / scene_.index, -k.z()), E, k);
                } else if (scene_.ground_albedo > 0.0) {
                    E = leave_ground(E.squaredNorm() * scene_.ground_albedo, k);
                } else {
                    return;
                }
            } else {
                E *= std::sqrt(scene_.albedo);
                record_scattered(E, depth);
                const double before = E.squaredNorm();
                Field next;
                do {  // in proportion to the dipole's pattern, at most 1
                    k = ray(2.0 * uniform() - 1.0, 2.0 * std::numbers::pi * uniform());
                    next = dipole(E, k);
                } while (uniform() * before > next.squaredNorm());
                E = next * std::sqrt(before / next.squaredNorm());
            }
        }
    }

    // Unpolarised light in proportion to the cosine: one of two states by chance, both recorded.
    Field leave_ground(double weight, Ray& k) {
        const double seen = std::sqrt(0.5 * weight * out_.z() / std::numbers::pi);
        record(seen * theta(out_).cast<std::complex<double>>(), scene_.depth);
        record(seen * phi(out_).cast<std::complex<double>>(), scene_.depth);
        k = ray(std::sqrt(1.0 - uniform()), 2.0 * std::numbers::pi * uniform());
        return std::sqrt(weight) *
               (uniform() < 0.5 ? theta(k) : phi(k)).cast<std::complex<double>>();
    }

    PhotonScene scene_;
    std::mt19937_64 random_;
    Ray out_ = Ray::Zero();
    Eigen::Vector4d signal_ = Eigen::Vector4d::Zero();
};

}  // namespace miebrdf::support
