// What the rules of `plan` save: the table of the suite "rules", which has no curves.
#pragma once

#include <string>
#include <vector>

#include "tools/bench/results.h"

namespace miebrdf::bench {

/// Whether a suite compares requests with and without a rule, not methods with a truth.
bool is_about_rules(const std::string& suite);

/// One rule: the same quantity from the full and from the reduced request.
struct RuleSaving {
    std::string rule;
    std::string compared;          ///< what was computed both ways
    double full_seconds = 0.0;     ///< median CPU time
    double reduced_seconds = 0.0;  ///< median CPU time
    double difference = 0.0;       ///< largest relative one of the values
    double ratio() const { return full_seconds / reduced_seconds; }
};

/// All rules that were measured, in order.
std::vector<RuleSaving> rule_savings(const Results& results);

/// The same as rows of text: a head, then one row for each rule.
std::vector<std::vector<std::string>> rule_table(const Results& results);

}  // namespace miebrdf::bench
