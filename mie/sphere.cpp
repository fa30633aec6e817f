#include "mie/sphere.h"

#include <fmt/format.h>

#include <cmath>
#include <limits>

#include "mie/coefficients.h"

namespace miebrdf::mie {
namespace {

using Complex = std::complex<double>;

// sum over n of n (n+2)/(n+1) Re(a_n a*_{n+1} + b_n b*_{n+1}) + (2n+1)/(n (n+1)) Re(a_n b*_n)
// = x^2 g Q_sca / 4 (Bohren & Huffman 1983, sect. 4.5).
double asymmetry_sum(const Coefficients& c) {
    double sum = 0;
    for (std::size_t i = c.a.size(); i-- > 0;) {
        const double n = static_cast<double>(i + 1);
        double term = (2 * n + 1) / (n * (n + 1)) * std::real(c.a[i] * std::conj(c.b[i]));
        if (i + 1 < c.a.size()) {
            term += n * (n + 2) / (n + 1) *
                    std::real(c.a[i] * std::conj(c.a[i + 1]) + c.b[i] * std::conj(c.b[i + 1]));
        }
        sum += term;
    }
    return sum;
}

// What rounding leaves: the coefficients hang on m^2 - 1, formed from parts of size 1.
double estimated_accuracy(Complex m, double x) {
    const double rounding = std::numeric_limits<double>::epsilon();
    const bool cancels = x >= 0.5;  // below, the contrast is taken in closed form
    return 20 * rounding * (cancels ? std::max(1.0, 1 / std::abs(m - 1.0)) : 1.0);
}

}  // namespace

SphereOptics scatter_by_sphere(Complex relative_index, double size_parameter) {
    const Coefficients c = mie_coefficients(relative_index, size_parameter);
    double scattered = 0, absorbed = 0;
    Complex back = 0;
    for (std::size_t i = c.a.size(); i-- > 0;) {  // small terms first
        const double weight = 2.0 * static_cast<double>(i) + 3.0;
        scattered += weight * (std::norm(c.a[i]) + std::norm(c.b[i]));
        absorbed += weight * c.absorbed[i];
        back += (i % 2 == 0 ? -weight : weight) * (c.a[i] - c.b[i]);
    }
    // Divided one factor at a time: x^2 alone may underflow.
    const double x = size_parameter;
    SphereOptics optics;
    optics.q_sca = 2 * scattered / x / x;
    optics.q_abs = 2 * absorbed / x / x;
    optics.q_ext = optics.q_sca + optics.q_abs;
    optics.q_back = std::norm(back / x);
    optics.asymmetry = scattered > 0 ? 2 * asymmetry_sum(c) / scattered : 0;
    optics.terms = static_cast<int>(c.a.size());
    optics.accuracy = estimated_accuracy(relative_index, x);
    optics.reached = optics.accuracy <= 1e-12 && std::isfinite(optics.q_ext);
    if (!optics.reached) {
        optics.status = fmt::format("index within {:.1e} of the host's: about {} digits remain",
                                    std::abs(relative_index - 1.0),
                                    static_cast<int>(-std::log10(optics.accuracy)));
    }
    return optics;
}

}  // namespace miebrdf::mie
