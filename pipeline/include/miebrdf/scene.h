// A scene: what lies on what, in the words of its user. Nothing is looked up yet.
// Conventions and units: docs/conventions.md; every word: docs/command-line.md.
#pragma once

#include <miebrdf/index.h>
#include <miebrdf/matrix_expansion.h>
#include <miebrdf/sizes.h>
#include <miebrdf/surface.h>

#include <complex>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#pragma GCC visibility push(default)
namespace miebrdf {

/// The sizes that a species states for its own spheres; for those not set, the scene's hold. Of
/// coated spheres they are those of the cores.
struct ParticleSizes {
    std::optional<double> effective_radius_um = {};  ///< > 0
    std::optional<double> effective_variance = {};   ///< > 0, up to 10; ignored for mono
    std::optional<mie::SizeDistributionKind> distribution = {};
    /// In place of a radius, area of surface over mass, as snow has it: r_eff = 3 / (density S).
    std::optional<double> specific_surface_m2_per_kg = {};
    /// junge: n(r) ~ r^-exponent between radii_um[0] and radii_um[1].
    std::optional<double> exponent = {};
    /// tabulated: as mie::SizeDistribution has them; `file` names where they come from.
    std::string file = {};
    std::vector<double> radii_um = {}, number_density = {};

    bool operator==(const ParticleSizes&) const = default;
};

/// How much of a layer a species is.
struct Amount {
    enum class Kind {
        volume_fraction,  ///< of the layer's volume, in [0, 1]
        mass_fraction,    ///< of the layer's mass, in [0, 1]
        number_per_cm3,   ///< particles in a cubic centimetre, >= 0
    };
    Kind kind = Kind::volume_fraction;
    double value = 0.0;  ///< in the unit of its kind

    bool operator==(const Amount&) const = default;
};

/// The material between the particles of a layer, or of a coating: a material of the database, or a
/// constant index.
struct Host {
    std::string name = {};             ///< NAME or source:KEY; empty: `index`
    std::complex<double> index = 1.0;  ///< n + ik

    bool operator==(const Host&) const = default;
};

/// A shell around every sphere of a species: as thick on each, or a share of the core's radius.
struct Coating {
    Host material = {};
    double thickness_um = 0.0;     ///< >= 0, finite
    double share_of_radius = 0.0;  ///< >= 0, finite

    bool operator==(const Coating&) const = default;
};

/// Reads `NAME@5nm`, `NAME@10%` (of the core's radius) or `index:N,K@5nm`. @throws UsageError
Coating coating(const std::string& text);
/// In the notation of coating().
std::string describe(const Coating& coating);

/// Grains that are no spheres, by published corrections of what spheres of the same effective
/// radius 3 V / (4 A) (V the volume, A the mean projected area) scatter, or spheroids by the
/// T-matrix: docs/particles.md.
struct GrainShape {
    enum class Kind { sphere, spheroid, hexagonal_plate, koch };
    Kind kind = Kind::sphere;
    std::optional<double> aspect = {};     ///< width over length; empty: that of He et al. (2017)
    std::optional<double> asymmetry = {};  ///< g, in (-1, 1), in place of that of spheres or shapes
    /// B of Libois et al. (2013), in [0.5, 3], 1.25 for spheres: how absorption is enhanced.
    std::optional<double> absorption = {};
    /// Spheroids exactly, in random orientation: aspect is the equatorial axis over the polar one
    /// (empty: 0.5), sizes are radii of spheres of the same volume.
    bool by_t_matrix = false;

    bool operator==(const GrainShape&) const = default;
};

/// The phase function of particles: that of Mie theory, or a smooth one.
enum class PhaseForm { mie, henyey_greenstein, double_henyey_greenstein };

/// Single scattering with polarisation at one wavelength: the coefficients of the scattering
/// matrix, all six lists of one length (docs/polarisation.md).
struct MatrixCoefficients : MatrixExpansion {
    double single_scattering_albedo = 0.0;  ///< in [0, 1]
    std::vector<double> a1;                 ///< with 2l + 1 in them: a1_0 = 1

