#include "mie/ensemble/exact_extinction.h"

#include <algorithm>
#include <cmath>
#include <memory>
#include <numbers>
#include <numeric>
#include <vector>

#include "mie/sizes/size_law.h"
#include "mie/sphere/lane_waves.h"
#include "mie/sphere/radial_functions.h"
#include "rte/math/quadrature.h"

namespace miebrdf::mie {
namespace {

using Complex = std::complex<double>;

// sum_n (2n+1) (a_n + b_n) for eight complex size parameters.
void forward_sums(Complex m, const Complex* x, Complex* sums) {
    ComplexLanes X, z;
    ComplexLanes psi, psi_before, xi, xi_before;
    double largest = 0;
    for (int lane = 0; lane < kLaneCount; ++lane) {
        const auto set = [lane](ComplexLanes& lanes, Complex value) {
            lanes.re[lane] = value.real();
            lanes.im[lane] = value.imag();
        };
        largest = std::max(largest, std::abs(x[lane]));
        set(X, 1.0 / x[lane]);
        set(z, m * x[lane]);
        set(psi, std::sin(x[lane]));
        set(psi_before, std::cos(x[lane]));
        // xi = psi + i eta, outgoing: xi_0 = -i exp(ix), xi_{-1} = exp(ix).
        const Complex outgoing = std::exp(Complex(0, 1) * x[lane]);
        set(xi, Complex(0, -1) * outgoing);
        set(xi_before, outgoing);
    }
    // Symbols as in Boundary of lane_math.h.
    const int terms = number_of_terms(largest);
    InsideWave<Complex> inside(z, terms);
    const Complex m_minus_inverse = m - 1.0 / m;
    const auto scaled = [](Complex factor, const ComplexLanes& v) {
        return ComplexLanes{factor.real() * v.re - factor.imag() * v.im,
                            factor.real() * v.im + factor.imag() * v.re};
    };
    ComplexLanes total{Lanes::Zero(), Lanes::Zero()};
    for (int n = 1; n <= terms; ++n) {
        inside.advance();
        const ComplexLanes factor = scaled(2 * n - 1.0, X);
        const ComplexLanes next_psi = minus(times(factor, psi), psi_before);
        const ComplexLanes next_xi = minus(times(factor, xi), xi_before);
        psi_before = psi;
        xi_before = xi;
        psi = next_psi;
        xi = next_xi;
        const ComplexLanes& P = inside.here();
        const ComplexLanes& Q = inside.before();
        const ComplexLanes A =
            plus(Q, times(scaled(m_minus_inverse * static_cast<double>(n), P), X));
        const ComplexLanes mP = scaled(m, P);
        const ComplexLanes B = scaled(m, Q);
        const ComplexLanes pa = minus(times(A, psi), times(mP, psi_before));
        const ComplexLanes da = minus(times(A, xi), times(mP, xi_before));
        const ComplexLanes pb = minus(times(B, psi), times(P, psi_before));
        const ComplexLanes db = minus(times(B, xi), times(P, xi_before));
        const Lanes inverse_a = (2 * n + 1) / norm(da);
        const Lanes inverse_b = (2 * n + 1) / norm(db);
        // Past the last term of a lane xi_n overflows in the end; its share is below rounding.
        const auto add = [](Lanes& sum, const Lanes& term) {
            sum += term.isNaN().select(Lanes::Zero(), term);
        };
        add(total.re, (pa.re * da.re + pa.im * da.im) * inverse_a +
                          (pb.re * db.re + pb.im * db.im) * inverse_b);
        add(total.im, (pa.im * da.re - pa.re * da.im) * inverse_a +
                          (pb.im * db.re - pb.re * db.im) * inverse_b);
    }
    for (int lane = 0; lane < kLaneCount; ++lane) {
        sums[lane] = {total.re[lane], total.im[lane]};
    }
}

// Relative errors on the reference cases are below 1.5e-8 with these
// (tests/mie/exact_extinction_test.cpp).
// docs/internals/constants.md says what each constant does.
struct PathRule {
    /// Im x: higher, small spheres would cancel.
    static constexpr double kHeight = 4;
    static constexpr int kCapNodes = 32;
    /// The wave through the sphere is damped by exp(-this) up there, and needs no nodes.
    static constexpr double kDamped = 12;
    /// Nodes of a line, more for each period of that wave, and periods of a piece at most: large
    /// grains of ice have thousands.
    static constexpr double kLineNodes = 72, kNodesPerPeriod = 2.2, kMostPerPiece = 2000;
};

struct Path {
    std::vector<Complex> x;
    std::vector<Complex> weight;  // dx
};

// highest: what the density of sizes allows at the effective radius (SizeLaw::continuation_height),
// and in proportion to the radius elsewhere: a density grows with the angle off the real axis, so
// that the path begins as a ray from the origin.
Path shifted_path(Complex m, double smallest, double largest, double highest, double effective) {
    const double height = std::min({PathRule::kHeight, largest, highest});
    const double slope = highest / effective;
    const auto height_at = [&](double x) { return std::min(height, slope * x); };
    Path path;
    // Up or down at one end: Im x = height t^4, so that resonances close to the axis are resolved.
    const auto add_cap = [&](double end, double sign) {
        const math::Quadrature rule = math::gauss_legendre(PathRule::kCapNodes, 0, 1);
        const double top = height_at(end);
        for (int i = 0; i < PathRule::kCapNodes; ++i) {
            const double t = rule.nodes[i];
            path.x.emplace_back(end, top * t * t * t * t);
            path.weight.emplace_back(0, sign * rule.weights[i] * top * 4 * t * t * t);
        }
    };
    // The wave through the sphere, exp(2i (m - 1) x), still oscillates up there.
    const auto add_line = [&](double from, double to, double rise) {
        const double width = to - from;
        const double damping = 2 * (std::abs(m.real() - 1) * height_at(from) + m.imag() * smallest);
        const double periods =
            damping > PathRule::kDamped ? 0.0 : width * std::abs(m.real() - 1) / std::numbers::pi;
        const int pieces =
            1 + static_cast<int>(PathRule::kNodesPerPeriod * periods / PathRule::kMostPerPiece);
        const int count =
            static_cast<int>(PathRule::kLineNodes + PathRule::kNodesPerPeriod * periods / pieces) /
            kLaneCount * kLaneCount;
        for (int piece = 0; piece < pieces; ++piece) {
            const math::Quadrature rule = math::gauss_legendre(count, from + width * piece / pieces,
                                                               from + width * (piece + 1) / pieces);
            for (int i = 0; i < count; ++i) {
                path.x.emplace_back(rule.nodes[i], height_at(rule.nodes[i]));
                path.weight.push_back(rule.weights[i] * Complex(1, rise));
            }
        }
    };
    add_cap(smallest, 1);
    const double corner = std::clamp(height / slope, smallest, largest);
    if (corner > smallest) add_line(smallest, corner, slope);
    if (corner < largest) add_line(corner, largest, 0);
    add_cap(largest, -1);
    return path;
}

}  // namespace

double exact_extinction(const Ensemble& ensemble, const Executor& run) {
    const std::unique_ptr<const AreaDensity> density = area_density(ensemble.sizes);
    const double k = ensemble.wave_number_per_um, effective = ensemble.effective_x();
    const Complex m = ensemble.scatterer.relative_index;
    const Path path =
        shifted_path(m, ensemble.smallest_x(), ensemble.largest_x(),
                     effective * ensemble.law().continuation_height(ensemble.sizes), effective);
    const int groups = static_cast<int>(path.x.size()) / kLaneCount;
    std::vector<double> parts(groups, 0.0);
    run(groups, [&](int group) {
        Complex sums[kLaneCount];
        const std::size_t first = static_cast<std::size_t>(group) * kLaneCount;
        forward_sums(m, &path.x[first], sums);
        for (int lane = 0; lane < kLaneCount; ++lane) {
            const Complex x = path.x[first + lane];
            const Complex share = density->at(x / k) / k * path.weight[first + lane];
            parts[group] += (2.0 / (x * x) * sums[lane] * share).real();
        }
    });
    return std::accumulate(parts.begin(), parts.end(), 0.0);
}

}  // namespace miebrdf::mie
