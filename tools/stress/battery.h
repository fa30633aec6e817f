// The stress battery: stiff and extreme cases, each with a bound that has a cause.
#pragma once

#include <functional>
#include <string>
#include <vector>

namespace miebrdf::stress {

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

/// Collects the checks of one suite.
class Log {
  public:
    Log(std::string suite, std::vector<Check>& checks)
        : suite_(std::move(suite)), checks_(checks) {}

    /// value <= bound must hold.
    void at_most(const std::string& test_case, const std::string& quantity, double value,
                 double bound, const std::string& cause);

    /// `action` must throw std::exception: 0 if it does, 1 if it returns something.
    void refused(const std::string& test_case, const std::function<void()>& action);

    /// `action` fills in checks; if it throws, that itself is a failed check.
    void run(const std::string& test_case, const std::function<void()>& action);

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

struct Options {
    bool fast = false;  ///< leave out what takes longest: photons, many nodes, sharp peaks
};

void spheres(const Options& options, std::vector<Check>& checks);
void ensembles(const Options& options, std::vector<Check>& checks);
void half_spaces(const Options& options, std::vector<Check>& checks);
void coats(const Options& options, std::vector<Check>& checks);
void boundaries(const Options& options, std::vector<Check>& checks);
void surfaces(const Options& options, std::vector<Check>& checks);
void materials(const Options& options, std::vector<Check>& checks);
void refusals(const Options& options, std::vector<Check>& checks);
void photons(const Options& options, std::vector<Check>& checks);
void sphere_switches(const Options& options, std::vector<Check>& checks);
void transfer_switches(const Options& options, std::vector<Check>& checks);
/// Random scenes: no converged result misses its tolerance.
void promises(const Options& options, std::vector<Check>& checks);

/// Everything, suite by suite.
/// @param watch  called with the name of each suite before it is run
std::vector<Check> run_battery(const Options& options,
                               const std::function<void(const std::string&)>& watch = {});

/// Markdown: checks and failures by suite, then each failure.
std::string tally(const std::vector<Check>& checks);

}  // namespace miebrdf::stress
