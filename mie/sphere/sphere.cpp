// Efficiencies and amplitudes of one sphere, from its partial waves.
#include <miebrdf/sphere.h>

#include <fmt/format.h>

#include <boost/math/special_functions/cos_pi.hpp>
#include <cmath>
#include <limits>
#include <type_traits>
#include <vector>

#include <miebrdf/error.h>
#include "mie/sphere/faint_absorption.h"
#include "mie/sphere/lane_waves.h"
#include "mie/sphere/radial_functions.h"

namespace miebrdf::mie {
namespace {

using Complex = std::complex<double>;
using ConstLanes = Eigen::Map<const Lanes>;

/// Sums over the orders of one sphere.
struct OrderSums {
    double scattered = 0;           ///< x^2 Q_sca / 2
    double absorbed = 0;            ///< x^2 Q_abs / 2
    double asymmetric = 0;          ///< x^2 g Q_sca / 4
    std::complex<double> back = 0;  ///< sum (2n+1) (-1)^n (a_n - b_n)
};

constexpr double kEnoughDigits = 1e-12;  // accuracy that is said to be reached
constexpr double kLeastVectorSize = 2;   // below, mie_coefficients has more care

/// a_n, b_n and what they absorb (Coefficients), real and imaginary parts apart: entry n holds
/// order n. Zero at 0 and beyond `terms`, up to whole vectors.
struct PartialWaves {
    explicit PartialWaves(int terms);
    int vectors() const { return (terms + kLaneCount - 1) / kLaneCount; }

