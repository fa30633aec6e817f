// Every table of results says how it was computed.
#pragma once

#include <string>
#include <utility>
#include <vector>

#include <miebrdf/brdf.h>
#include "pipeline/io/table.h"

namespace miebrdf::program {

/// Units, sources, particles, depths, notes, tolerance, error estimate, method and what missed the
/// tolerance; and the report, with one row for each wavelength.
void add_facts(Table& table, const ResultReport& result, const Scene& scene,
               const std::string& units);

/// The same as names and texts for a page, the scene and the command before them.
using Facts = std::vector<std::pair<std::string, std::string>>;
Facts page_facts(const Scene& scene, const ResultReport& result, const std::string& command_line);

/// What a command that writes no such table says at its end (Shell::set_advice).
/// @param shortfalls  ResultReport::shortfalls(), at least one line
std::string advice_on(const std::vector<std::string>& shortfalls);

}  // namespace miebrdf::program
