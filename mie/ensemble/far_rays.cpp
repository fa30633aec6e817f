#include "mie/ensemble/far_rays.h"

#include <algorithm>
#include <cmath>
#include <vector>

#include "mie/ensemble/size_sums.h"
#include "mie/sphere/radial_functions.h"
#include "mie/sphere/ray_waves.h"

namespace miebrdf::mie {
namespace {

using Complex = std::complex<double>;
using Row = Eigen::Array<float, kLaneCount, 1>;

// Orders below and above that scatter less than this share of the light together are left out: 1e-5
// of P straight back, where all add up in step.
constexpr double kFaint = 1e-7;
// Where less than this comes back from the surface, 4e-9 or less is left after sixteen ways.
constexpr double kSteep = 0.3;

Complex power(Complex z, int exponent) {
    Complex result = 1;
    for (; exponent > 0; exponent /= 2) {
        if (exponent % 2 == 1) result *= z;
        z *= z;
    }
    return result;
}

// B_n and R_n of one polarisation at all orders of one size.
struct FarWave {
    Eigen::ArrayXf re, im, inner_re, inner_im;
    Eigen::ArrayXd energy;  // of the order, incoherent

    // Zero from the first entry on; whole rows of eight may be read.
    void make_room(int count) {
        for (Eigen::ArrayXf* part : {&re, &im, &inner_re, &inner_im}) part->setZero(count);
        energy.setZero(count);
    }
    void put(int n, Complex through, Complex inner, int ways_before) {
        if (std::norm(inner) < kSteep) return;
        const Complex first = through * power(inner, ways_before);
        re[n] = static_cast<float>(first.real());
        im[n] = static_cast<float>(first.imag());
        inner_re[n] = static_cast<float>(inner.real());
        inner_im[n] = static_cast<float>(inner.imag());
        const double left = 1 - std::norm(inner);
        energy[n] = std::norm(first) > 0 ? std::norm(first) / std::max(left, 1e-28) : 0.0;
    }
};

// Re of B_n C_m* / (1 - R_n Q_m*) at one n of one wave and eight m of another.
Row product_of(const FarWave& wave, int n, const FarWave& other, int m) {
    const auto at = [m](const Eigen::ArrayXf& part) -> Row { return part.segment<kLaneCount>(m); };
    const Row re = at(other.re), im = at(other.im);
    const Row inner_re = at(other.inner_re), inner_im = at(other.inner_im);
    const Row above_re = wave.re[n] * re + wave.im[n] * im;
    const Row above_im = wave.im[n] * re - wave.re[n] * im;
    const Row below_re = 1 - (wave.inner_re[n] * inner_re + wave.inner_im[n] * inner_im);
    const Row below_im = wave.inner_re[n] * inner_im - wave.inner_im[n] * inner_re;
    // Where hardly anything goes through, rounding may leave nothing below.
    const Row square = (below_re * below_re + below_im * below_im).max(1e-14F);
    return (above_re * below_re + above_im * below_im) / square;
}

struct OneSize {
    FarWave a, b;

    void add_to(double weight, double light, int terms, const AngularFunctionsOf<float>& angular,
                RayIntensity& sum) const {
        int first = 1, last = terms;
        const auto share = [&](int n) { return (2 * n + 1) * (a.energy[n] + b.energy[n]); };
        for (double faint = 0; first <= last && (faint += share(first)) < kFaint * light;) ++first;
        for (double faint = 0; last > first && (faint += share(last)) < kFaint * light;) --last;
        if (first > last) return;
        const int count = last - first + 1;
        // |U|^2 and |V|^2 of a pair of orders: aa + bb +- (ab + ba).
        thread_local TriangularForm<float> plus, minus;
        plus.make_room(count);
        minus.make_room(count);
        for (int n = 0; n < count; ++n) {
            float *of_plus = plus.row(n), *of_minus = minus.row(n);
            for (int m = 0; m <= n; m += kLaneCount) {
                const Row same =
                    product_of(a, first + n, a, first + m) + product_of(b, first + n, b, first + m);
                const Row crossed =
                    product_of(a, first + n, b, first + m) + product_of(b, first + n, a, first + m);
                Eigen::Map<Row>(of_plus + m) = 2 * (same + crossed);
                Eigen::Map<Row>(of_minus + m) = 2 * (same - crossed);
            }
            for (float* row : {of_plus, of_minus}) {
                row[n] *= 0.5F;
                std::fill(row + n + 1, row + TriangularForm<float>::piece_end(n), 0.0F);
            }
            sum.scattered += 0.5 * weight * share(first + n);
        }
        angular.add_forms(0.25 * weight, plus, minus, first, sum.at_angles);
    }
};

template <typename Number>
void add_eight(Number m, const Lanes& x, const Lanes& weight, int first_way,
               const AngularFunctionsOf<float>& angular, RayIntensity& sum) {
    Lanes last_order;
    for (int lane = 0; lane < kLaneCount; ++lane) last_order[lane] = number_of_terms(x[lane]);
    const int terms = static_cast<int>(last_order.maxCoeff());
    thread_local std::vector<OneSize> spheres(kLaneCount);
    for (OneSize& sphere : spheres) {
        sphere.a.make_room(terms + kLaneCount + 1);
        sphere.b.make_room(terms + kLaneCount + 1);
    }
    RayWaves<Number> waves(m, x);
    RayResponse a, b;
    for (int n = 1; n <= terms; ++n) {
        waves.advance(last_order, a, b);
        for (int lane = 0; lane < kLaneCount; ++lane) {
            const auto put = [&](const RayResponse& r, FarWave& to) {
                to.put(n, {r.through.re[lane], r.through.im[lane]},
                       {r.inner.re[lane], r.inner.im[lane]}, first_way - 1);
            };
            put(a, spheres[lane].a);
            put(b, spheres[lane].b);
        }
    }
    for (int lane = 0; lane < kLaneCount; ++lane) {
        if (!(weight[lane] > 0)) continue;
        spheres[lane].add_to(weight[lane], x[lane] * x[lane], static_cast<int>(last_order[lane]),
                             angular, sum);
    }
}

}  // namespace

RayIntensity intensity_of_far_rays(Complex relative_index, int first_way,
                                   const WeightedSizes& sizes, int first_size, int size_count,
                                   const AngularFunctionsOf<float>& angular) {
    RayIntensity sum{Eigen::VectorXd::Zero(angular.angle_count())};
    for (int first = 0; first < size_count; first += kLaneCount) {
        Lanes x, weight;
        for (int lane = 0; lane < kLaneCount; ++lane) {
            const int at = first_size + std::min(first + lane, size_count - 1);
            x[lane] = sizes.parameters[at];
            weight[lane] = first + lane < size_count ? sizes.weights[at] : 0.0;
        }
        if (relative_index.imag() == 0) {
            add_eight(relative_index.real(), x, weight, first_way, angular, sum);
        } else {
            add_eight(relative_index, x, weight, first_way, angular, sum);
        }
    }
    return sum;
}

}  // namespace miebrdf::mie
