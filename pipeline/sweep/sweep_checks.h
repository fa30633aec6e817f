// Checks that make axes, a scene with gaps and outputs one sweep.
#pragma once

#include <string>
#include <vector>

#include "pipeline/sweep/sweep.h"

namespace miebrdf::sweep {

/// Puts an axis where its name belongs: wavelength_nm, mu_in or theta_in_deg, mu_out or
/// theta_out_deg and azimuth_deg are asked of one solution; any other one makes a dimension.
/// @throws UsageError  for values out of range, and for cosines beside degrees
void place_axis(Sweep& sweep, Axis axis);

/// One dimension, "sample", of all of them. @throws UsageError  for different lengths
void zip_dimensions(Sweep& sweep);

/// Null if there is none.
Axis* find_axis(Sweep& sweep, const std::string& name);
std::vector<std::string> axis_names(const Sweep& sweep);
std::vector<std::string> scene_axis_names(const Sweep& sweep);

std::vector<std::string> output_names();
/// Adds an output by its name; "transmittance" is both of them. False: there is none such.
bool add_output(Sweep& sweep, const std::string& name);

/// @throws UsageError  for axes that nothing uses, names that stand for two things, outputs
///         without their axes, values that do not ascend, tables too large to be counted
void check_sweep(const Sweep& sweep);

}  // namespace miebrdf::sweep
