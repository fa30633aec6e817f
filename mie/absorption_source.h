// The source of all absorption, inside eight spheres at once.
#pragma once

#include <complex>

#include "mie/inside_wave.h"

namespace miebrdf::mie {

/// T_n = Im(psi_{n-1} conj psi_n)(mx), the source of all absorption. Summed upward,
///     T_{n+1} = T_n + (2n + 1) |psi_n|^2 Im z / |z|^2,  T_0 = -sinh(2 Im z) / 2,
/// it keeps its digits however small k is, which the product itself does not.
class AbsorptionSource {
  public:
    AbsorptionSource(std::complex<double> m, const Lanes& x,
                     const InsideWave<std::complex<double>>& inside) {
        const Lanes y = m.imag() * x;
        summed_ = y.maxCoeff() < 1;  // beyond, the product has lost nothing
        if (!summed_) return;
        slope_ = y * norm(inside.inverse_z());
        const Lanes scale = (norm(inside.first()) + norm(inside.before_first())) / (2 * y).cosh();
        T_ = -0.5 * scale * (2 * y).sinh() + norm(inside.first()) * slope_;
    }

    Lanes at(const InsideWave<std::complex<double>>& inside, int order) {
        const ComplexLanes& P = inside.here();
        const ComplexLanes& Q = inside.before();
        if (!summed_) return Q.im * P.re - Q.re * P.im;
        Lanes T = T_;
        T_ += (2 * order + 1) * norm(P) * slope_;
        if (const Lanes* change = inside.change_of_scale()) T_ *= change->square();
        return T;
    }

  private:
    bool summed_ = false;
    Lanes slope_, T_;
};

}  // namespace miebrdf::mie
