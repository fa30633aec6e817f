// The generated parts of pages in docs/: between <!-- generated NAME --> and <!-- end NAME -->.
#pragma once

#include <filesystem>
#include <string>

#include "tools/bench/results.h"

namespace miebrdf::bench {

/// `page` with everything between its two marks of this name replaced.
/// @throws miebrdf::InputError  when a mark is missing
std::string with_generated_part(const std::string& page, const std::string& name,
                                const std::string& text);

/// Puts choice tables, error tables and plots of these results into accuracy.md and performance.md
/// of a folder, and the plots into its subfolder plots/.
void update_bench_documents(const std::filesystem::path& folder, const Results& results);

/// Replaces one generated part of a file.
void update_document(const std::filesystem::path& file, const std::string& name,
                     const std::string& text);

}  // namespace miebrdf::bench
