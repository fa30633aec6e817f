// psi_n(mx) inside eight spheres at once, up to a factor that cancels in a_n and b_n.
#pragma once

#include <complex>
#include <vector>

#include "mie/sphere/lanes.h"

namespace miebrdf::mie {

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

}  // namespace miebrdf::mie
