#include "mie/sphere/lane_layers.h"

#include <algorithm>
#include <cmath>

#include "mie/sphere/radial_functions.h"

namespace miebrdf::mie {
namespace {

using Complex = std::complex<double>;

template <typename Function>
ComplexLanes lane_by_lane(const ComplexLanes& a, const ComplexLanes& b, const Function& function) {
    ComplexLanes result;
    for (int lane = 0; lane < kLaneCount; ++lane) {
        const Complex value =
            function(Complex(a.re[lane], a.im[lane]), Complex(b.re[lane], b.im[lane]));
        result.re[lane] = value.real();
        result.im[lane] = value.imag();
    }
    return result;
}

// psi_n and zeta_n = psi_n + i eta_n at one surface by their logarithmic derivatives D1 and D3.
struct SurfaceWaves {
    void begin(const ComplexLanes& at, int terms) {
        z = at;
        inverse_z = reciprocal(at);
        D = {Lanes::Zero(), Lanes::Zero()};
        D3 = {Lanes::Zero(), Lanes::Ones()};
        D1.resize(terms + 1);
        ratios.resize(terms + 1);
    }
    // D1 downward, with psi_n / psi_{n-1}: neither is a difference of equal numbers.
    void step_down(int n, int terms) {
        const ComplexLanes n_over_z = times(inverse_z, Lanes::Constant(n));
        const ComplexLanes ratio = reciprocal(plus(D, n_over_z));
        if (n <= terms) {
            D1[n] = D;
            ratios[n] = ratio;
        }
        D = minus(n_over_z, ratio);
    }

    ComplexLanes z, inverse_z, D;
    std::vector<ComplexLanes> D1, ratios;
    ComplexLanes D3;  // of the present order, from i on
};

// Q_0 of (psi_n / zeta_n)(inner) / (psi_n / zeta_n)(outer): psi_0 / zeta_0 = i exp(-iz) sin z, far
// off the axis in a form that does not overflow.
Complex first_quotient(Complex inner, Complex outer) {
    const Complex turn = Complex(0, 1) * (outer - inner);
    const auto beyond = [](Complex z) { return std::exp(Complex(0, 2) * z) - 1.0; };
    return inner.imag() > 1 ? std::exp(2.0 * turn) * beyond(inner) / beyond(outer)
                            : std::exp(turn) * std::sin(inner) / std::sin(outer);
}

// Takes the logarithmic derivatives through a layer. Only ratios of waves are formed, because the
// waves themselves leave the range of numbers in thick absorbing layers.
// @param ratio  of the layer's index to that inside
void pass_layer(Complex ratio, SurfaceWaves& inner, SurfaceWaves& outer, int terms,
                LayeredInside& H) {
    ComplexLanes Q = lane_by_lane(inner.z, outer.z, first_quotient);
    for (int n = 1; n <= terms; ++n) {
        const Lanes order = Lanes::Constant(n);
        const ComplexLanes inner_n = times(inner.inverse_z, order);
        const ComplexLanes outer_n = times(outer.inverse_z, order);
        // zeta_n / zeta_{n-1}, and its inverse D3_n + n/z.
        const ComplexLanes outer_step = minus(outer_n, outer.D3);
        const ComplexLanes inner_zeta = reciprocal(minus(inner_n, inner.D3));
        inner.D3 = minus(inner_zeta, inner_n);
        outer.D3 = minus(reciprocal(outer_step), outer_n);
        Q = times(times(Q, times(inner_zeta, inner.ratios[n])),
                  times(outer_step, plus(outer.D1[n], outer_n)));
        const auto outward = [&](const ComplexLanes& at) {
            const ComplexLanes G1 = times(Q, minus(at, inner.D1[n])), G2 = minus(at, inner.D3);
            return times(minus(times(G2, outer.D1[n]), times(G1, outer.D3)),
                         reciprocal(minus(G2, G1)));
        };
        H.electric[n] = outward(times(ratio, H.electric[n]));
        H.magnetic[n] = outward(times(1.0 / ratio, H.magnetic[n]));
    }
}

}  // namespace

const LayeredInside& layered_inside(std::span<const LaneLayer> layers, int terms) {
    // Fresh memory would take longer than the waves.
    thread_local std::vector<SurfaceWaves> surfaces;
    thread_local LayeredInside H;
    std::vector<Complex> indices = {layers.front().relative_index};
    surfaces.resize(std::max(surfaces.size(), 2 * layers.size()));
    std::size_t count = 0;
    Lanes x = layers.front().size_parameter;
    surfaces[count++].begin(inside_parameter(indices.front(), x), terms);
    for (const LaneLayer& layer : layers.subspan(1)) {
        if (!(layer.size_parameter > x).all()) continue;
        indices.push_back(layer.relative_index);
        surfaces[count++].begin(inside_parameter(indices.back(), x), terms);
        x = layer.size_parameter;
        surfaces[count++].begin(inside_parameter(indices.back(), x), terms);
    }
    double largest = 0;
    for (std::size_t i = 0; i < count; ++i)
        largest = std::max(largest, norm(surfaces[i].z).maxCoeff());
    // All at once: each waits for itself.
    for (int n = safe_start(std::sqrt(largest), terms); n >= 1; --n) {
        for (std::size_t i = 0; i < count; ++i) surfaces[i].step_down(n, terms);
    }
    for (std::size_t i = 0; i < count; ++i) surfaces[i].D1[0] = surfaces[i].D;
    H.electric = surfaces.front().D1;
    H.magnetic = surfaces.front().D1;
    for (std::size_t i = 1; i < indices.size(); ++i)
        pass_layer(indices[i] / indices[i - 1], surfaces[2 * i - 1], surfaces[2 * i], terms, H);
    return H;
}

}  // namespace miebrdf::mie
