#include "mie/sphere/partial_waves.h"

#include <cmath>
#include <type_traits>

#include "mie/sphere/coefficients.h"
#include "mie/sphere/inside_orders.h"
#include "mie/sphere/lane_response.h"
#include "mie/sphere/logarithmic_derivative.h"
#include "mie/sphere/radial_functions.h"
#include "mie/sphere/terms.h"

namespace miebrdf::mie {
namespace {

using Complex = std::complex<double>;
using ConstLanes = Eigen::Map<const Lanes>;

constexpr double least_vector_size = 2;     // below, mie_coefficients has more care
constexpr double well_off_the_host = 1e-2;  // nearer, too

// Orders in the lanes in place of the spheres of sphere_lanes.cpp.
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
        std::vector<double> psi(padded + 1);
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
    Lanes orders = Lanes::LinSpaced(lane_count, 1, lane_count);
    Response a, b;
    for (int n = 1; n <= terms; n += lane_count, orders += lane_count) {
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

PartialWaves by_coefficients(Complex m, double x) {
    const Coefficients c = mie_coefficients(m, x);
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

}  // namespace

PartialWaves::PartialWaves(int number_of_orders)
    : terms(number_of_orders),
      a_re(vectors() * lane_count + 1),
      a_im(a_re.size()),
      b_re(a_re.size()),
      b_im(a_re.size()),
      absorbed(a_re.size()) {}

PartialWaves partial_waves(Complex relative_index, double size_parameter) {
    const Complex m = relative_index;  // a NaN goes to mie_coefficients, which refuses it
    const bool by_vector = size_parameter >= least_vector_size && size_parameter <= 1e7 &&
                           std::abs(m - 1.0) >= well_off_the_host && m.real() >= 0.01 &&
                           m.real() <= 100 && m.imag() >= 0 && m.imag() <= 1e4;
    if (!by_vector) return by_coefficients(relative_index, size_parameter);
    if (relative_index.imag() == 0) return by_vectors(relative_index.real(), size_parameter);
    return by_vectors(relative_index, size_parameter);
}

}  // namespace miebrdf::mie
