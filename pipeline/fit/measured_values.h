// The values of a [[measured]]: from a file, or from the fit file itself.
#pragma once

#include <miebrdf/fit.h>

#include <optional>
#include <string>
#include <vector>

namespace miebrdf::fitting {

/// As a [[measured]] says them.
struct MeasuredWords {
    std::string file = {};  ///< empty: `values` at `wavelength_nm`
    MeasuredOptions options = {};
    std::vector<double> values = {}, wavelength_nm = {};
    std::optional<std::pair<double, double>> range = {};  ///< of wavelengths that count, nm
};

/// Puts them into `values`, and what may be wrong with them into `doubts`.
/// @throws UsageError, InputError  with what would help
void read_values(const MeasuredWords& words, FitData& data);

/// Reads `FIRST:LAST` in nm. @throws UsageError
std::pair<double, double> wavelength_range(const std::string& text);

/// Reads `squares`, `huber` or `cauchy`, then perhaps `:WIDTH` in sigmas.
/// @throws UsageError
void set_loss(FitProblem& problem, const std::string& text);

}  // namespace miebrdf::fitting
