// psi_n(mx) inside one sphere for all orders, laid out for vectors of orders.
#pragma once

#include <complex>
#include <type_traits>
#include <vector>

#include "mie/sphere/lanes.h"

namespace miebrdf::mie {

/// psi_n(z) and psi_{n-1}(z), eight orders at a time from n = 1, 9, 17 ... on. Each eight have a
/// scale of their own, which cancels in a_n and b_n. Number: double or std::complex<double>.
template <typename Number>
class InsideOrders {
  public:
    using Values = LanesOf<Number>;

    InsideOrders() = default;

    /// Downward, for every z: from above |z|, or from the WKB value where the far side cannot be
    /// seen (logarithmic_derivative.h). No division.
    static InsideOrders downward(Number z, int terms);

    /// Upward, where upward_is_stable.
    static InsideOrders upward(Number z, int terms);

    /// What has been computed upward elsewhere: psi_n(z), n = 0 ... terms.
    static InsideOrders of_upward(std::vector<double> psi, int terms);

    Values here(int n) const { return here_.at(n); }  ///< psi_n ... psi_{n+7}
    Values before(int n) const {                      ///< psi_{n-1} ... psi_{n+6}
        return before_.re.empty() ? here_.at(n - 1) : before_.at(n);
    }

    /// Im(psi_{n-1} conj psi_n) in the scale of here(n), summed as in absorption_source.h.
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
        std::vector<double> re, im;  // im stays empty for real numbers
    };
    void put(int n, Number value, double absorption);
    void sum_absorption_upward(std::complex<double> z, int terms);

    Parts here_, before_;             // before_ stays empty where one scale does for all
    std::vector<double> absorption_;  // of complex z
};

}  // namespace miebrdf::mie
