#include "mie/ensemble/far_rays.h"

#include <algorithm>
#include <cmath>
#include <cstring>
#include <vector>

#include "mie/ensemble/amplitude_tiles.h"
#include "mie/sphere/radial_functions.h"
#include "mie/sphere/ray_waves.h"
#include "mie/sphere/vectors.h"

namespace miebrdf::mie {
namespace {

using Complex = std::complex<double>;

// docs/internals/constants.md says what each constant does.
struct FarRayRule {
    /// Orders below and above that scatter less than this share of the light together are left
    /// out: 1e-5 of P straight back, where all add up in step.
    static constexpr double kFaint = 1e-7;
    /// 1 - |R|^2, where |R| is 1 to rounding.
    static constexpr double kLeastLoss = 1e-28;
};
constexpr int kPiece = kRegisterSize<float>;

// B_n and R_n of one polarisation at all orders of one size.
struct FarWave {
    Eigen::ArrayXf re, im, inner_re, inner_im;
    Eigen::ArrayXd energy;  // of the order, incoherent

    // Zero from the first entry on; whole pieces from any order on may be read.
    void make_room(int terms) {
        for (Eigen::ArrayXf* part : {&re, &im, &inner_re, &inner_im}) part->setZero(terms + kPiece);
        energy.setZero(terms + 1);
    }
};

MIEBRDF_VECTOR FloatPair load_piece(const Eigen::ArrayXf& part, int m) {
    FloatPair piece;
    std::memcpy(&piece, part.data() + m, sizeof piece);
    return piece;
}

// B_n C_m* / (1 - R_n Q_m*) at one n of one wave and some m of another, as a quotient: its real
// part.
struct Product {
    FloatPair above, below;

    MIEBRDF_VECTOR Product(const FarWave& wave, int n, const FarWave& other, int m) {
        const FloatPair re = load_piece(other.re, m), im = load_piece(other.im, m);
        const FloatPair inner_re = load_piece(other.inner_re, m);
        const FloatPair inner_im = load_piece(other.inner_im, m);
        const FloatPair above_re = wave.re[n] * re + wave.im[n] * im;
        const FloatPair above_im = wave.im[n] * re - wave.re[n] * im;
        const FloatPair below_re = 1 - (wave.inner_re[n] * inner_re + wave.inner_im[n] * inner_im);
        const FloatPair below_im = wave.inner_re[n] * inner_im - wave.inner_im[n] * inner_re;
        above = above_re * below_re + above_im * below_im;
        // Rounding may leave nothing where hardly anything goes through.
        below = below_re * below_re + below_im * below_im + 1e-14F;
    }
};

// One division does for both.
MIEBRDF_VECTOR FloatPair sum_of(const Product& p, const Product& q) {
    return (p.above * q.below + q.above * p.below) / (p.below * q.below);
}

struct OneSize {
    FarWave a, b;

    void add_to(double weight, double light, int terms, const AngularFunctionsOf<float>& angular,
                RayIntensity& sum) const {
        int first = 1, last = terms;
        const auto share = [&](int n) { return (2 * n + 1) * (a.energy[n] + b.energy[n]); };
        for (double faint = 0;
             first <= last && (faint += share(first)) < FarRayRule::kFaint * light;)
            ++first;
        for (double faint = 0; last > first && (faint += share(last)) < FarRayRule::kFaint * light;)
            --last;
        if (first > last) return;
        const int count = last - first + 1;
        // |U|^2 and |V|^2 of a pair of orders: aa + bb +- (ab + ba).
        thread_local TriangularForm<float> plus, minus;
        plus.make_room(count);
        minus.make_room(count);
        for (int n = 0; n < count; ++n) {
            float *of_plus = plus.row(n), *of_minus = minus.row(n);
            const int row = first + n;
            for (int m = 0; m <= n; m += kPiece) {
                const int column = first + m;
                const FloatPair same =
                    sum_of(Product(a, row, a, column), Product(b, row, b, column));
                const FloatPair crossed =
                    sum_of(Product(a, row, b, column), Product(b, row, a, column));
                const FloatPair both = 2 * (same + crossed), neither = 2 * (same - crossed);
                std::memcpy(of_plus + m, &both, sizeof both);
                std::memcpy(of_minus + m, &neither, sizeof neither);
            }
            for (float* values : {of_plus, of_minus}) {
                values[n] *= 0.5F;
                std::fill(values + n + 1, values + TriangularForm<float>::piece_end(n), 0.0F);
            }
            sum.scattered += 0.5 * weight * share(row);
        }
        angular.add_forms(0.25 * weight, plus, minus, first, sum.at_angles);
    }
};

// Eight sizes at one order.
void put(int n, const RayResponse& r, int ways_before, FarWave OneSize::*wave,
         std::vector<OneSize>& spheres) {
    ComplexLanes waves, inner;
    Lanes energy;
    for (int lane = 0; lane < kLaneCount; lane += kVectorSize) {
        const ComplexVector back = load(r.inner, lane);
        const ComplexVector wave_here = load(r.through, lane) * power(back, ways_before);
        const Vector loss = 1 - norm(back), least = Vector{} + FarRayRule::kLeastLoss;
        store(wave_here, waves, lane);
        store(back, inner, lane);
        store(norm(wave_here) / (loss > least ? loss : least), energy, lane);
    }
    for (int lane = 0; lane < kLaneCount; ++lane) {
        FarWave& to = spheres[lane].*wave;
        to.re[n] = static_cast<float>(waves.re[lane]);
        to.im[n] = static_cast<float>(waves.im[lane]);
        to.inner_re[n] = static_cast<float>(inner.re[lane]);
        to.inner_im[n] = static_cast<float>(inner.im[lane]);
        to.energy[n] = energy[lane];
    }
}

template <typename Number>
void add_eight(Number m, const Lanes& x, const Lanes& weight, int first_way,
               const AngularFunctionsOf<float>& angular, RayIntensity& sum) {
    Lanes last_order;
    for (int lane = 0; lane < kLaneCount; ++lane) last_order[lane] = number_of_terms(x[lane]);
    const int terms = static_cast<int>(last_order.maxCoeff());
    thread_local std::vector<OneSize> spheres(kLaneCount);
    for (OneSize& sphere : spheres) {
        sphere.a.make_room(terms);
        sphere.b.make_room(terms);
    }
    RayWaves<Number> waves(m, x);
    RayResponse a, b;
    for (int n = 1; n <= terms; ++n) {
        waves.advance(last_order, a, b);
        put(n, a, first_way - 1, &OneSize::a, spheres);
        put(n, b, first_way - 1, &OneSize::b, spheres);
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
