#include "materials/index/oscillators.h"

#include <algorithm>
#include <boost/math/special_functions/expint.hpp>
#include <cmath>
#include <numbers>

namespace miebrdf::materials {
namespace {

using Complex = std::complex<double>;
using Parameters = std::span<const double>;

constexpr double kPi = std::numbers::pi;

Complex drude(Parameters p, double E) {
    const double EP = p[0], G = p[1];
    return -EP * EP / (E * Complex(E, G));
}

Complex lorentz(Parameters p, double E) {
    const double S = p[0], E0 = p[1], G = p[2];
    return S * E0 * E0 / Complex((E0 - E) * (E0 + E), -G * E);
}

// The four zeros of (x^2 - E0^2)^2 + C^2 x^2.
void add_lorentz_poles(double E0, double C, std::vector<Complex>& poles) {
    const Complex root = C * std::sqrt(Complex((0.5 * C - E0) * (0.5 * C + E0)));
    for (const Complex square : {E0 * E0 - 0.5 * C * C + root, E0 * E0 - 0.5 * C * C - root}) {
        poles.push_back(std::sqrt(square));
        poles.push_back(-std::sqrt(square));
    }
}

// Principal value of the integral from `first` to infinity of numerator(x) / prod (x - p_j), which
// falls at least like x^-2: with the residues r_j it is -sum r_j log(first - p_j), because they add
// up to 0. Poles on the real axis take the logarithm of the modulus.
template <typename Numerator>
double integral_from(double first, const std::vector<Complex>& poles, const Numerator& numerator) {
    double sum = 0.0;
    for (std::size_t j = 0; j < poles.size(); ++j) {
        Complex residue = numerator(poles[j]);
        if (residue == 0.0) continue;
        for (std::size_t k = 0; k < poles.size(); ++k) {
            if (k != j) residue /= poles[j] - poles[k];
        }
        const Complex distance = first - poles[j];
        const Complex log =
            poles[j].imag() == 0.0 ? std::log(std::abs(distance)) : std::log(distance);
        sum -= (residue * log).real();
    }
    return sum;
}

// Where C = 2 E0 the zeros of the Lorentz shape are double, and near it residues cancel: the mean
// of two widths beside it, which is as good as the square of their distance.
template <typename Value>
double beside_double_poles(double E0, double C, const Value& value) {
    constexpr double kNear = 1e-5;
    if (std::abs(C / (2.0 * E0) - 1.0) > kNear) return value(C);
    return 0.5 * (value(C * (1.0 - 2.0 * kNear)) + value(C * (1.0 + 2.0 * kNear)));
}

double lorentz_shape(double A, double E0, double C, double E) {
    const double d = (E - E0) * (E + E0);
    return A * E0 * C * E / (d * d + C * C * E * E);
}

Complex tauc_lorentz(Parameters p, double E) {
    const double A = p[0], E0 = p[1], C = p[2], EG = p[3];
    const double above = std::max(0.0, E - EG);
    const double imaginary = lorentz_shape(A, E0, C, E) * above * above / (E * E);
    // 2/pi P int x eps_2(x) / (x^2 - E^2) dx
    const double real = beside_double_poles(E0, C, [&](double width) {
        std::vector<Complex> poles = {E, -E};
        add_lorentz_poles(E0, width, poles);
        return 2.0 / kPi * A * E0 * width *
               integral_from(EG, poles, [&](Complex x) { return (x - EG) * (x - EG); });
    });
    return {real, imaginary};
}

// exp(-x) Ei(x).
double scaled_exponential_integral(double x) {
    constexpr double kAsymptotic = 50.0;  // terms of the series fall to 1e-21 there
    if (std::abs(x) < kAsymptotic) return std::exp(-x) * boost::math::expint(x);
    double term = 1.0 / x, sum = 0.0;
    for (int k = 1; k < 40 && std::abs(term) > 1e-17 * std::abs(sum); ++k) {
        sum += term;
        term *= k / x;
    }
    return sum;
}

// 2/pi P int_0^ET x (E_1 / x) exp((x - ET) / EU) / (x^2 - E^2) dx, by partial fractions in
// exponential integrals.
double urbach_integral(double E1, double ET, double EU, double E) {
    const double at_zero = std::exp(-ET / EU);
    return E1 / (kPi * E) *
           (scaled_exponential_integral((ET - E) / EU) -
            scaled_exponential_integral((ET + E) / EU) +
            at_zero * (scaled_exponential_integral(E / EU) - scaled_exponential_integral(-E / EU)));
}

Complex cody_lorentz(Parameters p, double E) {
    const double A = p[0], E0 = p[1], C = p[2], EG = p[3], EP = p[4];
    const bool has_tail = p.size() > 5;
    const double ET = has_tail ? p[5] : EG, EU = has_tail ? p[6] : 0.0;
    const auto band = [&](double x) {
        const double above = std::max(0.0, x - EG);
        return lorentz_shape(A, E0, C, x) * above * above / (above * above + EP * EP);
    };
    const double E1 = has_tail ? ET * band(ET) : 0.0;
    const double imaginary = E > ET ? band(E) : has_tail ? E1 / E * std::exp((E - ET) / EU) : 0.0;
    // Both parts of the integral have a logarithm at ET, which cancel.
    constexpr double kRounding = 1e-9;
    if (std::abs(E - ET) < kRounding * ET) E = ET * (1.0 + kRounding);
    double real = beside_double_poles(E0, C, [&](double width) {
        std::vector<Complex> poles = {E, -E, {EG, EP}, {EG, -EP}};
        add_lorentz_poles(E0, width, poles);
        return 2.0 / kPi * A * E0 * width *
               integral_from(ET, poles, [&](Complex x) { return x * x * (x - EG) * (x - EG); });
    });
    if (has_tail) real += urbach_integral(E1, ET, EU, E);
    return {real, imaginary};
}

std::pair<double, double> at_zero_energy(Parameters p) { return {p[0], p[1]}; }
std::pair<double, double> at_resonance(Parameters p) { return {p[1], p[2]}; }

const OscillatorParameter kAmplitude = {"A", "amplitude, eV", true};
const OscillatorParameter kResonance = {"E0", "resonance, eV", false};
const OscillatorParameter kWidth = {"C", "width, eV", false};
const OscillatorParameter kGap = {"EG", "gap, eV", true};

const OscillatorKind kKinds[] = {
    {"drude",
     "Drude",
     "P. Drude, Ann. Phys. 306, 566 (1900)",
     {{"EP", "plasma energy, eV", true}, {"G", "damping, eV", true}},
     2,
     drude,
     at_zero_energy},
    {"lorentz",
     "Lorentz",
     "H. A. Lorentz, The Theory of Electrons (1909)",
     {{"S", "strength, what it adds to the static permittivity", true},
      kResonance,
      {"G", "damping, eV", false}},
     3,
     lorentz,
     at_resonance},
    {"tauc-lorentz",
     "Tauc-Lorentz",
     "G. E. Jellison, F. A. Modine, Appl. Phys. Lett. 69, 371 and 2137 (1996)",
     {kAmplitude, kResonance, kWidth, kGap},
     4,
     tauc_lorentz,
     at_resonance},
    {"cody-lorentz",
     "Cody-Lorentz",
     "A. S. Ferlauto et al., J. Appl. Phys. 92, 2424 (2002)",
     {kAmplitude,
      kResonance,
      kWidth,
      kGap,
      {"EP", "width of the transition to Lorentz, eV", false},
      {"ET", "end of the Urbach tail, eV", false},
      {"EU", "slope of the Urbach tail, eV", false}},
     5,
     cody_lorentz,
     at_resonance},
};

}  // namespace

std::span<const OscillatorKind> oscillator_kinds() { return kKinds; }

const OscillatorKind* find_oscillator_kind(std::string_view name) {
    for (const OscillatorKind& kind : kKinds) {
        if (name == kind.name) return &kind;
    }
    return nullptr;
}

std::string form_of(const OscillatorKind& kind) {
    std::string text = kind.name;
    for (std::size_t i = 0; i < kind.parameters.size(); ++i) {
        if (i == kind.fewest_parameters) text += '[';
        text += i == 0 ? '(' : ',';
        text += kind.parameters[i].name;
    }
    return text + (kind.parameters.size() > kind.fewest_parameters ? "])" : ")");
}

}  // namespace miebrdf::materials
