// Random numbers that are the same with every standard library; the distributions of <random> are
// not.
#pragma once

#include <cmath>
#include <random>

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

}  // namespace miebrdf::stress
