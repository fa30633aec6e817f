// The results of a run for people: one HTML page, and the generated parts of pages in docs/.
#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "tools/bench/results.h"

namespace miebrdf::bench {

/// Error over time of the points of one case: a curve for each method, in its colour of all cases
/// of these results; the Pareto front; the 95 % confidence intervals of methods of chance. Errors
/// below 1e-17 (exact zeros too) and above 10, and times below 1 us, are drawn at these limits.
/// Empty where no point has an answer.
std::string case_plot(const Results& results, const std::string& suite,
                      const std::string& test_case);

/// "half-space", "g 0.9, albedo 1" -> "half-space-g-0.9-albedo-1.svg": where the page expects it.
std::string plot_file_name(const std::string& suite, const std::string& test_case);

/// HTML: the plot and the points of every case, what to choose for a wanted error, the comparison
/// with an earlier run if there is one, machine and versions.
std::string report_page(const Results& results, const std::vector<Change>& changes = {});

/// `page` with everything between its two marks of this name replaced.
/// @throws miebrdf::InputError  when a mark is missing
std::string with_generated_part(const std::string& page, const std::string& name,
                                const std::string& text);

/// Puts choice tables, error tables and plots of these results into accuracy.md and performance.md
/// of a folder, and the plots into its subfolder plots/.
void update_bench_documents(const std::filesystem::path& folder, const Results& results);

/// Writes a file, whole or not at all.
void write_text(const std::filesystem::path& path, const std::string& text);

/// Replaces one generated part of a file.
void update_document(const std::filesystem::path& file, const std::string& name,
                     const std::string& text);

}  // namespace miebrdf::bench
