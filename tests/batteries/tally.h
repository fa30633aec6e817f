// Errors of values in tolerances and over what was stated, and the line that tells them.
#pragma once

#include <algorithm>
#include <cstddef>
#include <cstdio>
#include <cstdlib>
#include <ctime>
#include <string>
#include <vector>

namespace miebrdf::constants {

class Tally {
  public:
    /// Values whose truth is too noisy to tell are left out.
    void add(double error, double noise, double stated, double tolerance) {
        if (2 * noise > std::max(stated, tolerance)) return;
        in_tolerances_.push_back(error / tolerance);
        of_stated_.push_back(error / std::max(stated, 1e-300));
        if (stated <= tolerance && !(error <= 1.5 * tolerance)) ++missed_;
    }
    void print(const char* part, double seconds) {
        const auto count = double(of_stated_.size());
        const auto above = [&](double times) {
            return 100 *
                   double(std::count_if(of_stated_.begin(), of_stated_.end(),
                                        [&](double v) { return !(v <= times); })) /
                   count;
        };
        std::sort(in_tolerances_.begin(), in_tolerances_.end());
        const double high = in_tolerances_[std::size_t(0.99 * (count - 1))];
        std::printf("%s,%g,%.3g,%.3g,%.2f,%.2f,%.3g,%d,%.3f\n", part, count,
                    in_tolerances_[std::size_t(0.5 * (count - 1))], high, above(1), above(3),
                    *std::max_element(of_stated_.begin(), of_stated_.end()), missed_, seconds);
    }

  private:
    std::vector<double> in_tolerances_, of_stated_;
    int missed_ = 0;  // 1.5 tolerances, where the tolerance or less is stated
};

/// MIEBRDF_SEED in the environment: other random cases than those of seed 0.
inline unsigned seed_of_run() {
    const char* const text = std::getenv("MIEBRDF_SEED");
    return unsigned(text != nullptr ? std::atoi(text) : 0);
}

inline void print_header() {
    std::puts(
        "part,values,median_in_tolerances,p99_in_tolerances,percent_beyond_stated,"
        "percent_beyond_3_stated,worst_over_stated,beyond_1.5_while_converged,seconds");
}

/// Runs a part, which fills the tally, and prints its line.
template <typename Part>
void measure(const std::string& name, const Part& part) {
    Tally tally;
    const auto began = std::clock();
    part(tally);
    tally.print(name.c_str(), double(std::clock() - began) / CLOCKS_PER_SEC);
}

/// Whether a part is among those on the command line after the program and the file of the truth;
/// all are where none is named.
inline bool is_wanted(const std::string& part, int count, char** arguments) {
    return count == 2 || std::find(arguments + 2, arguments + count, part) != arguments + count;
}

}  // namespace miebrdf::constants
