// Partial waves of a sphere sorted by rays: the Debye series.
#pragma once

#include <complex>
#include <optional>

#include "mie/sphere/lane_waves.h"

namespace miebrdf::mie {

/// The response of the boundary to a partial wave of one polarisation, for eight sizes:
///     a_n = 1/2 [1 - outer - sum_{p>=1} through inner^(p-1)]
/// (Debye 1909; Hovenac & Lock 1992, J. Opt. Soc. Am. A 9, 781, eq. 5-8).
struct RayResponse {
    ComplexLanes outer;  ///< the wave from outside, reflected: R22
    ComplexLanes inner;  ///< the wave from inside, reflected, after one way through the sphere: R11
    ComplexLanes through;  ///< into the sphere, through it and out: T21 T12
};

/// The responses of eight sizes for n = 1, 2, ... in order. For |m| > 1.
///
/// With zeta = psi + i eta (outgoing; ingoing where the sign of eta is changed) and
///     G(X, Z) = m X_{n-1} Z_n - X_n [Z_{n-1} + (n/x) (m - 1/m) Z_n]   of a_n,
///     G(X, Z) = X_{n-1} Z_n - m X_n Z_{n-1}                            of b_n,
/// N = G(out(x), in(mx)):  R11 = -G(out(x), out(mx)) / N,  R22 = -G(in(x), in(mx)) / N,
/// T21 T12 = -4 m / N^2.
/// All waves go upward; inside, outgoing and ingoing ones without their factors exp(+-i m x), so
/// that damping does not overflow. Upward, ingoing waves lose digits by those that grow, the more
/// the more they are damped; where nothing comes through a sphere within rounding (kOpaque), the
/// wave that is regular in the middle stands for them, and no ray but the reflected one is left.
template <typename Number>
class RayWaves {
  public:
    RayWaves(Number m, const Lanes& x);

    /// Moves to the next order; the first call gives n = 1.
    /// @param last_order  lanes beyond theirs do not scatter: outer is 1, the rest 0
    void advance(const Lanes& last_order, RayResponse& a, RayResponse& b);

  private:
    struct Wave {
        ComplexLanes here, before;  // n and n - 1
    };
    /// Im m x beyond which the way through the middle leaves 1e-16 of the light.
    static constexpr double kOpaque = 18;
    void advance_some(int first, RayResponse& a, RayResponse& b);

    Number m_, slope_;  ///< index; m - 1 / m
    int order_ = 0;
    OutsideWaves outside_;
    LanesOf<Number> inverse_z_;
    Wave out_, in_;                // inside; `in_` of a real index is the conjugate of `out_`
    ComplexLanes round_;           // exp(2 i m x)
    Lanes clear_ = Lanes::Ones();  // 0 where a sphere is opaque
    std::optional<InsideWave<Number>> regular_ = {};  // of opaque ones
};

}  // namespace miebrdf::mie
