// The source of all absorption, inside eight spheres at once.
#pragma once

#include <complex>

#include "mie/sphere/inside_wave.h"

namespace miebrdf::mie {

/// T_n = Im(psi_{n-1} conj psi_n)(mx), the source of all absorption, with T_n -> 0 as n grows:
///     T_{n+1} = T_n + (2n + 1) |psi_n|^2 Im z / |z|^2,  T_0 = -sinh(2 Im z) / 2.
/// Summed, it keeps its digits however small k is, which the product itself does not: downward
/// where the wave is taken downward (all terms have one sign), upward where it goes upward and
/// T_n is still far from 0.
class AbsorptionSource {
  public:
    AbsorptionSource(std::complex<double> m, const Lanes& x,
                     const InsideWave<std::complex<double>>& inside) {
        const Lanes y = m.imag() * x;
        summed_ = y.maxCoeff() < 1;  // beyond, the product has lost nothing
        if (!summed_) return;
        // Upward only, where psi_0 = sin z.
        slope_ = y * norm(inside.inverse_z());
        T_ = -0.5 * (2 * y).sinh() + norm(inside.here()) * slope_;
    }

    Lanes at(const InsideWave<std::complex<double>>& inside, int order) {
        if (const Lanes* downward = inside.absorption()) return *downward;
        const ComplexLanes& P = inside.here();
        const ComplexLanes& Q = inside.before();
        if (!summed_) return Q.im * P.re - Q.re * P.im;
        const Lanes T = T_;
        T_ += (2 * order + 1) * norm(P) * slope_;
        return T;
    }

  private:
    bool summed_ = false;
    Lanes slope_, T_;
};

}  // namespace miebrdf::mie
