// Error and run time of one method at one setting of its knob, measured side by side with others.
#pragma once

#include <fmt/format.h>

#include <cmath>
#include <functional>
#include <initializer_list>
#include <limits>
#include <string>
#include <utility>
#include <vector>

namespace miebrdf::bench {

/// One point of an error-time curve; also one row of results.csv.
struct Measurement {
    std::string suite;
    std::string test_case;
    std::string method;
    std::string parameter;  ///< the knob as text, e.g. "n=16"
    double error = 0.0;     ///< largest relative error of the case's quantities; NaN: no answer
    double seconds = 0.0;   ///< median CPU time of one run
    double memory = 0.0;    ///< growth of the peak resident memory in bytes; NaN: not known
    double spread = 0.0;    ///< (slowest - fastest) / median of the repeats
    /// Largest 95 % confidence half-width of the quantities, measured like `error`; NaN for methods
    /// without chance.
    double half_width = std::numeric_limits<double>::quiet_NaN();
};

/// The answer of a method.
struct Answer {
    std::vector<double> values;
    std::vector<double>
        half_widths;  ///< of their 95 % confidence intervals; empty: no chance in it
    /// CPU time as another process has measured it; 0: that of this one; NaN: no answer, no point.
    double seconds = 0.0;

    Answer() = default;
    // Most methods have nothing but values.
    Answer(std::vector<double> v) : values(std::move(v)) {}  // NOLINT(google-explicit-constructor)

    /// Adds an estimate whose standard error is known.
    void add(double value, double standard_error) {
        values.push_back(value);
        half_widths.push_back(1.96 * standard_error);
    }
};

/// A method at one setting. `run` computes the case and returns its numbers; it is what is timed.
struct Contender {
    std::string method;
    std::string parameter;
    std::function<Answer()> run;
};

/// The largest of `of` over a list, at least 0; NaN if one of them is.
template <typename List, typename Of>
double worst(const List& list, const Of& of) {
    double largest = 0;
    for (const auto& one : list) {
        const double value = of(one);
        if (!(value <= largest)) largest = value;
        if (std::isnan(largest)) break;
    }
    return largest;
}

/// The distance of an answer from the truth: largest |value / truth - 1|; absolute where truth is
/// 0. Infinite for answers of another length, NaN for a value that is none.
double largest_relative_error(const std::vector<double>& values, const std::vector<double>& truth);

/// Largest error relative to the largest true value of its block: what a tolerance promises where a
/// block holds the values at one incidence. NaN for lists of two lengths, or a value that is none.
double largest_error_in_blocks(const std::vector<double>& values, const std::vector<double>& truth,
                               std::size_t block);

/// A quantity, its truth from outside, and everyone who computes it.
struct BenchCase {
    std::string suite;
    std::string name;
    std::string quantity;  ///< one sentence: what is computed
    std::string truth;     ///< where the truth comes from and how many digits it has
    std::vector<double> true_values = {};
    std::vector<Contender> contenders = {};
    std::string question = {};  ///< to other programs (peers.h); empty: they are not asked
    /// The measure of an answer's error; empty: largest_relative_error.
    std::function<double(const std::vector<double>&, const std::vector<double>&)> error = {};

    void add(std::string method, std::string parameter, std::function<Answer()> run) {
        contenders.push_back({std::move(method), std::move(parameter), std::move(run)});
    }
    /// One contender for each setting of a knob.
    /// @param knob  format of the setting, e.g. "n={}"
    /// @param run   called with the setting
    template <typename Setting, typename Run>
    void add_each(const std::string& method, fmt::format_string<const Setting&> knob,
                  std::initializer_list<Setting> settings, const Run& run) {
        for (const Setting& s : settings)
            add(method, fmt::format(knob, s), [run, s] { return run(s); });
    }
};

struct MeasureOptions {
    int repeats = 5;                ///< rounds over all contenders, at least 1
    double shortest_sample = 2e-3;  ///< s; quicker runs are repeated inside one sample
    double longest_total = 4.0;     ///< s per contender: slow ones are repeated less; those slower
                                    ///< than this are timed once, while their memory is watched
};

/// Runs every contender of a case: once to warm up and for its error, once for its memory, then in
/// rounds in which all take turns, so that a machine that becomes slower affects all alike.
/// Time is the CPU time of the process: other programs on the machine do not count.
std::vector<Measurement> measure(const BenchCase& bench_case, const MeasureOptions& options = {});

/// CPU time of this process in seconds.
double cpu_seconds();

/// Returns free memory to the system and starts the peak of resident memory anew, and the peak
/// since then; both in bytes. The kernel counts in batches: good to some hundred KiB. Linux; NaN
/// elsewhere.
double reset_peak_memory();
double peak_memory();

}  // namespace miebrdf::bench
