// What a layer is made of, as it is named on the command line and in scene files.
#pragma once

#include <complex>
#include <string>
#include <variant>
#include <vector>

#include <miebrdf/sizes.h>
#include "pipeline/scene/layer_sizes.h"

namespace miebrdf {

/// A material of the database, by name or `source:KEY`; its spheres scatter by Mie theory.
struct DatabaseMedium {
    std::string name;
    LayerSizes sizes = {};
};
/// Spheres of a constant refractive index, by Mie theory.
struct IndexMedium {
    std::complex<double> refractive_index;
    LayerSizes sizes = {};
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
/// Legendre moments read from a file (pipeline/scene/moments_file.h).
struct MomentsMedium {
    std::string path;
    double single_scattering_albedo;
    std::vector<double> chi;
};

using Medium = std::variant<DatabaseMedium, IndexMedium, IsotropicMedium, RayleighMedium,
                            HenyeyGreensteinMedium, MomentsMedium>;

/// Reads `NAME`, `source:KEY`, `index:N,K`, `isotropic:ALBEDO`, `rayleigh:ALBEDO`, `hg:ALBEDO,G` or
/// `moments:FILE` (the file is read here). Names are looked up later, by whoever has the database.
/// Media that go through Mie theory may end in sizes of their own: `TiO2,radius=0.1,variance=0.3`
/// (split_sizes).
/// @throws UsageError  for numbers that are missing or out of range, and for sizes of a medium that
///         does not go through Mie theory
/// @throws InputError  for a moments file that is missing or wrong
Medium parse_medium(const std::string& text);

/// The medium in the notation of parse_medium.
std::string describe(const Medium& medium);

/// Whether its optics come from Mie theory (and so depend on sizes and host).
bool needs_mie(const Medium& medium);

/// The sizes that a medium has for itself; none for media that do not go through Mie theory.
LayerSizes sizes_of(const Medium& medium);
/// The medium with those instead of its own; the medium itself where it has no particles.
Medium with_sizes(Medium medium, const LayerSizes& sizes);

/// The spheres of media that go through Mie theory; a medium's own sizes come before these.
struct ParticleOptions {
    mie::SizeDistribution sizes;
    double host_index = 1.0;  ///< of the medium between the spheres, > 0
    double k_floor = 0.0;     ///< k below this is raised to it; 0: k as tabulated
    double tolerance = 0.0;   ///< of the size average; 0: a fifth of the request's tolerance
};

/// @throws UsageError  with the value and the allowed range
void validate(const ParticleOptions& particles);

/// The spheres of one medium of a scene: its own sizes over those of the scene.
ParticleOptions particles_of(const Medium& medium, const ParticleOptions& of_scene);

struct CoatMedium {
    Medium medium;
    double optical_depth = 0.0;
};

/// Reads `MEDIUM@OPTICAL_DEPTH`.
CoatMedium parse_coat(const std::string& text);

}  // namespace miebrdf
