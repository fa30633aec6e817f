#include "rte/phase/matrix_strengths.h"

#include <cmath>
#include <vector>

#include "rte/phase/scaled_medium.h"

namespace miebrdf::rte {
namespace {

double element(const std::vector<double>& list, Eigen::Index degree) {
    return std::size_t(degree) < list.size() ? list[std::size_t(degree)] : 0.0;
}

// [[a, b], [b, d]] = first v v^T + second w w^T, first >= second; v = (1, 0) where b = 0 and a >=
// d.
struct Axes {
    double first, second, cosine = 1.0, sine = 0.0;
    Axes(double a, double b, double d) {
        const double half_difference = 0.5 * (a - d);
        const double radius = std::hypot(half_difference, b);
        first = 0.5 * (a + d) + radius;
        second = 0.5 * (a + d) - radius;
        if (b == 0.0 && half_difference >= 0.0) {
            first = a, second = d;
            return;
        }
        const double angle = 0.5 * std::atan2(b, half_difference);
        cosine = std::cos(angle);
        sine = std::sin(angle);
    }
};

}  // namespace

MatrixStrengths matrix_strengths(const ScaledMedium& medium) {
    const ScaledOptics& scaled = medium.scaled;
    const Eigen::Index degrees = scaled.chi.size();
    MatrixStrengths result;
    for (Eigen::VectorXd* list : {&result.a3, &result.a4, &result.b2, &result.first, &result.second,
                                  &result.cosine, &result.sine, &result.upper, &result.lower,
                                  &result.circular_cosine, &result.circular_sine}) {
        list->setZero(degrees);
    }
    result.first = scaled.strengths();
    result.cosine.setOnes();
    result.circular_cosine.setOnes();
    if (!medium.exact.polarisation) return result;
    const Polarisation& exact = *medium.exact.polarisation;
    const double kept_in_all = 1.0 - scaled.truncated;
    const double scale = scaled.albedo / kept_in_all;
    for (Eigen::Index l = 0; l < degrees; ++l) {
        const double two_l_1 = 2.0 * double(l) + 1.0;
        const double kept = scaled.truncated > 0.0 ? 1.0 - scaled.share_scaled_away(int(l)) : 1.0;
        double peak = 0.0;
        if (scaled.truncated > 0.0)
            peak =
                two_l_1 * (kept * medium.exact.chi[std::size_t(l)] - kept_in_all * scaled.chi[l]);
        result.a4[l] = scale * (kept * element(exact.a4, l) - peak);
        result.lower[l] = -result.a4[l];
        if (l < 2) continue;
        result.a3[l] = scale * (kept * element(exact.a3, l) - peak);
        result.b2[l] = scale * kept * element(exact.b2, l);
        const Axes linear(result.first[l], scale * kept * element(exact.b1, l),
                          scale * (kept * element(exact.a2, l) - peak));
        const Axes circular(result.a3[l], -result.b2[l], -result.a4[l]);
        result.first[l] = linear.first;
        result.second[l] = linear.second;
        result.cosine[l] = linear.cosine;
        result.sine[l] = linear.sine;
        result.upper[l] = circular.first;
        result.lower[l] = circular.second;
        result.circular_cosine[l] = circular.cosine;
        result.circular_sine[l] = circular.sine;
    }
    return result;
}

}  // namespace miebrdf::rte