    bool operator==(const MatrixCoefficients&) const = default;
};

/// Single scattering as databases have it: of an ensemble, or of particles of single sizes.
struct FileScattering {
    std::vector<double> wavelength_nm;  ///< ascending; empty: the same at all
    /// 3 V / (4 A) of each size (V the volume, A the mean projected area), ascending; empty: an
    /// ensemble without a size.
    std::vector<double> radius_um;
    /// Values of each size at each wavelength, sizes fastest: Q_ext of sizes, the mean
    /// cross-section in um2 of ensembles (in any unit without has_cross_sections).
    std::vector<double> extinction;
    std::vector<double> albedo;  ///< in [0, 1]
    bool has_cross_sections = false;
    std::vector<double> angles_deg = {};          ///< 0 ... 180
    std::vector<std::vector<double>> phase = {};  ///< P >= 0 at them, in any unit; of coefficients
                                                  ///< (Species::matrices) empty
    /// Of media that polarise, beside each P: a2, a3, a4, b1 and b2 of rte::ScatteringMatrix over
    /// a1 at all angles, one list after the other.
    std::vector<std::vector<double>> ratios = {};
    /// The radii are 2 pi r / wavelength: particles of one refractive index, at any wavelength.
    bool radius_is_parameter = false;
    /// The radii are effective radii, of which averages over sizes were taken.
    bool has_averages = false;
    std::vector<double> area_ratio = {};  ///< A over pi r^2 of each size; empty: 1

    bool operator==(const FileScattering&) const = default;
};

/// One kind of scatterers; species() makes one from words.
struct Species {
    /// In words as medium_forms() lists them; `table`: spheres of a refractive index of one's own.
    enum class Kind {
        material,
        index,
        table,
        isotropic,
        rayleigh,
        henyey_greenstein,
        moments,
        matrix,
        double_henyey_greenstein,
        scattering,
        paste,
        turbid,
        slide
    };
    Kind kind = Kind::material;
    /// material: NAME or source:KEY; what is read from a file: its path; table: any
    std::string name = {};
    /// The numbers after the colon, rayleigh with its depolarisation factor, which may be left out;
    /// moments, matrix, scattering: the albedo; paste: the asymmetry and the density in g/cm3 (0:
    /// not known). Over several wavelengths the means.
    std::vector<double> parameters = {};
    std::vector<double> chi = {};  ///< moments, the same at all: chi_0 = 1, chi_1, ...
    /// table, matrix, moments, hg: in vacuum, ascending; but for table empty: the same at all
    std::vector<double> wavelength_nm = {};
    /// At each wavelength, linear between (moments: a1 alone; hg: {1, 3 g}); scattering: entries
    std::vector<MatrixCoefficients> matrices = {};
    std::vector<std::complex<double>> index = {};  ///< table: n + ik at each wavelength, between
                                                   ///< them monotone cubic in photon energy
    FileScattering scattering = {};                ///< scattering: what the file has; paste:
                                                   ///< wavelength_nm, albedo, extinction (1/um)
    ParticleSizes sizes = {};                      ///< of species that go through Mie theory
    std::vector<Coating> coatings = {};            ///< of these, from inside out
    GrainShape shape = {};
    std::optional<PhaseForm> phase = {};  ///< empty: mie, of grains that are no spheres smooth
    /// The density of the whole particle, > 0; empty: from the database, where needed.
    std::optional<double> density_g_cm3 = {};
    /// Bulk density of the layer that the species is in, > 0; empty: the scene's.
    std::optional<double> layer_density_kg_m3 = {};
    std::optional<Amount> amount = {};  ///< see Medium

    bool operator==(const Species&) const = default;
};

/// The content of a layer: species side by side in a host; medium() makes one from words.
///
/// Several species need an amount each. One of them may leave it out where all others are mass
/// fractions: it is the rest of the mass. A single species needs an amount where absolute amounts
/// matter: for a thickness, and in a host that absorbs.
struct Medium {
    std::vector<Species> species = {};  ///< at least one
    std::optional<Host> host = {};      ///< empty: that of the scene

