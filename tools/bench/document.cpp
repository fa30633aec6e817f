#include "tools/bench/document.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <fstream>
#include <iterator>

#include <miebrdf/error.h>
#include "pipeline/io/atomic_file.h"
#include "tools/bench/curve_plot.h"
#include "tools/bench/report_page.h"
#include "tools/bench/rule_savings.h"

namespace miebrdf::bench {
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

// Best error each method reached in a case, with the knob and the time it took.
std::string error_table(const Results& results, const std::string& suite, const std::string& name) {
    const auto points = of_case(results, suite, name);
    std::string text = "| method | smallest error | at | CPU time |\n|---|---|---|---|\n";
    std::vector<std::string> done;
    for (const Measurement& p : points) {
        if (std::find(done.begin(), done.end(), p.method) != done.end()) continue;
        done.push_back(p.method);
        const Measurement* best = nullptr;
        for (const Measurement& q : points) {
            if (q.method != p.method || !std::isfinite(q.error)) continue;
            if (best == nullptr || q.error < best->error) best = &q;
        }
        text += best == nullptr ? fmt::format("| {} | no answer | | |\n", p.method)
                                : fmt::format("| {} | {:.1e} | {} | {:.2g} s |\n", p.method,
                                              best->error, best->parameter, best->seconds);
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
            accuracy += fmt::format("### {}\n\n", suite);
            index = 0;
        }
        suite_before = suite;
        const std::string plot = plot_name(index++, suite);
        write_text(folder / "plots" / plot,
                   curve_plot_svg(suite + ": " + name, of_case(results, suite, name), styles));
        performance += fmt::format("![{} {}](plots/{})\n\n", suite, name, plot);
        accuracy += fmt::format("**{}.** {}\n\n{}\n", name, description_of(results, suite, name),
                                error_table(results, suite, name));
    }
    if (!rule_savings(results).empty())
        performance += fmt::format("### rules\n\n{}\n", rule_markdown(results));
    update_document(folder / "accuracy.md", "bench", accuracy);
    update_document(folder / "performance.md", "bench", performance);
}

}  // namespace miebrdf::bench
