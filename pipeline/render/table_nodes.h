// Where the solver is asked, and how to find these places again.
#pragma once

#include <vector>

#include "pipeline/render/cubic_taps.h"

namespace miebrdf::render {

/// Cosines sin^2(pi x / 2) for evenly spaced x in [0, 1], the first 1e-9: close to each other at
/// grazing, where reflection changes fastest, and at the normal.
std::vector<double> cosine_nodes(int count);
CubicTaps cosine_taps(double mu, std::size_t count);

/// Azimuths from 0 to 180 degrees, 180 s^1.5 for evenly spaced s: closer on the forward side, where
/// peaked phase functions make even multiple scattering narrow at grazing.
std::vector<double> azimuth_nodes_deg(int count);
CubicTaps azimuth_taps(double cos_azimuth, std::size_t count);

}  // namespace miebrdf::render
