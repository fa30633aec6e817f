// The measurements: the table, its file, the best of it, and what changed since another time.
#pragma once

#include <filesystem>
#include <iosfwd>
#include <string>
#include <utility>
#include <vector>

#include "tools/bench/measurement.h"

namespace miebrdf::bench {

struct Results {
    std::vector<std::pair<std::string, std::string>> facts;  ///< machine, versions, command
    std::vector<Measurement> measurements;
};

/// `# fact: value` lines, then suite,case,method,parameter,error,seconds,memory,spread,half_width.
void write_results(const Results& results, std::ostream& out);

/// Reads what write_results wrote; half_width may be missing, as in files of earlier versions.
/// @throws miebrdf::InputError  for a file that is missing or has other columns
Results read_results(const std::filesystem::path& path);

/// Processor, number of cores, compiler, build type, version and date.
std::vector<std::pair<std::string, std::string>> machine_facts();

/// Indices of the points that no other one beats in both error and time, quickest first. Points
/// without an answer (NaN) or of error 0 are left out and kept in, respectively.
std::vector<std::size_t> pareto_front(const std::vector<Measurement>& points);

/// The quickest point whose error is at most `error`; nullptr if none is.
const Measurement* best_for(const std::vector<Measurement>& points, double error);

/// The measurements of one suite and case, in order; and all (suite, case) pairs in order.
std::vector<Measurement> of_case(const Results& results, const std::string& suite,
                                 const std::string& test_case);
std::vector<std::pair<std::string, std::string>> cases_of(const Results& results);

/// A case's description and the source of its truth, as kept in the facts ("case suite/name").
std::string description_of(const Results& results, const std::string& suite,
                           const std::string& test_case);

/// 1.23e-5 -> "12.3 us".
std::string time_text(double seconds);

/// One point of both runs.
struct Change {
    Measurement before, after;
    double time_ratio = 1.0;   ///< after / before
    double error_ratio = 1.0;  ///< after / before
    std::string verdict;       ///< "faster", "slower", "better", "worse", joined by "; ", or "same"
};

/// Points in both runs. A time counts as changed when it differs by more than both spreads and 10
/// %; an error when it differs by more than 10 % and either is above 1e-13, where rounding ends.
std::vector<Change> compare(const Results& before, const Results& after);

/// suite,case,method,parameter,seconds_before,seconds_after,error_before,error_after,verdict
void write_comparison(const std::vector<Change>& changes, std::ostream& out);

/// Whether a suite compares requests with and without a rule, not methods with a truth.
bool is_about_rules(const std::string& suite);

/// What each rule saves, from the full and the reduced request, as rows of text: a head, then one
/// row for each rule that was measured.
std::vector<std::vector<std::string>> rule_table(const Results& results);

}  // namespace miebrdf::bench
