// What a layer is made of, as it is named on the command line and in scene files.
#pragma once

#include <complex>
#include <string>
#include <variant>
#include <vector>

#include "mie/size_distribution.h"

namespace miebrdf {

/// A material of the database, by name or `source:KEY`; its spheres scatter by Mie theory.
struct DatabaseMedium {
    std::string name;
};
/// Spheres of a constant refractive index, by Mie theory.
struct IndexMedium {
    std::complex<double> refractive_index;
};
struct IsotropicMedium {
    double single_scattering_albedo;
};
struct RayleighMedium {
    double single_scattering_albedo;
};
struct HenyeyGreensteinMedium {
    double single_scattering_albedo;
    double asymmetry;
};
/// Legendre moments read from a file (pipeline/moments_file.h).
struct MomentsMedium {
    std::string path;
    double single_scattering_albedo;
    std::vector<double> chi;
};

using Medium = std::variant<DatabaseMedium, IndexMedium, IsotropicMedium, RayleighMedium,
                            HenyeyGreensteinMedium, MomentsMedium>;

/// Reads `NAME`, `source:KEY`, `index:N,K`, `isotropic:ALBEDO`, `rayleigh:ALBEDO`, `hg:ALBEDO,G` or
/// `moments:FILE` (the file is read here). Names are looked up later, by whoever has the database.
/// @throws UsageError  for numbers that are missing or out of range
/// @throws InputError  for a moments file that is missing or wrong
Medium parse_medium(const std::string& text);

/// The medium in the notation of parse_medium.
std::string describe(const Medium& medium);

/// Whether its optics come from Mie theory (and so depend on sizes and host).
bool needs_mie(const Medium& medium);

/// The spheres of every medium that goes through Mie theory.
struct ParticleOptions {
    mie::SizeDistribution sizes;
    double host_index = 1.0;  ///< of the medium between the spheres, > 0
    double k_floor = 0.0;     ///< k below this is raised to it; 0: k as tabulated
    double tolerance = 0.0;   ///< of the size average; 0: a fifth of the request's tolerance
};

/// @throws UsageError  with the value and the allowed range
void validate(const ParticleOptions& particles);

struct CoatMedium {
    Medium medium;
    double optical_depth = 0.0;
};

/// Reads `MEDIUM@OPTICAL_DEPTH`.
CoatMedium parse_coat(const std::string& text);

/// Reads `power-law`, `gamma`, `log-normal` or `mono`.
mie::SizeDistributionKind parse_size_distribution(const std::string& text);

}  // namespace miebrdf
