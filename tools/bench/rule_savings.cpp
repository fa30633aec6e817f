#include "tools/bench/rule_savings.h"

#include <fmt/format.h>

#include "tools/bench/report_page.h"

namespace miebrdf::bench {

bool is_about_rules(const std::string& suite) { return suite == "rules"; }

std::vector<RuleSaving> rule_savings(const Results& results) {
    std::vector<RuleSaving> savings;
    for (const auto& [suite, rule] : cases_of(results)) {
        if (!is_about_rules(suite)) continue;
        RuleSaving saving{rule, description_of(results, suite, rule)};
        saving.compared = saving.compared.substr(0, saving.compared.find(" Truth: "));
        for (const Measurement& m : of_case(results, suite, rule)) {
            if (m.method == "full") saving.full_seconds = m.seconds;
            if (m.method == "reduced") {
                saving.reduced_seconds = m.seconds;
                saving.difference = m.error;
            }
        }
        savings.push_back(std::move(saving));
    }
    return savings;
}

std::vector<std::vector<std::string>> rule_table(const Results& results) {
    std::vector<std::vector<std::string>> rows{
        {"rule", "computed both ways", "full", "reduced", "times cheaper", "largest difference"}};
    for (const RuleSaving& s : rule_savings(results)) {
        rows.push_back({s.rule, s.compared, time_text(s.full_seconds), time_text(s.reduced_seconds),
                        fmt::format("{:.3g}", s.ratio()), fmt::format("{:.1e}", s.difference)});
    }
    return rows;
}

}  // namespace miebrdf::bench
