#include "tools/bench/report.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <cmath>
#include <fstream>
#include <iterator>
#include <limits>
#include <map>

#include <miebrdf/error.h>
#include "pipeline/io/atomic_file.h"
#include "pipeline/io/markup.h"
#include "pipeline/plot/chart.h"

namespace miebrdf::bench {
namespace {

constexpr char kHead[] = R"(<!DOCTYPE html>
<html lang="en"><head><meta charset="utf-8"><title>miebrdf: error against run time</title>
<style>body{font:15px sans-serif;max-width:960px;margin:2em auto}
td,th{padding:2px 9px;text-align:left;border-bottom:1px solid #ddd}</style></head><body>
)";

// Beyond these points are drawn at the edge; the table has the numbers.
constexpr double kLowestError = 1e-17, kHighestError = 10, kShortestTime = 1e-6;

// The "what to choose" tables answer for these.
constexpr double kWantedErrors[] = {1e-1, 1e-2, 1e-3, 1e-4, 1e-6};

double drawn_error(double error) { return std::clamp(error, kLowestError, kHighestError); }
double drawn_time(const Measurement& m) { return std::max(m.seconds, kShortestTime); }

/// The place of a method among those of its suite: its colour. All suites together have more
/// methods than there are colours and dashes.
int colour_of(const Results& results, const std::string& suite, const std::string& method) {
    std::vector<std::string> methods;
    for (const Measurement& m : results.measurements) {
        if (m.suite != suite) continue;
        if (m.method == method) break;
        if (std::find(methods.begin(), methods.end(), m.method) == methods.end())
            methods.push_back(m.method);
    }
    return static_cast<int>(methods.size());
}

/// "coat 0.9/0.46, depth 1" needs no "coat" before it.
std::string title_of(const std::string& suite, const std::string& test_case) {
    return test_case.rfind(suite, 0) == 0 ? test_case : suite + ": " + test_case;
}

/// Stairs along the points that no other one beats in both error and time.
plot::Curve front_of(const std::vector<Measurement>& points) {
    plot::Curve front{"Pareto front", {}, {}};
    for (const std::size_t i : pareto_front(points)) {
        if (!front.y.empty()) {
            front.x.push_back(drawn_time(points[i]));
            front.y.push_back(front.y.back());
        }
        front.x.push_back(drawn_time(points[i]));
        front.y.push_back(drawn_error(points[i].error));
    }
    return front;
}

/// Who wins, and at which setting; then the program's own points.
std::vector<plot::PointName> names_of(const Results& results,
                                      const std::vector<Measurement>& points) {
    std::vector<plot::PointName> names;
    const auto front = pareto_front(points);
    const auto add = [&](const Measurement& m, const std::string& text) {
        names.push_back(
            {drawn_time(m), drawn_error(m.error), text, colour_of(results, m.suite, m.method)});
    };
    for (const std::size_t i : front) {
        const std::string& setting = points[i].parameter;
        add(points[i], points[i].method + (setting == "-" ? "" : " " + setting));
    }
    for (std::size_t i = 0; i < points.size(); ++i) {
        const bool named = std::find(front.begin(), front.end(), i) != front.end();
        if (points[i].method == "miebrdf" && !named) add(points[i], points[i].parameter);
    }
    return names;
}

using Rows = std::vector<std::vector<std::string>>;

std::string markdown_table(const Rows& rows) {
    std::string text;
    for (const auto& row : rows) {
        text += fmt::format("| {} |\n", fmt::join(row, " | "));
        if (&row != &rows.front()) continue;
        for (std::size_t i = 0; i < row.size(); ++i) text += "|---";
        text += "|\n";
    }
    return text;
}

std::vector<std::string> suites_of(const Results& results) {
    std::vector<std::string> suites;
    for (const auto& [suite, name] : cases_of(results)) {
        if (suites.empty() || suites.back() != suite) suites.push_back(suite);
    }
    return suites;
}

Rows choice_rows(const Results& results, const std::string& suite) {
    Rows rows = {{"case"}};
    for (const double e : kWantedErrors) rows.front().push_back(fmt::format("error <= {:.0e}", e));
    for (const auto& [s, name] : cases_of(results)) {
        if (s != suite) continue;
        const auto points = of_case(results, s, name);
        rows.push_back({name});
        for (const double e : kWantedErrors) {
            const Measurement* best = best_for(points, e);
            rows.back().push_back(best == nullptr
                                      ? "none"
                                      : fmt::format("{} {}, {}", best->method, best->parameter,
                                                    time_text(best->seconds)));
        }
    }
    return rows;
}

Rows point_rows(const std::vector<Measurement>& points) {
    Rows rows = {{"method", "knob", "error", "95 %", "CPU time", "spread", "memory"}};
    for (const Measurement& m : points) {
        rows.push_back({m.method, m.parameter, fmt::format("{:.2e}", m.error),
                        std::isnan(m.half_width) ? "" : fmt::format("+- {:.1e}", m.half_width),
                        time_text(m.seconds), fmt::format("{:.0f} %", 100 * m.spread),
                        fmt::format("{:.3g} MiB", m.memory / 1048576)});
    }
    return rows;
}

std::string changes_html(const std::vector<Change>& changes) {
    if (changes.empty()) return {};
    Rows rows = {{"case", "method", "time", "error", ""}};
    for (const Change& c : changes) {
        if (c.verdict == "same") continue;
        rows.push_back({c.after.suite + " / " + c.after.test_case,
                        c.after.method + " " + c.after.parameter,
                        time_text(c.before.seconds) + " -> " + time_text(c.after.seconds),
                        fmt::format("{:.2e} -> {:.2e}", c.before.error, c.after.error), c.verdict});
    }
    return fmt::format(
        "<h2>Since the earlier run</h2>\n<p>{} points compared, {} the same within 10 % and their "
        "spread.</p>\n{}",
        changes.size(), changes.size() + 1 - rows.size(), html_table(rows));
}

}  // namespace

std::string case_plot(const Results& results, const std::string& suite,
                      const std::string& test_case) {
    std::vector<Measurement> drawn;
    for (const Measurement& m : of_case(results, suite, test_case)) {
        if (std::isfinite(m.error) && m.seconds > 0) drawn.push_back(m);
    }
    if (drawn.empty()) return {};
    plot::Panel panel{{"CPU time of one run (s)", plot::Scale::logarithmic},
                      {"largest relative error", plot::Scale::logarithmic},
                      {},
                      360.0};
    std::map<std::string, std::size_t> curves;
    for (const Measurement& m : drawn) {
        const int colour = colour_of(results, m.suite, m.method);
        const auto [place, is_new] = curves.try_emplace(m.method, panel.curves.size());
        if (is_new) {
            panel.curves.push_back({m.method, {}, {}, plot::Mark::line_and_points});
            panel.curves.back().colour = colour;
        }
        panel.curves[place->second].x.push_back(drawn_time(m));
        panel.curves[place->second].y.push_back(drawn_error(m.error));
    }
    double least = kHighestError;  // bars that reach below 0 end where the points do
    for (const Measurement& m : drawn) least = std::min(least, drawn_error(m.error));
    for (const Measurement& m : drawn) {
        if (std::isnan(m.half_width)) continue;
        plot::Curve bar{"", {drawn_time(m), drawn_time(m)}, {}};
        bar.y = {std::max(least, m.error - m.half_width), drawn_error(m.error + m.half_width)};
        bar.colour = colour_of(results, m.suite, m.method);
        panel.curves.push_back(std::move(bar));
    }
    panel.curves.push_back(front_of(drawn));
    panel.curves.back().shade = 0.0;
    panel.names = names_of(results, drawn);
    constexpr double width = 760.0;
    return plot::draw_chart({panel}, {title_of(suite, test_case), ""}, width).svg;
}

std::string plot_file_name(const std::string& suite, const std::string& test_case) {
    std::string name;
    for (const char c : suite + " " + test_case) {
        const bool plain = std::isalnum(static_cast<unsigned char>(c)) || c == '.';
        if (plain || (!name.empty() && name.back() != '-')) name += plain ? c : '-';
    }
    return name + ".svg";
}

std::string report_page(const Results& results, const std::vector<Change>& changes) {
    std::string html = kHead;
    html +=
        "<h1>Error against run time</h1>\n<p>Every point is one method at one setting of its knob. "
        "Lower is more accurate, left is quicker.</p>\n" +
        changes_html(changes);
    for (const std::string& suite : suites_of(results)) {
        html += fmt::format("<h2>{}</h2>\n", suite);
        if (is_about_rules(suite)) {
            html +=
                "<p>The same values from a request with all the work, and without what a rule "
                "of plan leaves out.</p>\n" +
                html_table(rule_table(results));
            continue;
        }
        html += "<p>What to choose:</p>\n" + html_table(choice_rows(results, suite));
        for (const auto& [s, name] : cases_of(results)) {
            if (s != suite) continue;
            html += fmt::format(
                "<h3>{}</h3>\n<p>{}</p>\n<img src=\"{}\" alt=\"\">\n{}", escape_markup(name),
                escape_markup(description_of(results, s, name)), plot_file_name(s, name),
                html_table(point_rows(of_case(results, s, name))));
        }
    }
    Rows facts = {{"machine and versions", ""}};
    for (const auto& [name, value] : results.facts) {
        if (name.rfind("case ", 0) != 0) facts.push_back({name, value});
    }
    return html + html_table(facts) + "</body></html>\n";
}

void write_text(const std::filesystem::path& path, const std::string& text) {
    AtomicFile file(path);
    file.stream() << text;
    file.commit();
}

namespace {

std::string machine_text(const Results& results) {
    std::string text;
    for (const auto& [name, value] : results.facts) {
        if (name == "processor" || name == "compiler" || name == "version" || name == "date") {
            text += (text.empty() ? "" : "; ") + value;
        }
    }
    return "Measured with " + text + ".\n\n";
}

// The smallest error of a method in a case; empty where it was not tried.
std::string smallest_error(const std::vector<Measurement>& points, const std::string& method) {
    std::string text;
    double smallest = std::numeric_limits<double>::infinity();
    for (const Measurement& point : points) {
        if (point.method != method) continue;
        if (std::isfinite(point.error)) smallest = std::min(smallest, point.error);
        text = std::isfinite(smallest) ? fmt::format("{:.1e}", smallest) : "no answer";
    }
    return text;
}

// Describes the cases of a suite, and gives the smallest errors: a row for each method, a column
// for each case.
std::string error_table(const Results& results, const std::string& suite) {
    Rows rows = {{"method"}};
    std::vector<std::pair<std::string, std::string>> explained;  // description, names that have it
    std::vector<std::vector<Measurement>> cases;
    std::vector<std::string> methods;
    for (const auto& [s, name] : cases_of(results)) {
        if (s != suite) continue;
        const std::string description = description_of(results, suite, name);
        const auto same = std::find_if(explained.begin(), explained.end(),
                                       [&](const auto& e) { return e.first == description; });
        if (same == explained.end()) {
            explained.emplace_back(description, "**" + name + "**");
        } else {
            same->second += "; **" + name + "**";
        }
        rows.front().push_back(name);
        cases.push_back(of_case(results, suite, name));
        for (const Measurement& point : cases.back()) {
            if (std::find(methods.begin(), methods.end(), point.method) == methods.end())
                methods.push_back(point.method);
        }
    }
    std::string text;
    for (const auto& [description, names] : explained)
        text += fmt::format("- {}: {}\n", names, description);
    for (const std::string& method : methods) {
        rows.push_back({method});
        for (const auto& points : cases) rows.back().push_back(smallest_error(points, method));
    }
    return text + "\n" + markdown_table(rows);
}

}  // namespace

std::string with_generated_part(const std::string& page, const std::string& name,
                                const std::string& text) {
    const std::string open = "<!-- generated " + name + " -->\n",
                      close = "<!-- end " + name + " -->";
    const auto from = page.find(open);
    const auto to = page.find(close);
    if (from == std::string::npos || to == std::string::npos || to < from) {
        throw InputError(fmt::format(
            "the marks '<!-- generated {0} -->' and '<!-- end {0} -->' are not there", name));
    }
    return page.substr(0, from + open.size()) + text + page.substr(to);
}

void update_document(const std::filesystem::path& path, const std::string& name,
                     const std::string& text) {
    std::ifstream file(path, std::ios::binary);
    if (!file) throw InputError(fmt::format("cannot read {}", path.string()));
    const std::string page{std::istreambuf_iterator<char>(file), {}};
    file.close();
    write_text(path, with_generated_part(page, name, text));
}

void update_bench_documents(const std::filesystem::path& folder, const Results& results) {
    std::string accuracy = machine_text(results), performance = accuracy, suite_before;
    std::filesystem::create_directories(folder / "plots");
    std::size_t index = 0;
    for (const auto& [suite, name] : cases_of(results)) {
        if (is_about_rules(suite)) continue;
        if (suite != suite_before) {
            performance +=
                fmt::format("### {}\n\n{}\n", suite, markdown_table(choice_rows(results, suite)));
            accuracy += fmt::format("### {}\n\n{}\n", suite, error_table(results, suite));
            index = 0;
        }
        suite_before = suite;
        const std::string plot = fmt::format("{}-{}.svg", suite, ++index);
        write_text(folder / "plots" / plot, case_plot(results, suite, name));
        performance += fmt::format("![{}](plots/{})\n\n", title_of(suite, name), plot);
    }
    const Rows rules = rule_table(results);
    if (rules.size() > 1) performance += fmt::format("### rules\n\n{}\n", markdown_table(rules));
    update_document(folder / "accuracy.md", "bench", accuracy);
    update_document(folder / "performance.md", "bench", performance);
}

}  // namespace miebrdf::bench
