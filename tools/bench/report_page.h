// One self-contained HTML page with everything a bench run found.
#pragma once

#include <string>
#include <vector>

#include "tools/bench/results.h"

namespace miebrdf::bench {

/// The errors that the "what to choose" tables answer for.
const std::vector<double>& wanted_errors();

/// Curves of every case (inline SVG), what to choose for a wanted error, the comparison with an
/// earlier run if there is one, machine and versions. Opens without network; a small inline script
/// shows and hides methods.
std::string report_page(const Results& results, const std::vector<Change>& changes = {});

/// 1.23e-5 -> "12.3 us".
std::string time_text(double seconds);

/// Markdown of the "what to choose" table of one suite, for the documentation.
std::string choice_table_markdown(const Results& results, const std::string& suite);

/// What a case computes and where its truth is from, as kept in the facts ("case suite/name").
std::string description_of(const Results& results, const std::string& suite,
                           const std::string& test_case);

}  // namespace miebrdf::bench
