#include "tools/bench/report.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <fstream>
#include <iterator>
#include <limits>

#include <miebrdf/error.h>
#include "pipeline/io/atomic_file.h"
#include "pipeline/io/markup.h"
#include "tools/bench/curve_plot.h"

namespace miebrdf::bench {
namespace {

constexpr char kHead[] = R"(<!DOCTYPE html>
<html lang="en"><head><meta charset="utf-8"><title>miebrdf: error against run time</title>
<link rel="icon" href="data:,">
<style>
body{font:15px/1.45 Helvetica,Arial,sans-serif;color:#222;max-width:960px;margin:2em auto;padding:0 1em}
h1{margin-bottom:.2em}h2{margin-top:2.2em;border-bottom:1px solid #ccc}h3{margin:1.6em 0 .3em}
table{border-collapse:collapse;margin:.6em 0;font-size:13px}td,th{padding:3px 9px;text-align:left;border-bottom:1px solid #e4e4e4}
svg{max-width:100%;height:auto;border:1px solid #e4e4e4}.legend{cursor:pointer}.off{opacity:.12}
.faint{color:#777}.faster,.better{color:#00734f}.slower,.worse{color:#b34700}nav a{margin-right:1em}
</style></head><body>
)";

constexpr char kScript[] = R"(<script>
// Click a legend entry to hide or show its curve; move over it to bring it out.
for (const entry of document.querySelectorAll('svg .legend')) {
  const svg = entry.ownerSVGElement, method = entry.dataset.method;
  const all = [...svg.querySelectorAll('.series')], mine = all.filter(s => s.dataset.method === method);
  entry.addEventListener('click', () => {
    const hide = entry.classList.toggle('off');
    for (const s of mine) s.style.display = hide ? 'none' : '';
  });
  entry.addEventListener('mouseenter', () => all.forEach(s => s.classList.toggle('off', !mine.includes(s))));
  entry.addEventListener('mouseleave', () => all.forEach(s => s.classList.remove('off')));
}
</script>
)";

std::string choice_text(const std::vector<Measurement>& points, double error) {
    const Measurement* best = best_for(points, error);
    return best ? fmt::format("{} {}, {}", best->method, best->parameter, time_text(best->seconds))
                : "none";
}

std::vector<std::string> suites_of(const Results& results) {
    std::vector<std::string> suites;
    for (const auto& [suite, name] : cases_of(results)) {
        if (suites.empty() || suites.back() != suite) suites.push_back(suite);
    }
    return suites;
}

std::string choice_table_html(const Results& results, const std::string& suite) {
    std::string html = "<table class='choice'><tr><th>case</th>";
    for (const double e : wanted_errors()) html += fmt::format("<th>error &le; {:.0e}</th>", e);
    html += "</tr>\n";
    for (const auto& [s, name] : cases_of(results)) {
        if (s != suite) continue;
        const auto points = of_case(results, s, name);
        html += "<tr><td>" + escape_markup(name) + "</td>";
        for (const double e : wanted_errors())
            html += "<td>" + escape_markup(choice_text(points, e)) + "</td>";
        html += "</tr>\n";
    }
    return html + "</table>\n";
}

std::string rules_html(const Results& results) {
    std::string html = "<table class='choice'>";
    const char* cell = "th";
    for (const auto& row : rule_table(results)) {
        html += "<tr>";
        for (const std::string& text : row)
            html += fmt::format("<{0}>{1}</{0}>", cell, escape_markup(text));
        html += "</tr>\n";
        cell = "td";
    }
    return "<p>The same values from a request with all the work, and without what a rule of "
           "<code>plan</code> leaves out.</p>\n" +
           html + "</table>\n";
}

std::string changes_html(const std::vector<Change>& changes) {
    if (changes.empty()) return {};
    std::string rows;
    std::size_t same = 0;
    for (const Change& c : changes) {
        if (c.verdict == "same") {
            ++same;
            continue;
        }
        const std::string first_word = c.verdict.substr(0, c.verdict.find(';'));
        rows += fmt::format(
            "<tr><td>{} / {}</td><td>{} {}</td><td>{} &rarr; {}</td><td>{:.2e} &rarr; "
            "{:.2e}</td><td class='{}'>{}</td></tr>\n",
            escape_markup(c.after.suite), escape_markup(c.after.test_case),
            escape_markup(c.after.method), escape_markup(c.after.parameter),
            time_text(c.before.seconds), time_text(c.after.seconds), c.before.error, c.after.error,
            first_word, c.verdict);
    }
    return fmt::format(
        "<h2 id='changes'>Since the earlier run</h2>\n<p>{} points compared, {} the same within 10 "
        "% and their spread.</p>\n"
        "<table><tr><th>case</th><th>method</th><th>time</th><th>error</th><th></th></tr>\n{}</"
        "table>\n",
        changes.size(), same, rows);
}

std::string facts_html(const Results& results) {
    std::string rows;
    for (const auto& [name, value] : results.facts) {
        if (name.rfind("case ", 0) == 0) continue;
        rows +=
            "<tr><td>" + escape_markup(name) + "</td><td>" + escape_markup(value) + "</td></tr>\n";
    }
    return "<h2>Machine and versions</h2>\n<table>" + rows + "</table>\n";
}

}  // namespace

const std::vector<double>& wanted_errors() {
    static const std::vector<double> errors = {1e-1, 1e-2, 1e-3, 1e-4, 1e-6};
    return errors;
}

std::string report_page(const Results& results, const std::vector<Change>& changes) {
    std::string html = kHead;
    html +=
        "<h1>Error against run time</h1>\n<p>Every point is one method at one setting of its knob. "
        "Lower is more accurate, left is quicker. Rings and the dotted stairs: the Pareto front, "
        "what no other point beats in both. Whiskers: the 95 % confidence interval of methods that "
        "use "
        "chance. Click a method to hide it.</p>\n<nav>";
    for (const std::string& suite : suites_of(results))
        html += fmt::format("<a href='#{0}'>{0}</a>", suite);
    html += "</nav>\n" + changes_html(changes);
    const MethodStyles styles(results.measurements);
    for (const std::string& suite : suites_of(results)) {
        if (is_about_rules(suite)) {
            html += fmt::format("<h2 id='{0}'>{0}</h2>\n{1}", suite, rules_html(results));
            continue;
        }
        html += fmt::format("<h2 id='{0}'>{0}</h2>\n<p>What to choose:</p>\n{1}", suite,
                            choice_table_html(results, suite));
        for (const auto& [s, name] : cases_of(results)) {
            if (s != suite) continue;
            html += fmt::format(
                "<h3>{}</h3>\n<p class='faint'>{}</p>\n{}", escape_markup(name),
                escape_markup(description_of(results, s, name)),
                curve_plot_svg(fmt::format("{}: {}", s, name), of_case(results, s, name), styles));
        }
    }
    return html + facts_html(results) + kScript + "</body></html>\n";
}

std::string choice_table_markdown(const Results& results, const std::string& suite) {
    std::string text = "| case |", line = "|---|";
    for (const double e : wanted_errors()) {
        text += fmt::format(" error <= {:.0e} |", e);
        line += "---|";
    }
    text += "\n" + line + "\n";
    for (const auto& [s, name] : cases_of(results)) {
        if (s != suite) continue;
        const auto points = of_case(results, s, name);
        text += "| " + name + " |";
        for (const double e : wanted_errors()) text += fmt::format(" {} |", choice_text(points, e));
        text += "\n";
    }
    return text;
}

namespace {

void write_text(const std::filesystem::path& path, const std::string& text) {
    AtomicFile file(path);
    file.stream() << text;
    file.commit();
}

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
    bool tried = false;
    double smallest = std::numeric_limits<double>::infinity();
    for (const Measurement& point : points) {
        if (point.method != method) continue;
        tried = true;
        if (std::isfinite(point.error)) smallest = std::min(smallest, point.error);
    }
    if (!tried) return "";
    return std::isfinite(smallest) ? fmt::format("{:.1e}", smallest) : "no answer";
}

// What the cases of a suite are, and the smallest errors: a row for each method, a column for each
// case.
std::string error_table(const Results& results, const std::string& suite) {
    std::string head = "| method |", line = "|---|";
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
        head += " " + name + " |";
        line += "---|";
        cases.push_back(of_case(results, suite, name));
        for (const Measurement& point : cases.back()) {
            if (std::find(methods.begin(), methods.end(), point.method) == methods.end())
                methods.push_back(point.method);
        }
    }
    std::string text;
    for (const auto& [description, names] : explained)
        text += fmt::format("- {}: {}\n", names, description);
    text += fmt::format("\n{}\n{}\n", head, line);
    for (const std::string& method : methods) {
        text += "| " + method + " |";
        for (const auto& points : cases)
            text += fmt::format(" {} |", smallest_error(points, method));
        text += "\n";
    }
    return text;
}

std::string rule_markdown(const Results& results) {
    std::string text;
    bool head = true;
    for (const auto& row : rule_table(results)) {
        text += fmt::format("| {} |\n", fmt::join(row, " | "));
        if (head) text += "|---|---|---|---|---|---|\n";
        head = false;
    }
    return text;
}

std::string plot_name(std::size_t index, const std::string& suite) {
    return fmt::format("{}-{}.svg", suite, index + 1);
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
    const MethodStyles styles(results.measurements);
    std::filesystem::create_directories(folder / "plots");
    std::size_t index = 0;
    for (const auto& [suite, name] : cases_of(results)) {
        if (is_about_rules(suite)) continue;
        if (suite != suite_before) {
            performance +=
                fmt::format("### {}\n\n{}\n", suite, choice_table_markdown(results, suite));
            accuracy += fmt::format("### {}\n\n{}\n", suite, error_table(results, suite));
            index = 0;
        }
        suite_before = suite;
        const std::string plot = plot_name(index++, suite);
        write_text(folder / "plots" / plot,
                   curve_plot_svg(suite + ": " + name, of_case(results, suite, name), styles));
        performance += fmt::format("![{} {}](plots/{})\n\n", suite, name, plot);
    }
    if (!rule_savings(results).empty())
        performance += fmt::format("### rules\n\n{}\n", rule_markdown(results));
    update_document(folder / "accuracy.md", "bench", accuracy);
    update_document(folder / "performance.md", "bench", performance);
}

}  // namespace miebrdf::bench
