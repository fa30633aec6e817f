// A scene with its names looked up: n + ik and sizes at every wavelength. Nothing behind it asks
// the database again.
#pragma once

#include <miebrdf/scene.h>

#include <complex>
#include <optional>
#include <string>
#include <vector>

namespace miebrdf {

class JobKey;

/// A medium at every wavelength of its scene.
struct ResolvedMedium {
    Medium medium;
    /// n + ik, k raised to the scene's floor; empty for media that bring their optics.
    std::vector<std::complex<double>> index = {};
    mie::SizeDistribution sizes = {};  ///< of media that go through Mie theory
    /// Names what its optics depend on, at every wavelength: media of the same key are the same.
    std::vector<std::string> key = {};

    bool needs_mie() const { return !index.empty(); }
};

struct ResolvedScene {
    std::vector<double> wavelength_nm;
    std::vector<ResolvedMedium> media = {};  ///< the base, then the layers that have a depth
    std::vector<double> optical_depth = {};  ///< of media[1], media[2], ...
    ParticleOptions particles = {};
    std::optional<rte::SurfaceOptions> surface = {};
    rte::SurfaceCoupling coupling = rte::SurfaceCoupling::paper;
    std::vector<std::complex<double>> surface_index =
        {};  ///< n + ik of the surface, if there is one
    std::vector<std::string> sources =
        {};  ///< where the figures come from, one line for each medium
    std::vector<Layer> empty_layers = {};  ///< of no depth: left out

    std::size_t layers() const { return optical_depth.size(); }

    /// Everything that the reflection of the layers at a wavelength depends on.
    void add_to(JobKey& key, std::size_t wavelength) const;
};

/// Looks everything up, once.
/// @throws UsageError  for particles without contrast to their host, and for a surface without a
///         refractive index
/// @throws InputError  for unknown names, a database that cannot be read, and wavelengths that a
///         material does not cover
ResolvedScene resolve(const Scene& scene, const std::vector<double>& wavelength_nm);

/// A material's n + ik and where it comes from.
struct ResolvedIndex {
    std::vector<std::complex<double>> index;
    std::string source;
};
/// @param database  file of the user's materials; empty: the default one
/// @throws InputError  as resolve()
ResolvedIndex resolve_index(const Medium& medium, const std::vector<double>& wavelength_nm,
                            const std::string& database = {}, double k_floor = 0.0);

}  // namespace miebrdf
