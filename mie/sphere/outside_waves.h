// psi_n(x) and eta_n(x) outside eight spheres at once.
#pragma once

#include <cmath>

#include "mie/sphere/lanes.h"

namespace miebrdf::mie {

/// Riccati-Bessel functions of the lanes' size parameters, upward, from n = 0 (radial_functions.h
/// has the care that single spheres get; here psi_n beyond n = x carries an absolute error of
/// rounding).
struct OutsideWaves {
    explicit OutsideWaves(const Lanes& x) : inverse_x(1 / x) {
        for (int lane = 0; lane < lane_count; ++lane) {
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

}  // namespace miebrdf::mie