    Medium() = default;
    Medium(Species only) : species{std::move(only)} {}
    Medium(std::vector<Species> all, std::optional<Host> between)
        : species(std::move(all)), host(std::move(between)) {}
    bool operator==(const Medium&) const = default;
};

/// Reads one species: `NAME`, `source:KEY`, `index:N,K`, `isotropic:ALBEDO`, `rayleigh:ALBEDO`,
/// `hg:ALBEDO,G`, `hg:FILE`, `dhg:ALBEDO,G1,G2,SHARE`, `moments:FILE`, `matrix:FILE`,
/// `scattering:FILE`, `paste:FILE`, `paste:NAME` (read here; names of materials are looked up by
/// solve()), `turbid:MU_A,MU_S_REDUCED,G`, `slide:N,K` (a layer alone), then sizes and amounts of
/// its own: `TiO2,radius=0.1,distribution=gamma,volume=15%`.
/// @throws UsageError  for words and numbers that are wrong, with what is allowed
/// @throws InputError  for a moments file that is missing or wrong
Species species(const std::string& text);

/// Reads `SPECIES`, or several joined by ` + `, then perhaps ` in HOST`:
/// `TiO2,radius=0.13,volume=15% + carbon,radius=0.04,volume=0.1% in PMMA`.
/// @throws UsageError, InputError  as species()
Medium medium(const std::string& text);

/// Reads a material's name, `source:KEY`, `index:N` or `index:N,K`. @throws UsageError
Host host(const std::string& text);

/// In the notation of species(), medium() and host(); a table, which has none, by its name.
std::string describe(const Species& species);
std::string describe(const Medium& medium);
std::string describe(const Host& host);

/// Whether its optics come from Mie theory (and so depend on sizes and host).
bool needs_mie(const Species& species);
/// Whether its extinction is known, by Mie theory or from a file: it may be mixed, and its depth
/// may be a thickness.
bool has_extinction(const Species& species);
/// Whether those of any species do.
bool needs_mie(const Medium& medium);

/// How each kind of medium that words can say is written: "hg:ALBEDO,G", with an example and what
/// it is.
struct MediumForm {
    std::string form, example, help;
};
std::vector<MediumForm> medium_forms();  ///< all of them

/// Where optical depths are given unless a wavelength is said.
inline constexpr double kDepthWavelengthNm = 550.0;

/// How deep a layer is.
struct Depth {
    enum class Kind {
        optical_depth,   ///< of extinction, vertical, >= 0; may be infinite
        thickness_um,    ///< finite, >= 0; needs amounts
        mass_kg_per_m2,  ///< of all particles over a unit of area, finite, >= 0; needs densities
    };
    Kind kind = Kind::optical_depth;
    double value = 0.0;  ///< in the unit of its kind
    /// Optical depths hold at this vacuum wavelength and follow the extinction of the particles at
    /// all others, as those of aerosols do; 0: the same at every wavelength. Media whose optics are
    /// given have no extinction to follow: the same at every wavelength.
    double wavelength_nm = kDepthWavelengthNm;

    Depth() = default;
    Depth(double optical_depth) : value(optical_depth) {}
    Depth(Kind kind_of_value, double given, double at_nm = kDepthWavelengthNm)
        : kind(kind_of_value), value(given), wavelength_nm(at_nm) {}
    bool operator==(const Depth&) const = default;
};

/// One optical depth for every wavelength, as Chen et al. (2013) have it.
Depth grey(double optical_depth);
/// Reads `0.1`, `0.1[450nm]`, `0.1[grey]`, `40um`, `2mm`, `10cm`, `2kg/m2`, `30g/m2` or `inf`.
/// @throws UsageError
Depth depth(const std::string& text);
/// In the notation of depth().
std::string describe(const Depth& depth);

/// A homogeneous layer of some depth.
struct Layer {
    Medium medium = {};
    Depth depth = {};
};

/// Reads `MEDIUM@DEPTH`, for example `AlGaAs7@0.1` or `TiO2,volume=15% in PMMA@40um`.
/// @throws UsageError, InputError  as medium() and depth()
Layer layer(const std::string& text);

/// The support of the layers where there is no half-space: a ground, or nothing.
struct Substrate {
    enum class Kind {
        black,       ///< nothing comes back
        lambertian,  ///< a share of the flux, alike in all directions
        none,        ///< a free film: what passes it is gone; a Boundary is on both its sides
        mirror,      ///< a smooth surface of a metal or another refractive index
        brdf,        ///< a natural ground in air: `brdf`
    };
    Kind kind = Kind::black;
    /// The albedo of a Lambertian ground, in [0, 1]: one for all wavelengths, or a table over
    /// `wavelength_nm`.
    std::vector<double> albedo = {};
    std::vector<double> wavelength_nm = {};  ///< ascending; linear between them
    std::string file = {};                   ///< where the table comes from, for messages
    Host mirror = {};                        ///< what a mirror is made of
    rte::GroundBrdf brdf = {};               ///< the same at all wavelengths

