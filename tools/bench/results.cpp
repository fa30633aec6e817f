#include "tools/bench/results.h"

#include <fmt/chrono.h>
#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <ctime>
#include <fstream>
#include <limits>
#include <thread>
#include <tuple>

#include <miebrdf/error.h>
#include <miebrdf/processor_path.h>
#include <miebrdf/version.h>
#include "materials/readers/text.h"
#include "pipeline/io/table.h"

namespace miebrdf::bench {
namespace {

const std::vector<std::string> kColumns = {"suite",   "case",   "method", "parameter", "error",
                                           "seconds", "memory", "spread", "half_width"};
// Smaller changes than this are not worth a line, whatever the spread says.
constexpr double kNotable = 0.10;
constexpr double kRounding = 1e-13;

double number(const std::string& field) {
    return field.empty() ? std::numeric_limits<double>::quiet_NaN() : std::stod(field);
}

std::string processor_name() {
    std::ifstream info("/proc/cpuinfo");
    for (std::string line; std::getline(info, line);) {
        if (line.rfind("model name", 0) == 0) return line.substr(line.find(':') + 2);
    }
    return "unknown processor";
}

auto key_of(const Measurement& m) { return std::tie(m.suite, m.test_case, m.method, m.parameter); }

std::string verdict_of(const Change& c) {
    std::string verdict;
    const auto say = [&](const char* word) {
        verdict += (verdict.empty() ? "" : "; ") + std::string(word);
    };
    const double noise = std::max({kNotable, c.before.spread, c.after.spread});
    if (c.time_ratio < 1 / (1 + noise)) say("faster");
    if (c.time_ratio > 1 + noise) say("slower");
    if (std::max(c.before.error, c.after.error) > kRounding) {
        if (c.error_ratio < 1 / (1 + kNotable)) say("better");
        if (c.error_ratio > 1 + kNotable) say("worse");
    }
    if (std::isnan(c.after.error) && !std::isnan(c.before.error)) say("worse");
    if (!std::isnan(c.after.error) && std::isnan(c.before.error)) say("better");
    return verdict.empty() ? "same" : verdict;
}

}  // namespace

void write_results(const Results& results, std::ostream& out) {
    Table table;
    table.facts.assign(results.facts.begin(), results.facts.end());
    table.columns = kColumns;
    for (const Measurement& m : results.measurements) {
        table.rows.push_back({m.suite, m.test_case, m.method, m.parameter, m.error, m.seconds,
                              m.memory, m.spread, m.half_width});
    }
    write_csv(table, out);
}

Results read_results(const std::filesystem::path& path) {
    std::ifstream file(path);
    if (!file) throw InputError(fmt::format("cannot read {}", path.string()));
    Results results;
    std::size_t columns = 0;  // 0: header not seen yet
    for (std::string line; std::getline(file, line);) {
        if (line.starts_with("# ")) {
            const auto colon = line.find(": ");
            if (colon != std::string::npos)
                results.facts.emplace_back(line.substr(2, colon - 2), line.substr(colon + 2));
            continue;
        }
        auto f = materials::split_fields(line);
        if (columns == 0) {
            columns = f.size();
            const bool fits = columns + 1 >= kColumns.size() && columns <= kColumns.size() &&
                              std::equal(f.begin(), f.end(), kColumns.begin());
            if (fits) continue;
            throw InputError(fmt::format("{}: columns '{}' are not those of a results.csv",
                                         path.string(), line));
        }
        if (f.size() != columns)
            throw InputError(fmt::format("{}: {} fields in '{}'", path.string(), f.size(), line));
        f.resize(kColumns.size());  // the last one is missing in files of earlier versions
        results.measurements.push_back({f[0], f[1], f[2], f[3], number(f[4]), number(f[5]),
                                        number(f[6]), number(f[7]), number(f[8])});
    }
    if (columns == 0) throw InputError(fmt::format("{}: no table in it", path.string()));
    return results;
}

std::vector<std::pair<std::string, std::string>> machine_facts() {
#ifdef __OPTIMIZE__
    const char* build = "optimised";
#else
    const char* build = "not optimised";
#endif
#ifdef __clang__
    const char* compiler = "";  // its version string begins with its name
#else
    const char* compiler = "g++ ";
#endif
    return {{"version", fmt::format("miebrdf {}", kVersion)},
            {"processor", fmt::format("{}, {} hardware threads, 1 used", processor_name(),
                                      std::thread::hardware_concurrency())},
            {"compiler", fmt::format("{}{}, {} build, path {}", compiler, __VERSION__, build,
                                     processor_path())},
            {"date", fmt::format("{:%Y-%m-%d}", fmt::gmtime(std::time(nullptr)))},
            {"units",
             "error: largest relative error; seconds: CPU time; memory: bytes; half_width: of the "
             "95 % confidence interval of methods that use chance, measured like error"}};
}

std::vector<std::size_t> pareto_front(const std::vector<Measurement>& points) {
    std::vector<std::size_t> order;
    for (std::size_t i = 0; i < points.size(); ++i) {
        if (std::isfinite(points[i].error)) order.push_back(i);
    }
    std::stable_sort(order.begin(), order.end(), [&](std::size_t a, std::size_t b) {
        return std::tie(points[a].seconds, points[a].error) <
               std::tie(points[b].seconds, points[b].error);
    });
    std::vector<std::size_t> front;
    double best = std::numeric_limits<double>::infinity();
    for (const std::size_t i : order) {
        if (points[i].error < best) {
            best = points[i].error;
            front.push_back(i);
        }
    }
    return front;
}

const Measurement* best_for(const std::vector<Measurement>& points, double error) {
    const Measurement* best = nullptr;
    for (const Measurement& m : points) {
        if (m.error <= error && (best == nullptr || m.seconds < best->seconds)) best = &m;
    }
    return best;
}

std::vector<Measurement> of_case(const Results& results, const std::string& suite,
                                 const std::string& test_case) {
    std::vector<Measurement> points;
    for (const Measurement& m : results.measurements) {
        if (m.suite == suite && m.test_case == test_case) points.push_back(m);
    }
    return points;
}

std::vector<std::pair<std::string, std::string>> cases_of(const Results& results) {
    std::vector<std::pair<std::string, std::string>> cases;
    for (const Measurement& m : results.measurements) {
        const std::pair<std::string, std::string> one{m.suite, m.test_case};
        if (std::find(cases.begin(), cases.end(), one) == cases.end()) cases.push_back(one);
    }
    return cases;
}

std::string description_of(const Results& results, const std::string& suite,
                           const std::string& name) {
    const std::string wanted = fmt::format("case {}/{}", suite, name);
    for (const auto& [fact, value] : results.facts) {
        if (fact == wanted) return value;
    }
    return {};
}

std::string time_text(double seconds) {
    if (seconds < 1e-3) return fmt::format("{:.3g} us", 1e6 * seconds);
    if (seconds < 1) return fmt::format("{:.3g} ms", 1e3 * seconds);
    return fmt::format("{:.3g} s", seconds);
}

std::vector<Change> compare(const Results& before, const Results& after) {
    std::vector<Change> changes;
    for (const Measurement& now : after.measurements) {
        for (const Measurement& then : before.measurements) {
            if (key_of(now) != key_of(then)) continue;
            Change change{then, now, now.seconds / then.seconds, now.error / then.error, {}};
            change.verdict = verdict_of(change);
            changes.push_back(std::move(change));
            break;
        }
    }
    return changes;
}

void write_comparison(const std::vector<Change>& changes, std::ostream& out) {
    Table table;
    table.columns = {"suite",         "case",         "method",      "parameter", "seconds_before",
                     "seconds_after", "error_before", "error_after", "verdict"};
    for (const Change& c : changes) {
        table.rows.push_back({c.after.suite, c.after.test_case, c.after.method, c.after.parameter,
                              c.before.seconds, c.after.seconds, c.before.error, c.after.error,
                              c.verdict});
    }
    write_csv(table, out);
}

bool is_about_rules(const std::string& suite) { return suite == "rules"; }

std::vector<std::vector<std::string>> rule_table(const Results& results) {
    std::vector<std::vector<std::string>> rows{
        {"rule", "computed both ways", "full", "reduced", "times cheaper", "largest difference"}};
    for (const auto& [suite, rule] : cases_of(results)) {
        if (!is_about_rules(suite)) continue;
        Measurement full, reduced;
        for (const Measurement& m : of_case(results, suite, rule))
            (m.method == "full" ? full : reduced) = m;
        const std::string compared = description_of(results, suite, rule);
        rows.push_back({rule, compared.substr(0, compared.find(" Truth: ")),
                        time_text(full.seconds), time_text(reduced.seconds),
                        fmt::format("{:.3g}", full.seconds / reduced.seconds),
                        fmt::format("{:.1e}", reduced.error)});
    }
    return rows;
}

}  // namespace miebrdf::bench
