// The stress battery: stiff and extreme cases, each with a bound that has a cause.
#pragma once

#include <complex>
#include <functional>
#include <string>
#include <vector>

#include <miebrdf/solver.h>
#include "tools/bench/scenes.h"

namespace miebrdf::stress {

using bench::worst;
using Index = std::complex<double>;

/// One checked number.
struct Check {
    std::string suite;
    std::string test_case;
    std::string quantity;
    double value = 0.0;
    double bound = 0.0;
    std::string cause;                          ///< why the bound is what it is
    bool ok() const { return value <= bound; }  // not-a-number is not ok
};

/// The checks of one case are added here.
class Case {
  public:
    Case(std::string suite, std::string name, std::vector<Check>& checks)
        : suite_(std::move(suite)), name_(std::move(name)), checks_(checks) {}

    /// value <= bound must hold.
    void at_most(const std::string& quantity, double value, double bound,
                 const std::string& cause) const {
        checks_.push_back({suite_, name_, quantity, value, bound, cause});
    }

  private:
    std::string suite_, name_;
    std::vector<Check>& checks_;
};

/// Collects the checks of one suite.
class Log {
  public:
    Log(std::string suite, std::vector<Check>& checks)
        : suite_(std::move(suite)), checks_(checks) {}

    /// `action` adds checks to the case; if it throws, that itself is a failed check.
    void run(const std::string& test_case, const std::function<void(const Case&)>& action);

    /// `action` must throw std::exception: 0 if it does, 1 if it returns something.
    void refused(const std::string& test_case, const std::function<void()>& action);

  private:
    std::string suite_;
    std::vector<Check>& checks_;
};

/// The distance of `value` from [low, high]; NaN stays NaN.
double outside(double value, double low, double high);

/// Largest of |a - b| / max(|a|, |b|); 0 where both are 0.
double relative_difference(double a, double b);
/// The largest of them over two lists of one length; NaN if one of them is.
double largest_difference(const std::vector<double>& a, const std::vector<double>& b);
/// Likewise, over the largest value of `a`.
double largest_jump(const std::vector<double>& a, const std::vector<double>& b);

/// R of which each value has a partner with incident and outgoing direction exchanged, from equal
/// lists of both: calls see(R, partner).
template <typename See>
void see_reciprocal(const std::vector<double>& R, std::size_t cosines, std::size_t azimuths,
                    const See& see) {
    for (std::size_t i = 0; i < cosines; ++i)
        for (std::size_t o = 0; o < cosines; ++o)
            for (std::size_t a = 0; a < azimuths; ++a)
                see(R[(i * cosines + o) * azimuths + a], R[(o * cosines + i) * azimuths + a]);
}

/// "1.5+0.1i".
std::string text_of(Index index);

/// Two neighbouring values of a parameter with different methods (or grids) behind them.
struct SwitchPoint {
    double below = 0.0;
    double above = 0.0;
};

/// All places between `from` and `to` where `state` changes, as seen by `steps` steps of equal
/// ratio; each halved until the two sides are neighbouring doubles.
/// @param from, to  positive
std::vector<SwitchPoint> find_switches(double from, double to, int steps,
                                       const std::function<long(double)>& state);

/// Compares plane albedo and, but for rough boundaries, reflection at one incidence with photons.
void compare_with_photons(const Case& is, const rte::Stack& stack,
                          const rte::Directions& directions, int photons);

/// @param fast  leave out what takes longest: photons, many nodes, sharp peaks
using SuiteFunction = void(Log& log, bool fast);

SuiteFunction spheres, ensembles, half_spaces, coats, boundaries, surfaces, materials, photons,
    sphere_switches, transfer_switches;
/// Random scenes: no converged result misses its tolerance.
SuiteFunction promises;

struct Suite {
    const char* name;
    SuiteFunction* run;
};
inline constexpr Suite kSuites[] = {{"spheres", spheres},
                                    {"ensembles", ensembles},
                                    {"half-spaces", half_spaces},
                                    {"coats", coats},
                                    {"boundaries", boundaries},
                                    {"surfaces", surfaces},
                                    {"materials", materials},
                                    {"photons", photons},
                                    {"sphere switches", sphere_switches},
                                    {"transfer switches", transfer_switches},
                                    {"promises", promises}};

/// Markdown: checks and failures by suite, then each failure.
std::string tally(const std::vector<Check>& checks);

}  // namespace miebrdf::stress