    int terms;
    KeptVector<double> a_re, a_im, b_re, b_im, absorbed;
};

PartialWaves::PartialWaves(int number_of_orders)
    : terms(number_of_orders),
      a_re(vectors() * kLaneCount + 1),
      a_im(a_re.size()),
      b_re(a_re.size()),
      b_im(a_re.size()),
      absorbed(a_re.size()) {}

// Orders in the lanes, in place of the spheres of sphere_block.cpp.
template <typename Number>
PartialWaves by_vectors(Number m, double x) {
    constexpr bool absorbing = !std::is_same_v<Number, double>;
    const int terms = number_of_terms(x);
    PartialWaves waves(terms);
    const auto padded = waves.a_re.size();
    RadialFunctions radial;
    const bool upward = upward_is_stable(m * x, terms);
    InsideOrders<Number> inside;
    if (upward && !absorbing) {
        KeptVector<double> psi(padded + 1);
        radial = radial_functions(x, terms, psi.data(), std::real(m) * x);
        inside = InsideOrders<Number>::of_upward(std::move(psi), terms);
    } else {
        radial = radial_functions(x, terms);
        inside = upward ? InsideOrders<Number>::upward(m * x, terms)
                        : InsideOrders<Number>::downward(m * x, terms);
    }
    radial.psi.resize(padded, 0.0);
    radial.eta.resize(padded, 1.0);
    const Boundary<Number> boundary(m);
    Lanes orders = Lanes::LinSpaced(kLaneCount, 1, kLaneCount);
    Response a, b;
    for (int n = 1; n <= terms; n += kLaneCount, orders += kLaneCount) {
        const auto P = inside.here(n), Q = inside.before(n);
        const Lanes n_over_x = orders / x;
        boundary.scatter(P, Q, ConstLanes(&radial.psi[n]), ConstLanes(&radial.psi[n - 1]),
                         ConstLanes(&radial.eta[n]), ConstLanes(&radial.eta[n - 1]), n_over_x, a,
                         b);
        Eigen::Map<Lanes>(&waves.a_re[n]) = a.value.re;
        Eigen::Map<Lanes>(&waves.a_im[n]) = a.value.im;
        Eigen::Map<Lanes>(&waves.b_re[n]) = b.value.re;
        Eigen::Map<Lanes>(&waves.b_im[n]) = b.value.im;
        if constexpr (absorbing) {
            Eigen::Map<Lanes>(&waves.absorbed[n]) =
                boundary.absorbed(P, Q, inside.absorption(n), n_over_x, a, b);
        }
    }
    for (auto n = static_cast<std::size_t>(terms) + 1; n < padded; ++n) {
        waves.a_re[n] = waves.a_im[n] = waves.b_re[n] = waves.b_im[n] = waves.absorbed[n] = 0;
    }
    return waves;
}

PartialWaves by_coefficients(const Coefficients& c) {
    PartialWaves waves(static_cast<int>(c.a.size()));
    for (std::size_t i = 0; i < c.a.size(); ++i) {
        waves.a_re[i + 1] = c.a[i].real();
        waves.a_im[i + 1] = c.a[i].imag();
        waves.b_re[i + 1] = c.b[i].real();
        waves.b_im[i + 1] = c.b[i].imag();
        waves.absorbed[i + 1] = c.absorbed[i];
    }
    return waves;
}

// Eight orders at once. The asymmetry is the sum over n of (n-1)(n+1)/n Re(a_n a*_{n-1} + b_n
// b*_{n-1}) + (2n+1)/(n (n+1)) Re(a_n b*_n) (Bohren & Huffman 1983, sect. 4.5).
OrderSums sum_orders(const PartialWaves& w) {
    using Values = Eigen::Map<const Lanes>;
    Lanes scattered = Lanes::Zero(), absorbed = scattered, asymmetric = scattered;
    Lanes back_re = scattered, back_im = scattered, alternating;
    alternating << -1, 1, -1, 1, -1, 1, -1, 1;  // (-1)^n
    Lanes orders = Lanes::LinSpaced(kLaneCount, 1, kLaneCount);
    for (int n = 1; n <= w.terms; n += kLaneCount, orders += kLaneCount) {
        const Values a_re(&w.a_re[n]), a_im(&w.a_im[n]), b_re(&w.b_re[n]), b_im(&w.b_im[n]);
        const Values before_a_re(&w.a_re[n - 1]), before_a_im(&w.a_im[n - 1]);
        const Values before_b_re(&w.b_re[n - 1]), before_b_im(&w.b_im[n - 1]);
        const Lanes degeneracy = 2 * orders + 1;
        scattered +=
            degeneracy * ((a_re.square() + a_im.square()) + (b_re.square() + b_im.square()));
        absorbed += degeneracy * Values(&w.absorbed[n]);
        const Lanes inverse = 1 / (orders * (orders + 1));
        const Lanes neighbours =
            a_re * before_a_re + a_im * before_a_im + b_re * before_b_re + b_im * before_b_im;
        asymmetric += inverse * (degeneracy * (a_re * b_re + a_im * b_im) +
                                 (orders - 1) * (orders + 1).square() * neighbours);
        back_re += alternating * degeneracy * (a_re - b_re);
        back_im += alternating * degeneracy * (a_im - b_im);
    }
    return {scattered.sum(), absorbed.sum(), asymmetric.sum(), {back_re.sum(), back_im.sum()}};
}

// By vectors where psi_n(mx) can be taken without loss, otherwise by mie_coefficients. Cost at
// x = 1000: docs/maths-mie.md.
OrderSums sums_of(Complex m, double x) {
    // A NaN goes to mie_coefficients, which refuses it.
    const bool by_vector = x >= kLeastVectorSize && x <= 1e7 &&
                           std::abs(m - 1.0) >= kWellOffTheHost && m.real() >= 0.01 &&
                           m.real() <= 100 && m.imag() >= 0 && m.imag() <= 1e4;
    if (!by_vector) return sum_orders(by_coefficients(mie_coefficients(m, x)));
    return sum_orders(m.imag() == 0 ? by_vectors(m.real(), x) : by_vectors(m, x));
}

// The accuracy that rounding leaves: the coefficients hang on m^2 - 1, formed from parts of size 1.
double estimated_accuracy(Complex m, double x) {
    const double rounding = std::numeric_limits<double>::epsilon();
    const bool cancels = x >= 0.5;  // below, the contrast is taken in closed form
    return 20 * rounding * (cancels ? std::max(1.0, 1 / std::abs(m - 1.0)) : 1.0);
}

// Divided one factor at a time: x^2 alone may underflow.
// @param absorbed_share  of what is absorbed (FaintAbsorption)
SphereOptics optics_of(const OrderSums& sums, double x, double accuracy, double absorbed_share) {
    SphereOptics optics;
    optics.q_sca = 2 * sums.scattered / x / x;
    optics.q_abs =
        std::max(0.0, 2 * sums.absorbed / x / x * absorbed_share);  // layers: 0 to rounding
    optics.q_ext = optics.q_sca + optics.q_abs;
    optics.q_back = std::norm(sums.back / x);
    optics.asymmetry = sums.scattered > 0 ? 2 * sums.asymmetric / sums.scattered : 0;
    optics.terms = number_of_terms(x);
    optics.accuracy = accuracy;
    optics.reached = accuracy <= kEnoughDigits && std::isfinite(optics.q_ext);
    return optics;
}

// A sphere like its host scatters nothing.
SphereOptics no_sphere(double x) {
    return optics_of({}, x, std::numeric_limits<double>::epsilon(), 1.0);
}

}  // namespace

SphereOptics scatter_by_sphere(Complex relative_index, double size_parameter) {
    const FaintAbsorption faint(relative_index);
    SphereOptics optics =
        optics_of(sums_of(faint.index, size_parameter), size_parameter,
                  estimated_accuracy(relative_index, size_parameter), faint.share);
    if (relative_index == 1.0) return no_sphere(size_parameter);
    if (!optics.reached) {
        optics.status = fmt::format("index within {:.1e} of the host's: about {} digits remain",
                                    std::abs(relative_index - 1.0),
                                    static_cast<int>(-std::log10(optics.accuracy)));
    }
    return optics;
}

SphereOptics scatter_by_sphere(std::span<const SphereLayer> layers) {
    const Coefficients coefficients = mie_coefficients(layers);
    // The layer that differs most from the host is seen, however alike the others are.
    double contrast = 0;
    for (const SphereLayer& layer : layers)
        contrast = std::max(contrast, std::abs(layer.relative_index - 1.0));
    const double x = layers.back().size_parameter;
    if (contrast == 0) return no_sphere(x);
    SphereOptics optics = optics_of(sum_orders(by_coefficients(coefficients)), x,
                                    estimated_accuracy(1.0 + contrast, x), 1.0);
    if (!optics.reached) {
        optics.status = fmt::format("indices within {:.1e} of the host's: about {} digits remain",
                                    contrast, static_cast<int>(-std::log10(optics.accuracy)));
    }
    return optics;
}

double cosine_of_scattering_angle(double angle_deg) {
    if (!(angle_deg >= 0 && angle_deg <= 180)) {
        throw UsageError("angle_deg", angle_deg, "0 to 180");
    }
    if (angle_deg == 60) return 0.5;
    if (angle_deg == 120) return -0.5;
    return boost::math::cos_pi(angle_deg / 180);
}

Amplitudes scattering_amplitudes(const Coefficients& coefficients,
                                 std::span<const double> angles_deg) {
    const int terms = static_cast<int>(coefficients.a.size());
    Amplitudes amplitudes;
    for (const double angle_deg : angles_deg) {
        const double mu = cosine_of_scattering_angle(angle_deg);
        std::complex<double> s1 = 0, s2 = 0;
        double pi_before = 0, pi = 1;  // pi_0, pi_1
        for (int n = 1; n <= terms; ++n) {
            // Wiscombe 1980: s = mu pi_n, t = s - pi_{n-1};
            // tau_n = n t - pi_{n-1}, pi_{n+1} = s + (n + 1)/n t.
            const double s = mu * pi;
            const double t = s - pi_before;
            const double tau = n * t - pi_before;
            const double weight = (2.0 * n + 1.0) / (n * (n + 1.0));
            const std::complex<double> a = weight * coefficients.a[n - 1];
            const std::complex<double> b = weight * coefficients.b[n - 1];
            s1 += a * pi + b * tau;
            s2 += a * tau + b * pi;
            pi_before = pi;
            pi = s + (n + 1.0) / n * t;
        }
        amplitudes.s1.push_back(s1);
        amplitudes.s2.push_back(s2);
    }
    return amplitudes;
}

Amplitudes scattering_amplitudes(std::complex<double> relative_index, double size_parameter,
                                 std::span<const double> angles_deg) {
    return scattering_amplitudes(mie_coefficients(relative_index, size_parameter), angles_deg);
}

Amplitudes scattering_amplitudes(std::span<const SphereLayer> layers,
                                 std::span<const double> angles_deg) {
    return scattering_amplitudes(mie_coefficients(layers), angles_deg);
}

}  // namespace miebrdf::mie
