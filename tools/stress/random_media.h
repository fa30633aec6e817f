// Random media of smooth phase functions, and directions.
#pragma once

#include <vector>

#include <miebrdf/optics.h>
#include <miebrdf/solver.h>
#include "tools/stress/dice.h"

namespace miebrdf::stress {

inline double random_albedo(Dice& dice) {
    switch (dice.integer(0, 4)) {
        case 0:
            return 1.0;
        case 1:
            return 1.0 - dice.logarithmic(1e-8, 1e-2);
        case 2:
            return dice.logarithmic(1e-4, 0.1);
        default:
            return dice.uniform(0.0, 1.0);
    }
}

inline rte::Optics random_smooth(Dice& dice) {
    const double albedo = random_albedo(dice);
    switch (dice.integer(0, 4)) {
        case 0:
            return rte::isotropic_optics(albedo);
        case 1:
            return rte::rayleigh_optics(albedo);
        default:
            return rte::henyey_greenstein_optics(albedo, dice.uniform(-0.5, 0.85));
    }
}

inline rte::Directions random_directions(Dice& dice) {
    const auto cosines = [&] {
        std::vector<double> list;
        for (int i = dice.integer(1, 3); i > 0; --i)
            list.push_back(dice.chance(0.2) ? 1.0 : dice.logarithmic(0.02, 1.0));
        return list;
    };
    rte::Directions directions{cosines(), cosines(), {}};
    if (dice.chance(0.3)) directions.mu_out = directions.mu_in;
    for (int i = dice.integer(1, 3); i > 0; --i)
        directions.azimuth_deg.push_back(dice.chance(0.5) ? 180.0 * dice.integer(0, 1)
                                                          : dice.uniform(0.0, 180.0));
    return directions;
}

}  // namespace miebrdf::stress
