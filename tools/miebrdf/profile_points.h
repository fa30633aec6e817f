// Single BRDF values of others to be drawn beside curves.
#pragma once

#include <string>
#include <vector>

namespace miebrdf::program {

struct ProfilePoint {
    double wavelength_nm, mu_in, mu_out, azimuth_deg;
    double brdf;  ///< 1/sr
};

/// Reads a CSV table with the columns of `miebrdf brdf`, in any order and with others between them:
/// wavelength_nm, mu_in, mu_out, azimuth_deg, and brdf or reflection (divided by pi). Lines that
/// begin with # are comments.
/// @throws InputError  with file and line
std::vector<ProfilePoint> read_profile_points(const std::string& path);

}  // namespace miebrdf::program
