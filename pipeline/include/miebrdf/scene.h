// A scene: what lies on what, in the words of its user. Nothing is looked up yet.
// Conventions and units: docs/conventions.md; every word: docs/command-line.md.
#pragma once

#include <miebrdf/index.h>
#include <miebrdf/sizes.h>
#include <miebrdf/surface.h>

#include <complex>
#include <optional>
#include <string>
#include <vector>

#pragma GCC visibility push(default)
namespace miebrdf {

/// What a medium says about its own spheres; what it leaves out is that of its scene.
struct ParticleSizes {
    std::optional<double> effective_radius_um = {};  ///< > 0
    std::optional<double> effective_variance = {};   ///< > 0, up to 10; ignored for mono
    std::optional<mie::SizeDistributionKind> distribution = {};  ///< any but tabulated

    bool operator==(const ParticleSizes&) const = default;
};

/// What a layer is made of; medium() makes one from words.
struct Medium {
    /// "material", "index", "isotropic", "rayleigh", "hg", "moments", ... (medium_forms), or
    /// "table": spheres of a refractive index of one's own
    std::string kind = {};
    std::string name = {};  ///< material: NAME or source:KEY; moments: the file's path; table: any
    std::vector<double> parameters = {};     ///< the numbers after the colon; moments: the albedo
    std::vector<double> chi = {};            ///< moments: chi_0 = 1, chi_1, ...
    std::vector<double> wavelength_nm = {};  ///< table: in vacuum, ascending
    std::vector<std::complex<double>> index = {};  ///< table: n + ik at each wavelength, between
                                                   ///< them monotone cubic in photon energy
    ParticleSizes sizes = {};                      ///< of media that go through Mie theory

    bool operator==(const Medium&) const = default;
};

/// Reads `NAME`, `source:KEY`, `index:N,K`, `isotropic:ALBEDO`, `rayleigh:ALBEDO`, `hg:ALBEDO,G` or
/// `moments:FILE` (the file is read here; names are looked up by solve()). Media that go through
/// Mie theory may end in sizes of their own: `TiO2,radius=0.1,variance=0.3,distribution=gamma`.
/// @throws UsageError  for words and numbers that are wrong, with what is allowed
/// @throws InputError  for a moments file that is missing or wrong
Medium medium(const std::string& text);

/// The medium in the notation of medium(); a table, which has none, by its name.
std::string describe(const Medium& medium);

/// Whether its optics come from Mie theory (and so depend on sizes and host).
bool needs_mie(const Medium& medium);

/// How each kind of medium that words can say is written: "hg:ALBEDO,G", with an example and what
/// it is.
struct MediumForm {
    std::string form, example, help;
};
std::vector<MediumForm> medium_forms();

/// A homogeneous layer of some depth.
struct Layer {
    Medium medium = {};
    double optical_depth = 0.0;  ///< of extinction, vertical, >= 0; may be infinite
};

/// Reads `MEDIUM@OPTICAL_DEPTH`, for example `AlGaAs7@0.1`; `inf` is a depth.
/// @throws UsageError, InputError  as medium(), and for a depth that is missing or negative
Layer layer(const std::string& text);

/// The spheres of media that go through Mie theory; a medium's own sizes come before these.
struct ParticleOptions {
    mie::SizeDistribution sizes = {};
    double host_index = 1.0;  ///< of the medium between the spheres, > 0
    double k_floor = 0.0;     ///< k below this is raised to it; 0: k as tabulated
    double tolerance = 0.0;   ///< of the size average; 0: its share of the whole tolerance
};

/// A semi-infinite base, layers in painting order (the last one is on top) and, if wanted, a rough
/// surface above them.
struct Scene {
    Medium base = {};
    std::vector<Layer> layers = {};
    ParticleOptions particles = {};
    std::optional<rte::SurfaceOptions> surface = {};  ///< empty: no lobe, all light enters
    rte::SurfaceCoupling coupling = rte::SurfaceCoupling::paper;
    /// Index of the surface where the top medium has none of its own (hg:, isotropic:, ...), or
    /// where it should differ.
    std::optional<std::complex<double>> surface_index = {};
    std::string database = {};           ///< file of the user's materials; empty: the default one
    materials::IndexOptions index = {};  ///< of materials, between and beyond their rows
};

/// "AlGaAs7 (optical depth 0.1) on TiO2, surface roughness 0.3"
std::string describe(const Scene& scene);

/// The medium on top of a scene: that of the last layer, or the base.
const Medium& top_medium(const Scene& scene);

/// Refuses numbers that no scene can have.
/// @throws UsageError  with field, value and allowed range
void validate(const Scene& scene);

}  // namespace miebrdf
#pragma GCC visibility pop
