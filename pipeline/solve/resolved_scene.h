// A scene with its names looked up: n + ik, sizes and amounts at every wavelength. Nothing behind
// it asks the database again.
#pragma once

#include <miebrdf/ensemble.h>
#include <miebrdf/scene.h>

#include <complex>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <tuple>
#include <vector>

#include "pipeline/scene/given_medium.h"

namespace miebrdf {

class JobKey;
class NamedIndexMemo;
struct IndexShift;

/// Spheres of one kind at one wavelength.
struct Particles {
    double wavelength_nm = 0.0;
    std::complex<double> index = {};                  ///< n + ik, k raised to the scene's floor
    double host_index = 1.0;                          ///< the real part: docs/maths-mie.md
    std::vector<mie::ParticleCoating> coatings = {};  ///< from inside out
};

inline auto fields(const Particles& value) {
    const auto& [wavelength_nm, index, host_index, coatings] = value;
    return std::tie(wavelength_nm, index, host_index, coatings);
}

/// Spheres of one kind at many wavelengths, ascending, between which their optics are sampled
/// (sampled_spectrum.h).
struct ParticleSpectrum {
    std::vector<Particles> particles;
    std::string hash;  ///< of them
};

/// Spheres that crowd the others of their medium.
struct CrowdMember {
    double volume_fraction = 0.0;                             ///< of the layer
    double effective_radius_um = 0.0, outer_radius_um = 0.0;  ///< as of ResolvedSpecies
    std::vector<Particles> particles = {};
    std::vector<std::string> key = {};  ///< as of ResolvedSpecies
};

/// A species at every wavelength of its scene.
struct ResolvedSpecies {
    Species species;
    std::vector<Particles> particles = {};          ///< empty for species that bring their optics
    std::shared_ptr<const GivenMedium> given = {};  ///< of these; null for spheres
    std::vector<double> wavelength_nm = {};         ///< in vacuum
    mie::SizeDistribution sizes = {};
    double effective_radius_um = 0.0;  ///< of the spheres, or of their cores
    double outer_radius_um = 0.0;      ///< that of a core of this radius, with its coatings
    double volume_per_core = 1.0;      ///< mean volume of the particles over that of their cores
    /// The share of the layer's volume (of files without sizes the number in a um3); 1 of a single
    /// species without amount, as of the particles' own.
    double volume_fraction = 1.0;
    std::optional<double> density_g_cm3 = {};
    bool crowded = false;                 ///< Packing::percus_yevick
    std::vector<CrowdMember> crowd = {};  ///< all spheres of the medium, these among them
    std::shared_ptr<const ParticleSpectrum> spectrum = {};  ///< null: each wavelength by itself
    /// Names what its optics depend on, at every wavelength: species of the same key are the same.
    std::vector<std::string> key = {};

    bool needs_mie() const { return !particles.empty(); }
    bool has_extinction() const { return miebrdf::has_extinction(species); }
};

/// A medium at every wavelength of its scene.
struct ResolvedMedium {
    Medium medium;
    std::vector<ResolvedSpecies> species = {};
    /// Volume fractions are those of the layer; otherwise their ratios are all that is known.
    bool has_amounts = false;
    /// 1/um of layer, at every wavelength: what the host absorbs between the particles.
    std::vector<double> host_absorption = {};
    /// Refractive index between the particles as boundaries see it, at every wavelength.
    std::vector<double> host_index = {};
    std::vector<std::string> key = {};  ///< as of species

    bool needs_mie() const { return species.front().needs_mie(); }
    bool has_extinction() const { return has_amounts || species.front().has_extinction(); }
};

/// How deep a layer is at every wavelength: `optical_depth` where it is the same at all; otherwise
/// `column_um` times the extinction per um that the volume fractions make; otherwise, with a
/// reference, that optical depth there.
struct ResolvedDepth {
    Depth depth;
    double optical_depth = 0.0;
    std::optional<double> column_um = {};
    std::optional<ResolvedMedium> reference = {};  ///< the medium at the depth's wavelength alone

    bool is_grey() const { return !column_um && !reference; }
    bool is_empty() const { return is_grey() && optical_depth == 0.0; }
};

struct ResolvedScene {
    std::vector<double> wavelength_nm;
    /// The base, then the layers but for those left out (is_left_out). A scene on a substrate has
    /// no base: its first medium is empty.
    std::vector<ResolvedMedium> media = {};
    std::vector<ResolvedDepth> depths = {};  ///< of media[1], media[2], ...
    std::optional<Substrate::Kind> substrate = {};
    std::vector<double> ground_albedo = {};               ///< of the substrate, at every wavelength
    std::optional<rte::GroundBrdf> ground = {};           ///< of Substrate::Kind::brdf
    std::vector<std::complex<double>> mirror_index = {};  ///< of a mirror, at every wavelength
    std::vector<double> scene_host_index = {};  ///< of the scene's host, where it has a boundary
    std::optional<rte::Boundary> boundary = {};
    ParticleOptions particles = {};
    std::optional<rte::SurfaceOptions> surface = {};
    rte::SurfaceCoupling coupling = rte::SurfaceCoupling::paper;
    std::vector<std::complex<double>> surface_index =
        {};  ///< n + ik of the surface, if there is one
    std::vector<std::string> sources =
        {};  ///< where the figures come from, one line for each species and host
    std::vector<std::string> notes = {};   ///< what holds within limits only, one line each
    std::vector<Layer> empty_layers = {};  ///< of no depth: left out, but for surfaces of hosts

    std::size_t layers() const { return depths.size(); }
    /// The lowest medium that there is: 0, or 1 on a substrate.
    std::size_t first_medium() const { return substrate ? 1 : 0; }
    /// The media that there are, from the lowest one up.
    std::span<const ResolvedMedium> present_media() const {
        return std::span(media).subspan(first_medium());
    }
    /// Whether indices of hosts matter to transfer.
    bool has_optical_steps() const { return boundary || substrate == Substrate::Kind::mirror; }
    /// Index under the air, as the boundary sees it; 1 without one.
    double top_index(std::size_t wavelength) const;

    /// Everything that the reflection of the layers at a wavelength depends on.
    void add_to(JobKey& key, std::size_t wavelength) const;
};

/// Looks everything up, once.
/// @param memo   of names, for several scenes (OpticsMemo::names); null: none
/// @param shift  null: every index as it is known
/// @throws UsageError  for particles without contrast to their host, amounts and densities that are
///         missing, and for a surface without a refractive index
/// @throws InputError  for unknown names, a database that cannot be read, and wavelengths that a
///         material does not cover
ResolvedScene resolve(const Scene& scene, const std::vector<double>& wavelength_nm,
                      NamedIndexMemo* memo = nullptr, const IndexShift* shift = nullptr);

}  // namespace miebrdf
