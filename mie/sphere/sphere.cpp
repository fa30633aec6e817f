#include "mie/sphere/sphere.h"

#include <fmt/format.h>

#include <cmath>
#include <limits>

#include "mie/sphere/partial_waves.h"

namespace miebrdf::mie {
namespace {

using Complex = std::complex<double>;

struct OrderSums {
    double scattered = 0, absorbed = 0;
    double asymmetric = 0;  // x^2 g Q_sca / 4
    Complex back = 0;
};

// Eight orders at once. The asymmetry is the sum over n of (n-1)(n+1)/n Re(a_n a*_{n-1} + b_n
// b*_{n-1}) + (2n+1)/(n (n+1)) Re(a_n b*_n) (Bohren & Huffman 1983, sect. 4.5).
OrderSums sum_orders(const PartialWaves& w) {
    using Values = Eigen::Map<const Lanes>;
    Lanes scattered = Lanes::Zero(), absorbed = scattered, asymmetric = scattered;
    Lanes back_re = scattered, back_im = scattered, alternating;
    alternating << -1, 1, -1, 1, -1, 1, -1, 1;  // (-1)^n
    Lanes orders = Lanes::LinSpaced(lane_count, 1, lane_count);
    for (int n = 1; n <= w.terms; n += lane_count, orders += lane_count) {
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

// What rounding leaves: the coefficients hang on m^2 - 1, formed from parts of size 1.
double estimated_accuracy(Complex m, double x) {
    const double rounding = std::numeric_limits<double>::epsilon();
    const bool cancels = x >= 0.5;  // below, the contrast is taken in closed form
    return 20 * rounding * (cancels ? std::max(1.0, 1 / std::abs(m - 1.0)) : 1.0);
}

}  // namespace

SphereOptics scatter_by_sphere(Complex relative_index, double size_parameter) {
    const PartialWaves waves = partial_waves(relative_index, size_parameter);
    const OrderSums sums = sum_orders(waves);
    // Divided one factor at a time: x^2 alone may underflow.
    const double x = size_parameter;
    SphereOptics optics;
    optics.q_sca = 2 * sums.scattered / x / x;
    optics.q_abs = 2 * sums.absorbed / x / x;
    optics.q_ext = optics.q_sca + optics.q_abs;
    optics.q_back = std::norm(sums.back / x);
    optics.asymmetry = sums.scattered > 0 ? 2 * sums.asymmetric / sums.scattered : 0;
    optics.terms = waves.terms;
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
