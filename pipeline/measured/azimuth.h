// Directions of goniometers: angles with signs, and whose azimuth is measured from where.
#pragma once

#include <cmath>
#include <vector>

#include "pipeline/measured/reader.h"

namespace miebrdf::measured {

/// Angles in degrees as a file has them; NaN where it has none.
struct RawDirection {
    double theta_in = MeasuredValue::kNone, theta_out = MeasuredValue::kNone;
    double phi = MeasuredValue::kNone;  ///< relative azimuth
    double phi_in = MeasuredValue::kNone, phi_out = MeasuredValue::kNone;
    bool times_mu_out = false;  ///< the value is the BRDF times the cosine of reflection
    std::size_t value = 0;      ///< of Measurements::values

    bool given() const {
        return times_mu_out || !std::isnan(theta_in) || !std::isnan(theta_out) ||
               !std::isnan(phi) || !std::isnan(phi_in) || !std::isnan(phi_out);
    }
};

/// Gives values their cosines and azimuth. Both azimuths (or a negative theta_in, which turns the
/// incident direction round) are those of coordinates on the sample: equal ones mean back towards
/// the source. One relative azimuth, or a signed theta_out alone, needs to know what 0 means: from
/// the options, or from values that are far larger near the mirror direction than opposite.
/// @throws ImportError  where this stays open
void set_directions(Measurements& list, const std::vector<RawDirection>& raw,
                    const MeasuredOptions& options, const MeasuredFile& file);

}  // namespace miebrdf::measured
