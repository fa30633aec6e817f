// Riccati-Bessel functions in vectors of eight: inside and outside eight spheres at once, and
// inside one sphere, eight orders at once.
#pragma once

#include <cmath>
#include <complex>
#include <type_traits>
#include <vector>

#include "mie/sphere/kept_memory.h"
#include "mie/sphere/lane_math.h"

namespace miebrdf::mie {

/// |m - 1| from which small spheres in lanes keep their digits; nearer to the index of the host
/// mie_coefficients has more care.
constexpr double kWellOffTheHost = 1e-2;

/// Riccati-Bessel functions of the lanes' size parameters, upward, from n = 0 (radial_functions()
/// has the care that single spheres get; here psi_n beyond n = x carries an absolute error of
/// rounding).
struct OutsideWaves {
    explicit OutsideWaves(const Lanes& x) : inverse_x(1 / x) {
        for (int lane = 0; lane < kLaneCount; ++lane) {
            psi[lane] = std::sin(x[lane]);
            psi_before[lane] = std::cos(x[lane]);
        }
        eta = -psi_before;
        eta_before = psi;
    }

    void advance(int order) {
        const Lanes factor = (2 * order - 1) * inverse_x;
        const Lanes next_psi = factor * psi - psi_before;
        const Lanes next_eta = factor * eta - eta_before;
        psi_before = psi;
        eta_before = eta;
        psi = next_psi;
        eta = next_eta;
    }

    /// Lanes that are past their own last term stop, before eta_n overflows.
    void advance_some(int order, const Lanes& last_order) {
        const OutsideWaves old = *this;
        advance(order);
        const auto going = last_order >= order;
        psi = going.select(psi, old.psi);
        eta = going.select(eta, old.eta);
        psi_before = going.select(psi_before, old.psi_before);
        eta_before = going.select(eta_before, old.eta_before);
    }

    Lanes inverse_x, psi, psi_before, eta, eta_before;
};

/// Gives psi_{n-1}(z) and psi_n(z), z = m x, for n = 1, 2, ... in order.
///
/// The three-term recurrence psi_{n+1} = (2n+1)/z psi_n - psi_{n-1} needs no division. Upward it
/// is stable while psi_n oscillates, undamped or far below |z| (upward_is_stable); otherwise it
/// runs downward once, from above |z|, with factors that keep it in range, and the values are
/// stored.
template <typename Number>
class InsideWave {
  public:
    using Values = LanesOf<Number>;

    /// @param z  m x of the lanes, any order
    /// @param terms  orders 1 ... terms can be asked for
    InsideWave(const Values& z, int terms);

    /// Moves to the next order; the first call gives n = 1.
    void advance() {
        ++order_;
        if (upward_) {
            const Values next = minus(times(scaled(inverse_z_, 2 * order_ - 1), here_), before_);
            before_ = here_;
            here_ = next;
            return;
        }
        before_ = stored_[order_ - 1];
        here_ = stored_[order_];
        if (next_factor_ < factors_.size() && factors_[next_factor_].order == order_) {
            here_ = times(here_, factors_[next_factor_++].factor);
        }
    }

    const Values& here() const { return here_; }      ///< psi_n
    const Values& before() const { return before_; }  ///< psi_{n-1}

    /// Im(psi_{n-1} conj psi_n) of a complex wave that was taken downward, else null.
    const Lanes* absorption() const { return absorption_.empty() ? nullptr : &absorption_[order_]; }

    const Values& inverse_z() const { return inverse_z_; }

  private:
    struct Factor {
        int order;
        Lanes factor;
    };

    static Lanes scaled(const Lanes& z, double factor) { return z * factor; }
    static ComplexLanes scaled(const ComplexLanes& z, double factor) {
        return {z.re * factor, z.im * factor};
    }

    void start_upward(const Values& z);
    void run_downward(const Values& z, int terms);

    Values inverse_z_, here_, before_;
    int order_ = 0;
    bool upward_ = false;
    std::vector<Values> stored_;
    std::vector<Lanes> absorption_;
    std::vector<Factor> factors_;
    std::size_t next_factor_ = 0;
};

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
        Lanes T = T_;
        T_ += (2 * order + 1) * norm(P) * slope_;
        return T;
    }

  private:
    bool summed_ = false;
    Lanes slope_, T_;
};

/// psi_n(z) and psi_{n-1}(z), eight orders at a time from n = 1, 9, 17 ... on. Each eight have a
/// scale of their own, which cancels in a_n and b_n. Number: double or std::complex<double>.
template <typename Number>
class InsideOrders {
  public:
    using Values = LanesOf<Number>;

    InsideOrders() = default;

    /// Downward, for every z: from above |z|, or from the WKB value where the far side cannot be
    /// seen (damped_logarithmic_derivative). No division.
    static InsideOrders downward(Number z, int terms);

    /// Upward, where upward_is_stable.
    static InsideOrders upward(Number z, int terms);

    /// Takes waves that were computed upward elsewhere: psi_n(z), n = 0 ... terms.
    static InsideOrders of_upward(KeptVector<double> psi, int terms);

    Values here(int n) const { return here_.at(n); }  ///< psi_n ... psi_{n+7}
    Values before(int n) const {                      ///< psi_{n-1} ... psi_{n+6}
        return before_.re.empty() ? here_.at(n - 1) : before_.at(n);
    }

    /// Im(psi_{n-1} conj psi_n) in the scale of here(n), summed as by AbsorptionSource.
    Lanes absorption(int n) const { return Eigen::Map<const Lanes>(&absorption_[n]); }

  private:
    struct Parts {
        void make_room(int terms);
        void set(int n, Number value);
        Values at(int n) const {
            if constexpr (std::is_same_v<Number, double>) {
                return Eigen::Map<const Lanes>(&re[n]);
            } else {
                return {Eigen::Map<const Lanes>(&re[n]), Eigen::Map<const Lanes>(&im[n])};
            }
        }
        KeptVector<double> re, im;  // im stays empty for real numbers
    };
    void put(int n, Number value, double absorption);
    void sum_absorption_upward(std::complex<double> z, int terms);

    Parts here_, before_;            // before_ stays empty where one scale does for all
    KeptVector<double> absorption_;  // of complex z
};

}  // namespace miebrdf::mie
