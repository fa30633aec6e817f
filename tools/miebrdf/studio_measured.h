// Measured files that are dropped onto the studio's page, and fits to them.
#pragma once

#include <nlohmann/json.hpp>

#include <miebrdf/control.h>
#include "tools/miebrdf/scene_options.h"

namespace miebrdf::program {

/// What the readers of `miebrdf measured` find in `content` (base64), a file called `name`; perhaps
/// with `quantity` and `theta_in_deg` of what it does not say: `samples`, `doubts`, and `values` of
/// `sample`, `quantity`, `geometry`, `wavelength_nm`, `mu_in`, `mu_out`, `azimuth_deg`, `value`.
/// @throws UsageError, InputError  as read_measured()
nlohmann::json measured_for_page(const nlohmann::json& asked);

/// Fits the `unknowns` ({"u1": "0.2 in 0.02:2 log"}) of these words to one `sample` of such a file,
/// between `from_nm` and `to_nm`: `values` with `standard_error`, `notes`, `used`, `converged`.
/// @throws UsageError, InputError  as fit()
nlohmann::json fit_for_page(const SaidWords& said, const nlohmann::json& asked,
                            const Control& control);

}  // namespace miebrdf::program
