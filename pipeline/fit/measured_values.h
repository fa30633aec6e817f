// The values of a [[measured]]: from a file, or from the fit file itself.
#pragma once

#include <miebrdf/fit.h>

#include <string>
#include <utility>
#include <vector>

namespace miebrdf::fitting {

/// As a [[measured]] says them.
struct MeasuredWords {
    std::string file = {};  ///< empty: `values` at `wavelength_nm`
    MeasuredOptions options = {};
    std::vector<double> values = {}, wavelength_nm = {};
    bool has_spheres_of_file = false;  ///< takes FitData::spheres from the file
    std::vector<std::pair<double, double>> ranges =
        {};  ///< of wavelengths that count, nm; none: all
};

/// Puts them into `values`, and what may be wrong with them into `doubts`.
/// @throws UsageError, InputError  with what would help
void read_values(const MeasuredWords& words, FitData& data);

/// Reads `FIRST:LAST` in nm, or several of them after commas. @throws UsageError
std::vector<std::pair<double, double>> wavelength_ranges(const std::string& text);

/// Reads `squares`, `huber` or `cauchy`, then perhaps `:WIDTH` in sigmas.
/// @throws UsageError
void set_loss(FitProblem& problem, const std::string& text);

}  // namespace miebrdf::fitting
