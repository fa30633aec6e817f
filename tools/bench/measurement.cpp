#include "tools/bench/measurement.h"

#include <malloc.h>
#include <time.h>

#include <algorithm>
#include <cmath>
#include <fstream>
#include <limits>
#include <span>

namespace miebrdf::bench {
namespace {

double field_of_status(const std::string& name) {
    std::ifstream status("/proc/self/status");
    for (std::string word; status >> word;) {
        double kilobytes = 0;
        if (word == name && status >> kilobytes) return kilobytes * 1024;
    }
    return std::numeric_limits<double>::quiet_NaN();
}

double median(std::vector<double> values) {
    std::sort(values.begin(), values.end());
    const std::size_t n = values.size();
    return n % 2 == 1 ? values[n / 2] : (values[n / 2 - 1] + values[n / 2]) / 2;
}

// One contender on its way through the rounds.
struct Running {
    const Contender* contender;
    int loops = 1;  // runs in one sample
    int rounds = 1;
    std::vector<double> samples = {};

    void take_sample() {
        const double start = cpu_seconds();
        double elsewhere = 0.0;
        for (int i = 0; i < loops; ++i) elsewhere += contender->run().seconds;
        samples.push_back((elsewhere != 0.0 ? elsewhere : cpu_seconds() - start) / loops);
    }
};

// A run of its own: the first one also brings in code and tables that are there to stay.
double memory_of(const Contender& contender) {
    const double before = reset_peak_memory();
    contender.run();
    const double growth = peak_memory() - before;
    return growth < 0 ? 0.0 : growth;
}

std::vector<double> at_ends(std::vector<double> values, const std::vector<double>& half_widths) {
    for (std::size_t i = 0; i < std::min(values.size(), half_widths.size()); ++i)
        values[i] += half_widths[i];
    return values;
}

}  // namespace

double cpu_seconds() {
    timespec t{};
    clock_gettime(CLOCK_PROCESS_CPUTIME_ID, &t);
    return static_cast<double>(t.tv_sec) + 1e-9 * static_cast<double>(t.tv_nsec);
}

double reset_peak_memory() {
    malloc_trim(0);
    std::ofstream("/proc/self/clear_refs") << "5";
    return field_of_status("VmHWM:");
}

double peak_memory() { return field_of_status("VmHWM:"); }

double largest_relative_error(const std::vector<double>& values, const std::vector<double>& truth) {
    if (values.empty()) return std::numeric_limits<double>::quiet_NaN();
    if (values.size() != truth.size()) return std::numeric_limits<double>::infinity();
    auto value = values.begin();
    return worst(truth,
                 [&](double t) { return std::abs(*value++ - t) / (t != 0 ? std::abs(t) : 1.0); });
}

double largest_error_in_blocks(const std::vector<double>& values, const std::vector<double>& truth,
                               std::size_t block) {
    if (values.size() != truth.size()) return std::numeric_limits<double>::quiet_NaN();
    double largest = 0, scale = 0;
    for (std::size_t i = 0; i < truth.size(); ++i) {
        if (i % block == 0)
            scale = worst(std::span(truth).subspan(i, block), [](double t) { return std::abs(t); });
        const double error = scale == 0 ? 0.0 : std::abs(values[i] - truth[i]) / scale;
        if (!(error <= largest)) largest = error;
        if (std::isnan(largest)) break;
    }
    return largest;
}

std::vector<Measurement> measure(const BenchCase& bench_case, const MeasureOptions& options) {
    std::vector<Measurement> results;
    std::vector<Running> running;
    const auto judge = bench_case.error ? bench_case.error : largest_relative_error;
    for (const Contender& contender : bench_case.contenders) {
        Measurement m{bench_case.suite, bench_case.name, contender.method, contender.parameter};
        const double start = cpu_seconds();
        const Answer answer = contender.run();
        if (std::isnan(answer.seconds)) continue;  // a peer that has failed
        const bool is_here = answer.seconds == 0.0;
        const double once = std::max(is_here ? cpu_seconds() - start : answer.seconds, 1e-9);
        m.error = judge(answer.values, bench_case.true_values);
        if (!answer.half_widths.empty()) {
            m.half_width =
                judge(at_ends(bench_case.true_values, answer.half_widths), bench_case.true_values);
        }
        const double again = cpu_seconds();
        m.memory = is_here ? memory_of(contender) : std::numeric_limits<double>::quiet_NaN();
        Running r{&contender};
        if (is_here) r.loops = std::clamp(int(options.shortest_sample / once), 1, 100000);
        r.rounds = std::clamp(static_cast<int>(options.longest_total / (once * r.loops)), 1,
                              std::max(1, options.repeats));
        if (once >= options.longest_total) {  // too slow for a third run
            r.rounds = 0;
            r.samples = {is_here ? cpu_seconds() - again : answer.seconds};
        }
        running.push_back(std::move(r));
        results.push_back(std::move(m));
    }
    for (int round = 0; round < options.repeats; ++round) {
        for (Running& r : running) {
            if (round < r.rounds) r.take_sample();
        }
    }
    for (std::size_t i = 0; i < results.size(); ++i) {
        const auto [low, high] =
            std::minmax_element(running[i].samples.begin(), running[i].samples.end());
        results[i].seconds = median(running[i].samples);
        results[i].spread = (*high - *low) / results[i].seconds;
    }
    return results;
}

}  // namespace miebrdf::bench