    bool operator==(const Substrate&) const = default;
};

/// Reads `black`, `none`, `lambert:ALBEDO`, `lambert:FILE` (CSV wavelength_nm,albedo),
/// `mirror:NAME`, `mirror:index:N,K`, `rpv:RHO0,K,THETA[,RHOC]`, `ross-li:ISO,VOL,GEO` or
/// `hapke:W,B,C,B0,H,THETABAR` (degrees).
/// @throws UsageError, InputError
Substrate substrate(const std::string& text);
/// In the notation of substrate().
std::string describe(const Substrate& substrate);

/// Reads `smooth`, `rough:ALPHA` or `rough:ALPHA,beckmann` (or ggx, which is the default).
/// @throws UsageError
rte::Boundary boundary(const std::string& text);
/// In the notation of boundary().
std::string describe(const rte::Boundary& boundary);

/// Whether crowded particles see each other.
enum class Packing {
    independent,     ///< each scatters as if alone
    percus_yevick,   ///< hard spheres: |F|^2 times their structure factor, species by species
    effective_host,  ///< in a host in which the others are dissolved (Maxwell Garnett)
    percus_yevick_effective_host,  ///< both
};

/// The spheres of media that go through Mie theory; a species' own sizes come before these.
struct ParticleOptions {
    mie::SizeDistribution sizes = {};
    Host host = {};          ///< of media that say none of their own
    double k_floor = 0.0;    ///< k below this is raised to it; 0: k as tabulated
    double tolerance = 0.0;  ///< of the size average; 0: its share of the whole tolerance
    /// Bulk density of the layers in kg/m3, where mass fractions and thicknesses meet (snow: 50 to
    /// 550); empty: not known.
    std::optional<double> layer_density_kg_m3 = {};
    Packing packing = Packing::independent;
};

/// A number that has a name: `{radius=0.13}` in the words of a scene. Derivatives and fits ask for
/// it.
struct NamedNumber {
    std::string name;    ///< letters, digits and _, no digit first
    double value = 0.0;  ///< in the unit of its word
};

/// A word of a scene with numbers that have names, as it was said: "coat" and its layers.
struct NamedWords {
    std::string word;
    std::vector<std::string> values;
};

/// A semi-infinite base or a ground, layers in painting order (the last one is on top) and, if
/// wanted, a rough surface above them.
struct Scene {
    Medium base = {};                         ///< of no use where there is a substrate
    std::optional<Substrate> substrate = {};  ///< in place of the base
    std::vector<Layer> layers = {};
    ParticleOptions particles = {};
    std::optional<rte::SurfaceOptions> surface = {};  ///< empty: no lobe, all light enters
    /// Where light is refracted between air and what lies between the particles of the top layer;
    /// layers of different hosts are separated by smooth boundaries then. Not together with
    /// `surface`. Empty: hosts matter to the particles alone.
    std::optional<rte::Boundary> boundary = {};
    /// Empty: the paper's where values are asked for, the reciprocal one in tables, since programs
    /// that read exports exchange light and camera.
    std::optional<rte::SurfaceCoupling> coupling = {};
    /// Index of the surface where the top medium has none of its own (hg:, isotropic:, ...), or
    /// where it should differ.
    std::optional<std::complex<double>> surface_index = {};
    std::string database = {};           ///< file of the user's materials; empty: the default one
    materials::IndexOptions index = {};  ///< of materials, between and beyond their rows
    std::vector<NamedWords> named = {};  ///< words that give numbers names, by say()
};

/// Says a word of a scene as options of the program and keys of scene files do: "base", "coat" (all
/// coats at once), "substrate", "boundary", "host-index", ... A number in it may have a name:
/// `hg:{w=0.9},{g=0.6}`, `TiO2,radius={r=130}nm,volume={c=10}%@{d=40}um`.
/// @throws UsageError, InputError  as the program, and for names of words that describe no matter
void say(Scene& scene, const std::string& word, const std::vector<std::string>& values);

/// The numbers that have names, each once. A name may stand in several places: one number.
std::vector<NamedNumber> named_numbers(const Scene& scene);

/// The scene with other values of some of them: their words are read again.
/// @throws UsageError  for a name that the scene does not have, and for values that it cannot have
Scene with_values(const Scene& scene, const std::vector<NamedNumber>& values);

/// The text with values in the place of `{name}` and `{name=...}`: `{name=value}`. Names that are
/// not listed stay as they are.
std::string with_values(const std::string& text, const std::vector<NamedNumber>& values);

/// "AlGaAs7 (optical depth 0.1) on TiO2, surface roughness 0.3"
std::string describe(const Scene& scene);

/// The medium on top of a scene: that of the last layer, or the base.
/// @throws UsageError  for a substrate without layers
const Medium& top_medium(const Scene& scene);

/// The host between the particles of a layer, or on a substrate without layers: its own host, else
/// that of the scene.
const Host& host_of(const Scene& scene, const Medium& medium);

/// Refuses numbers that no scene can have.
/// @throws UsageError  with field, value and allowed range
void validate(const Scene& scene);

}  // namespace miebrdf
#pragma GCC visibility pop
