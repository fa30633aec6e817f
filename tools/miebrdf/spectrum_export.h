// The exports that hold no directions: reflectance spectra and single-scattering tables.
#pragma once

#include <miebrdf/brdf.h>
#include "tools/miebrdf/command.h"

namespace miebrdf::program {

/// Whether `format` is one of spd, irregular, scattering.
bool is_spectrum_format(const std::string& format);

/// Writes spherical albedos (spd, irregular) or albedo and moments of the base's single scattering
/// (scattering, npz) to -o FILE.
/// @return  an exit code
int export_spectrum(const std::string& format, const Brdf& brdf, const Shell& shell);

}  // namespace miebrdf::program
