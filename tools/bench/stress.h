// The stress battery: stiff and extreme cases, each with a bound that has a cause.
#pragma once

#include <functional>
#include <string>
#include <vector>

namespace miebrdf::bench {

/// One checked number.
struct StressCheck {
    std::string suite;
    std::string test_case;
    std::string quantity;
    double value = 0.0;
    double bound = 0.0;
    std::string cause;                          ///< why the bound is what it is
    bool ok() const { return value <= bound; }  // not-a-number is not ok
};

/// Collects the checks of one suite.
class StressLog {
  public:
    StressLog(std::string suite, std::vector<StressCheck>& checks)
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
    std::vector<StressCheck>& checks_;
};

/// How far `value` is outside [low, high]; NaN stays NaN.
double outside(double value, double low, double high);

/// Largest of |a - b| / max(|a|, |b|); 0 where both are 0.
double relative_difference(double a, double b);

struct StressOptions {
    bool fast = false;  ///< leave out what takes longest: photons, many nodes, sharp peaks
};

void stress_spheres(const StressOptions& options, std::vector<StressCheck>& checks);
void stress_ensembles(const StressOptions& options, std::vector<StressCheck>& checks);
void stress_half_spaces(const StressOptions& options, std::vector<StressCheck>& checks);
void stress_coats(const StressOptions& options, std::vector<StressCheck>& checks);
void stress_surfaces(const StressOptions& options, std::vector<StressCheck>& checks);
void stress_materials(const StressOptions& options, std::vector<StressCheck>& checks);
void stress_refusals(const StressOptions& options, std::vector<StressCheck>& checks);
void stress_sphere_switches(const StressOptions& options, std::vector<StressCheck>& checks);
void stress_transfer_switches(const StressOptions& options, std::vector<StressCheck>& checks);
void stress_photons(const StressOptions& options, std::vector<StressCheck>& checks);

/// Everything, suite by suite.
/// @param watch  called with the name of each suite before it is run
std::vector<StressCheck> stress_battery(const StressOptions& options,
                                        const std::function<void(const std::string&)>& watch = {});

/// Markdown: checks and failures by suite, then each failure.
std::string stress_tally(const std::vector<StressCheck>& checks);

}  // namespace miebrdf::bench
