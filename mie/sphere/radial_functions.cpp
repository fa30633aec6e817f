#include "mie/sphere/radial_functions.h"

#include <algorithm>
#include <cmath>
#include <iterator>

#include "mie/sphere/lane_math.h"

namespace miebrdf::mie {
namespace {

// (2n - 1)/z, n = 0 ... highest_order: divided, not times 1/z, which would be another z, by a
// rounding, for all orders; and all at once, because divisions one by one cost more than the rest.
KeptVector<double> recurrence_factors(double z, int highest_order) {
    KeptVector<double> factors(highest_order + kLaneCount);
    Lanes odd = Lanes::LinSpaced(kLaneCount, -1, 2 * kLaneCount - 3);
    for (int n = 0; n <= highest_order; n += kLaneCount, odd += 2 * kLaneCount) {
        Eigen::Map<Lanes> eight(factors.data() + n);
        eight = odd / z;
    }
    return factors;
}

// f_n = (2n - 1)/z f_{n-1} - f_{n-2}, two orders at a time: neither value is ever copied, which
// would cost as much as the multiply-add.
struct UpwardRecurrence {
    void next_two(const double* factors, double* values) {
        before = factors[0] * here - before;
        values[0] = before;
        here = factors[1] * before - here;
        values[1] = here;
    }
    double before, here;
};

// psi_n, n = turn + 1 ... highest_order, from psi_turn: downward, where it grows.
void continue_beyond_turn(KeptVector<double>& psi, int turn, double x) {
    const int highest_order = static_cast<int>(psi.size()) - 1;
    const int start = highest_order + static_cast<int>(2 * std::cbrt(x)) + 15;
    if (x <
        2) {  // (2n/x)^n might overflow: by ratios, with E_n(x) (regular_logarithmic_derivatives)
        double E = 0;
        for (int n = start; n > turn; --n) {
            E = -x * x / (2 * n + 3 + E);
            if (n <= highest_order) psi[n] = x / (2 * n + 1 + E);
        }
        for (int n = turn + 1; n <= highest_order; ++n) psi[n] *= psi[n - 1];
        return;
    }
    const double inverse = 1 / x;
    double above = 0, here = 1e-200;
    for (int n = start; n > turn; --n) {
        if (n <= highest_order) psi[n] = here;
        const double below = (2 * n + 1) * inverse * here - above;
        above = here;
        here = below;
    }
    const double scale = psi[turn] / here;  // no zero there: the first is 1.8 n^(1/3) above n
    for (int n = turn + 1; n <= highest_order; ++n) psi[n] *= scale;
}

using Complex = std::complex<double>;

// The compiler's complex division guards against overflow that cannot occur here, at three times
// the cost.
double reciprocal(double z) { return 1 / z; }
Complex reciprocal(Complex z) {
    const double inverse_norm = 1 / std::norm(z);
    return {z.real() * inverse_norm, -z.imag() * inverse_norm};
}

Complex product(Complex a, Complex b) {
    return {a.real() * b.real() - a.imag() * b.imag(), a.real() * b.imag() + a.imag() * b.real()};
}

// The root of z with Re z > 0, neither large nor small.
Complex root_on_the_right(Complex z) {
    const double real = std::sqrt(0.5 * (std::sqrt(std::norm(z)) + z.real()));
    return {real, z.imag() / (2 * real)};
}

template <typename Number>
std::vector<Number> downward(Number z, int highest_order, int start, Number start_value) {
    std::vector<Number> D(highest_order + 1);
    const Number inverse_z = 1.0 / z;
    Number current = start_value;
    if (start <= highest_order) D[start] = current;
    for (int n = start; n >= 1; --n) {
        const Number n_over_z = static_cast<double>(n) * inverse_z;
        current = n_over_z - reciprocal(current + n_over_z);
        if (n - 1 <= highest_order) D[n - 1] = current;
    }
    return D;
}

// Neutral only while psi_n oscillates (n < |z|) and is not damped.
template <typename Number>
std::vector<Number> upward(Number z, int highest_order) {
    std::vector<Number> D(highest_order + 1);
    D[0] = std::cos(z) / std::sin(z);
    for (int n = 1; n <= highest_order; ++n) {
        const Number n_over_z = static_cast<double>(n) / z;
        D[n] = reciprocal(n_over_z - D[n - 1]) - n_over_z;
    }
    return D;
}

// exp(3): one digit of sixteen.
constexpr double kAllowedGrowth = 3;
constexpr double kMostDamping = 100;  // exp(4 Im z), in squares of products, stays in range

// Orders so far below |z| that neither a turning point nor its neighbourhood matters.
double far_above(int order) { return 1.3 * order + 20; }

}  // namespace

int number_of_terms(double size_parameter) {
    // Below x = 0.001 each term is 10^-6 of the one before; fewer keep eta_n ~ x^-n from overflow.
    if (size_parameter < 1e-3) return 6;
    return static_cast<int>(size_parameter + 8 * std::cbrt(size_parameter) + 12);
}

RadialFunctions radial_functions(double size_parameter, int highest_order, double* inside,
                                 double inside_parameter) {
    const double x = size_parameter;
    RadialFunctions radial;
    KeptVector<double>& psi = radial.psi;
    KeptVector<double>& eta = radial.eta;
    for (auto* values : {&psi, &eta}) {
        values->reserve(highest_order + 2 + kLaneCount);  // callers fill up whole vectors
        values->resize(highest_order + 2);
    }

    const int turn = std::min(highest_order, static_cast<int>(x)) / 2 * 2;  // psi_n oscillates
    const KeptVector<double> factors = recurrence_factors(x, highest_order + 1);
    UpwardRecurrence eta_wave{std::sin(x), -std::cos(x)}, psi_wave{std::cos(x), std::sin(x)};
    eta[0] = eta_wave.here;
    psi[0] = psi_wave.here;
    if (inside) {
        const double z = inside_parameter;
        const KeptVector<double> inside_factors = recurrence_factors(z, highest_order + 1);
        UpwardRecurrence inside_wave{std::cos(z), std::sin(z)};
        inside[0] = inside_wave.here;
        for (int n = 1; n < turn; n += 2) {
            eta_wave.next_two(&factors[n], &eta[n]);
            psi_wave.next_two(&factors[n], &psi[n]);
            inside_wave.next_two(&inside_factors[n], inside + n);
        }
        for (int n = turn + 1; n <= highest_order; n += 2) {
            eta_wave.next_two(&factors[n], &eta[n]);
            inside_wave.next_two(&inside_factors[n], inside + n);
        }
    } else {
        for (int n = 1; n < turn; n += 2) {
            eta_wave.next_two(&factors[n], &eta[n]);
            psi_wave.next_two(&factors[n], &psi[n]);
        }
        for (int n = turn + 1; n <= highest_order; n += 2) {
            eta_wave.next_two(&factors[n], &eta[n]);
        }
    }
    psi.resize(highest_order + 1);
    eta.resize(highest_order + 1);
    continue_beyond_turn(psi, turn, x);
    return radial;
}

// The start is off by O(1); each step above |z| shrinks that by |psi_{n+1} / psi_n|^2, and
// 8 |z|^(1/3) + 15 steps shrink it below rounding for every |z| (the turning point is |z|^(1/3)
// wide). Starting at |z| + 15, as is often seen, leaves two digits at m = 2.6, x = 1500.
int safe_start(double modulus, int highest_order) {
    return static_cast<int>(std::max<double>(highest_order, modulus) + 8 * std::cbrt(modulus) + 15);
}

// WKB solution of the Riccati equation D' = p - 1 - D^2, p = n (n + 1) / z^2, that belongs to the
// wave exp(-i z): D = S_0 + S_1 + ..., S_0 = -i sqrt(1 - p), S_{j+1} = -(S_j' + sum S_i S_{j+1-i})
// / (2 S_0) with i = 1 ... j. With w = 1 - p and e = -i / (z w^(3/2)) the terms are S_0 times a
// polynomial in p times e^j. Empty where the next term would show.
std::optional<Complex> damped_logarithmic_derivative(Complex z, int order) {
    constexpr double deep = 18;  // exp(-2 * 18) = 2e-16
    if (!(z.imag() > deep && std::abs(z) > far_above(order))) return std::nullopt;
    const Complex inverse_z = reciprocal(z);
    const Complex p = (static_cast<double>(order) * (order + 1.0)) * product(inverse_z, inverse_z);
    const Complex w = 1.0 - p, root = root_on_the_right(w);
    // The wave from the far side has to be below rounding. It turns before the centre, and passes
    // less than Im z: the derivative of its phase is the root.
    if (!(root.real() * z.imag() > deep)) return std::nullopt;
    const Complex step = product(inverse_z, reciprocal(product(w, root)));
    const Complex e(step.imag(), -step.real());
    constexpr double k1[] = {0.5}, k2[] = {-3.0 / 4, 1.0 / 8}, k3[] = {3.0 / 2, 3.0 / 8},
                     k4[] = {-15.0 / 4, -147.0 / 32, -9.0 / 32, -1.0 / 128},
                     k5[] = {45.0 / 4, 123.0 / 4, 171.0 / 16, 9.0 / 32};
    // sum of k_i p^(i + 1)
    const auto polynomial = [&](const auto& k) {
        Complex sum = 0;
        for (auto i = std::size(k); i-- > 0;) sum = product(sum + k[i], p);
        return sum;
    };
    const Complex last = polynomial(k5);
    const Complex e_squared = product(e, e), e_cubed = product(e_squared, e);
    // Each term gains 3 to 4 times e, more where p is not small.
    constexpr double gain = 10;
    const double next = gain * gain * std::norm(last) * std::norm(product(e_cubed, e_cubed));
    if (!(next <= 1e-32)) return std::nullopt;
    Complex sum = last;
    for (const Complex& term : {polynomial(k4), polynomial(k3), polynomial(k2), polynomial(k1)})
        sum = product(sum, e) + term;
    sum = product(root, 1.0 + product(sum, e));
    return Complex(sum.imag(), -sum.real());
}

bool upward_is_stable(Complex z, int highest_order) {
    const double ratio = highest_order / z.real();
    if (!(ratio < 0.97 && z.imag() < kMostDamping)) return false;
    return 2 * z.imag() * (1 - std::sqrt(1 - ratio * ratio)) < kAllowedGrowth;
}

std::vector<Complex> logarithmic_derivatives(Complex z, int highest_order) {
    if (const auto start_value = damped_logarithmic_derivative(z, highest_order)) {
        return downward(z, highest_order, highest_order, *start_value);
    }
    if (z.real() > far_above(highest_order) && upward_is_stable(z, highest_order)) {
        return upward(z, highest_order);
    }
    return downward(z, highest_order, safe_start(std::abs(z), highest_order), Complex(0));
}

std::vector<double> logarithmic_derivatives(double z, int highest_order) {
    if (z > far_above(highest_order)) return upward(z, highest_order);
    return downward(z, highest_order, safe_start(z, highest_order), 0.0);
}

template <typename Number>
std::vector<Number> regular_logarithmic_derivatives(Number z, int highest_order) {
    std::vector<Number> E(highest_order + 1);
    const Number z_squared = z * z;
    Number current = 0.0;
    for (int n = safe_start(std::abs(z), highest_order); n >= 0; --n) {
        current = -z_squared / (2.0 * n + 3.0 + current);
        if (n <= highest_order) E[n] = current;
    }
    return E;
}

template std::vector<double> regular_logarithmic_derivatives(double, int);
template std::vector<Complex> regular_logarithmic_derivatives(Complex, int);

}  // namespace miebrdf::mie
