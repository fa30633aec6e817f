// Random numbers that are the same with every standard library (the distributions of <random> are
// not); random media of smooth phase functions, and directions.
#pragma once

#include <cmath>
#include <random>
#include <vector>

#include <miebrdf/optics.h>
#include <miebrdf/solver.h>

namespace miebrdf::stress {

class Dice {
  public:
    explicit Dice(unsigned seed) : engine_(seed) {}
    double uniform(double low, double high) { return low + (high - low) * next(); }
    double logarithmic(double low, double high) {
        return std::exp(uniform(std::log(low), std::log(high)));
    }
    bool chance(double probability) { return next() < probability; }
    int integer(int low, int high) { return low + int(next() * (high - low + 1)); }

  private:
    double next() { return (double(engine_()) + 0.5) / 4294967296.0; }
    std::mt19937 engine_;
};

inline double random_albedo(Dice& dice) {
    const int kind = dice.integer(0, 4);
    return kind == 0   ? 1.0
           : kind == 1 ? 1.0 - dice.logarithmic(1e-8, 1e-2)
           : kind == 2 ? dice.logarithmic(1e-4, 0.1)
                       : dice.uniform(0.0, 1.0);
}

inline rte::Optics random_smooth(Dice& dice) {
    const double albedo = random_albedo(dice);
    const int kind = dice.integer(0, 4);
    return kind == 0   ? rte::isotropic_optics(albedo)
           : kind == 1 ? rte::rayleigh_optics(albedo)
                       : rte::henyey_greenstein_optics(albedo, dice.uniform(-0.5, 0.85));
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
