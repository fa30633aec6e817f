// A recipe's problem in the words of a fit, and back as a file.
#pragma once

#include <miebrdf/fit.h>

#include <string>
#include <vector>

namespace miebrdf::fitting {

/// The colour of a spectrum or Lab. @throws UsageError  for too few wavelengths
Lab colour_of(const FitData& data, const Viewing& viewing);

/// The geometry of a target, where its words leave it to the measured value.
void set_geometry(MeasuredOptions& options, const MeasuredValue& value);

/// The scenes of a problem as data of a fit: the spectrum of each target that differs from those
/// before it in scene or geometry. @param data_of_target  index of each target's data
FitProblem spectra_of(const MatchProblem& problem, std::vector<std::size_t>& data_of_target);

/// @throws UsageError
void check_match(const MatchProblem& problem);

/// The problem with other starts, as a match file.
std::string match_text(const MatchProblem& problem, const std::vector<double>& numbers,
                       const std::string& title);

}  // namespace miebrdf::fitting
