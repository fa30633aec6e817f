// The spectral BRDF of a scene: solved once, then asked at any directions.
//
//     const auto brdf = miebrdf::solve(scene, {450, 550, 650}, {.tolerance = 1e-3});
//     const auto values = brdf.evaluate({{0.5}, {0.3, 0.9}, {0, 180}});
//     values.at(wavelength, in, out, azimuth);   // 1/sr
//     if (!values.converged()) std::cerr << values.shortfall() << '\n';
#pragma once

#include <miebrdf/brdf_source.h>
#include <miebrdf/control.h>
#include <miebrdf/scene.h>
#include <miebrdf/solver.h>

#include <cstddef>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <vector>

#pragma GCC visibility push(default)
namespace miebrdf {

using rte::Directions;
using rte::SolverOptions;

/// The parts of a BRDF: R / pi of the layers alone, the lobe of the surface alone, and the sum of
/// both as eq. (5) of Chen et al. (2013) couples them.
enum class BrdfPart { total, subsurface, surface };
/// Reads "total", "subsurface" or "surface". @throws UsageError
BrdfPart parse_brdf_part(const std::string& name);
const char* name_of(BrdfPart part);

/// A set of parts; the others are neither computed nor returned.
struct BrdfParts {
    bool subsurface = true;  ///< R / pi of the layers
    bool surface = true;     ///< there is none without Scene::surface
    bool total = true;       ///< both, coupled
    bool errors = false;     ///< BrdfValues::Slice::errors
};

/// The verdict of physics on computed values, as numbers: reciprocity, energy and sign.
struct PhysicsReport {
    /// Largest |f(mu_in, mu_out) - f(mu_out, mu_in)| over the largest f, among the pairs of which
    /// both were asked for; empty when there are none. The paper's coupling to a surface (eq. 5) is
    /// not reciprocal; the layers alone are, to rounding.
    std::optional<double> reciprocity_defect;
    /// Largest share of the light that comes back, over the requested mu_in; at most 1.
    std::optional<double> largest_albedo;
    double least_value = 0.0;  ///< smallest BRDF value, 1/sr; negative values are wrong
};

/// An rms relative to the largest value at its incidence, and the direction where it is largest:
/// what a finite number of sphere sizes leaves in the phase function at single angles.
struct PhaseNoise {
    double largest = 0.0;      ///< relative, see above
    double mu_in = 0.0;        ///< 0: there is no noise
    double mu_out = 0.0;       ///< where it is
    double azimuth_deg = 0.0;  ///< where it is
};

/// How the values at one wavelength came about.
struct WavelengthReport {
    double wavelength_nm = 0.0;  ///< vacuum
    rte::SolverReport solver;    ///< of radiative transfer
    /// Depths of the layers, the lowest first; empty where nothing had to be computed.
    std::vector<double> optical_depths;
    double mie_error_estimate = 0.0;  ///< of the size averages, largest of the media
    PhaseNoise phase_noise;           ///< of single directions; not in error_estimate
    int stokes = 1;                   ///< components of light that were computed: 1, 3 or 4
    /// Estimate of what leaving polarisation out changes, of the largest value at that incidence
    /// (docs/polarisation.md); 0: none, 1: not looked at. Not in error_estimate.
    double polarisation_left_out = 0.0;
    double error_estimate = 0.0;  ///< of single scattering and transfer together
    /// error_estimate <= tolerance, every step says so, and polarisation that was left out was not
    /// found to change values by more than .6 % and the tolerance.
    bool converged = false;
};

/// The part that all results have in common: one report for each wavelength, and the worst of them.
struct ResultReport {
    double tolerance = 0.0;                     ///< as asked for
    std::vector<WavelengthReport> wavelengths;  ///< in the order asked for
    std::vector<std::string> sources;  ///< where the figures come from, one line for each medium
    std::vector<std::string> notes;    ///< what holds within limits only, one line each

    bool converged() const;                    ///< all wavelengths are
    double error_estimate() const;             ///< largest over the wavelengths
    const WavelengthReport& worst() const;     ///< of the error estimate
    const WavelengthReport& noisiest() const;  ///< of phase_noise
    /// Says what missed the tolerance and where, one line for each wavelength; empty when
    /// converged.
    std::vector<std::string> shortfalls() const;
    std::string shortfall() const;  ///< the lines joined
    /// "3 components of light at 2 of 3 wavelengths", and what leaving polarisation out may change;
    /// empty where it does not matter.
    std::vector<std::string> polarisation() const;
    /// One sentence: the estimate, and when the tolerance is missed, where and how widely.
    std::string summary() const;
};

/// Values of the BRDF, 1/sr without the cosine, at every combination of directions.
class BrdfValues : public ResultReport {
  public:
    Directions directions;  ///< as asked for
    /// Values of one wavelength, [(in * mu_out.size() + out) * azimuth_deg.size() + azimuth]; parts
    /// that were not asked for are empty.
    struct Slice {
        std::vector<double> subsurface, surface, total;  ///< 1/sr
        /// At each mu_in, what a smooth boundary or a mirror below sends into the mirror direction
        /// and nowhere else: a delta that the values are without. Empty: there is none.
        std::vector<double> mirror_reflectance;
        /// Estimates for each value of `total`, 1/sr; those of surface lobes are not in them.
        std::vector<double> errors;
        PhysicsReport layers_physics;  ///< of subsurface
        PhysicsReport physics;         ///< of total, or of the one part that was asked for

        const std::vector<double>& of(BrdfPart part) const;  ///< one of the three
    };
    std::vector<Slice> slices;  ///< one for each wavelength

    /// @throws UsageError  for an index beyond its list, and for a part not asked for
    double at(std::size_t wavelength, std::size_t in, std::size_t out, std::size_t azimuth,
              BrdfPart part = BrdfPart::total) const;
};

/// The Mueller matrix of the BRDF, 1/sr without the cosine, at every combination of directions:
/// what it makes of the Stokes vector (I, Q, U, V) of the incident light, Q = parallel minus
/// perpendicular to the meridian plane (of the ray and the normal) of each ray. Signs:
/// docs/polarisation.md.
class MuellerValues : public ResultReport {
  public:
    Directions directions;  ///< as asked for
    int components = 3;     ///< 3: I, Q, U; 4: with V
    /// [wavelength][(((in * mu_out.size() + out) * azimuth_deg.size() + azimuth) * components +
    /// row)
    /// * components + column]; row = outgoing, column = incident component
    std::vector<std::vector<double>> mueller;
    std::vector<std::vector<double>> plane_albedo;  ///< of unpolarised light, [wavelength][mu_in]
    /// The change if the light is fully polarised in the plane of incidence.
    std::vector<std::vector<double>> polarised_plane_albedo;
    /// The light that a smooth boundary or a mirror below sends into the mirror direction and
    /// nowhere else, a delta that the matrices are without: [wavelength][(in * components + row) *
    /// components + column], the share of the incident flux. Empty: there is none.
    std::vector<std::vector<double>> mirror_mueller;

    /// @param row, column  0: I, 1: Q, 2: U, 3: V
    /// @throws UsageError  for an index beyond its list
    double at(std::size_t wavelength, std::size_t in, std::size_t out, std::size_t azimuth,
              int row = 0, int column = 0) const;
    /// Degree of linear polarisation of what is reflected of unpolarised light, in [0, 1].
    double degree_of_linear_polarisation(std::size_t wavelength, std::size_t in, std::size_t out,
                                         std::size_t azimuth) const;
    /// The angle between its plane of polarisation and the meridian plane, degrees in [0, 180): 0 =
    /// parallel, 90 = perpendicular; 0 where it is not polarised.
    double angle_of_polarisation_deg(std::size_t wavelength, std::size_t in, std::size_t out,
                                     std::size_t azimuth) const;
};

/// Plane and spherical albedos. With a surface both are those of the whole: rho + (1 - rho) A.
class AlbedoValues : public ResultReport {
  public:
    std::vector<double> mu_in;                      ///< as asked for, in (0, 1]
    std::vector<std::vector<double>> plane_albedo;  ///< [wavelength][mu_in]
    std::vector<double> spherical_albedo;           ///< [wavelength]
    /// With polarisation asked for: as of MuellerValues. Empty: not asked for.
    std::vector<std::vector<double>> polarised_plane_albedo;
    /// The part of them that goes into the mirror direction and nowhere else, [wavelength][mu_in];
    /// empty without boundary and mirror.
    std::vector<std::vector<double>> mirror_reflectance;
    /// For scenes on a substrate without a surface: net flux into what lies below the layers.
    std::vector<std::vector<double>> plane_transmittance;  ///< [wavelength][mu_in]
    std::vector<double> spherical_transmittance;           ///< [wavelength]
    /// The part of plane_transmittance that has gone straight: reflected, perhaps, never scattered.
    std::vector<std::vector<double>> unscattered_transmittance;  ///< [wavelength][mu_in]

    /// The plane albedo. @throws UsageError  for an index beyond its list
    double at(std::size_t wavelength, std::size_t in) const;

    /// Albedo under a sky of which this share of the flux is uniform diffuse light, the rest the
    /// sun at mu_in: bihemispherical reflectance under ambient light (Schaepman-Strub et al. 2006).
    /// @throws UsageError  for an index beyond its list and for a share outside [0, 1]
    double under_sky(std::size_t wavelength, std::size_t in, double diffuse_fraction) const;
};

/// Hemispherical-directional reflectance factors under a sky of sun and uniform diffuse light.
class HdrfValues : public ResultReport {
  public:
    Directions directions;          ///< as asked for
    double diffuse_fraction = 0.0;  ///< in [0, 1]
    /// [wavelength][(in * mu_out.size() + out) * azimuth_deg.size() + azimuth]
    std::vector<std::vector<double>> hdrf;
};

/// Values, and their derivatives by numbers of the scene: of the discrete solution that gave the
/// values, with its nodes, moments and Fourier orders, and the sizes of spheres, as they are
/// (docs/derivatives.md).
template <typename Values>
struct WithDerivatives {
    Values values;                        ///< as without derivatives
    std::vector<std::string> parameters;  ///< names, in the order of derivatives
    /// [parameter], laid out as `values`, per unit in which the number is written; without reports.
    std::vector<Values> derivatives;
};

/// A layer of a scene at one wavelength. What needs absolute amounts, and what needs densities, is
/// empty where they are not known.
struct LayerOptics {
    std::size_t wavelength = 0;  ///< index
    std::string layer;           ///< "base", "coat 1", ...
    double optical_depth = 0.0;  ///< infinite for a base
    /// In [0, 1]; not a number, as the asymmetry, of a layer without depth: nothing is there.
    double single_scattering_albedo = 0.0;
    double asymmetry = 0.0;                           ///< g in [-1, 1]
    std::optional<double> scattering_per_um;          ///< mu_s
    std::optional<double> absorption_per_um;          ///< mu_a, of particles and host
    std::optional<double> reduced_scattering_per_um;  ///< mu_s' = mu_s (1 - g)
    /// Kubelka-Munk's, of diffuse light: K = 2 mu_a, S = 3/4 mu_s' - 1/4 mu_a, in 1/um. S is empty
    /// where that is negative: light is absorbed before it is diffuse, and the theory has no S.
    std::optional<double> k_km, s_km;
    std::optional<double> mass_extinction_m2_per_kg;  ///< of the particles
};

struct SolvedTable;

/// The use that a table is made for; everything may be left as it is.
struct TableOptions {
    BrdfPart part = BrdfPart::total;  ///< what the table holds
    std::string command_line = {};    ///< for Provenance; empty: the scene and the function called
    /// The coupling of a surface; empty: the scene's, else the reciprocal one.
    std::optional<rte::SurfaceCoupling> coupling = {};
    /// With SolverOptions::stokes = 0 (auto): 4 components instead of what the intensity needs, for
    /// BrdfTable::evaluate_mueller. With 3 and 4 the whole matrix is there anyway, with 1 never.
    bool whole_matrix = false;
};

/// A solved BRDF for those who evaluate millions of directions (exports, renderers): light
/// scattered more than once is smooth and interpolated between 49 x 49 cosines; what has sharp
/// features, the first order of scattering and the surface lobe, is evaluated at every direction.
/// Made by Brdf::table; copies share their data. Where light has several components, the BRDF is
/// that of unpolarised light, element 11 of the Mueller matrix.
class BrdfTable : public BrdfSource {
  public:
    const std::vector<std::string>& channels() const override;
    const std::vector<double>& wavelength_nm() const override;
    const Provenance& provenance() const override;  ///< for the files made of it
    /// As of BrdfSource: cosines up to 1 + 1e-6 count as 1 (unit vectors in single precision).
    /// @throws UsageError  with field, value and range for any other cosine outside of (0, 1], also
    ///         NaN, for an azimuth that is not finite, and for too few values; nothing is written
    ///         then
    void evaluate(std::span<const Direction> directions, std::span<double> values) const override;
    std::unique_ptr<ChannelMix> mix(const ColourWeights& weights) const override;
    int components() const override;
    void evaluate_mueller(std::span<const Direction> directions,
                          std::span<double> values) const override;

    /// How well the scene was solved, at directions of all kinds; not the interpolation.
    const ResultReport& report() const;

    /// For the library itself.
    explicit BrdfTable(std::shared_ptr<const SolvedTable> solved) : solved_(std::move(solved)) {}
    const SolvedTable& solved() const { return *solved_; }  ///< for the library itself

  private:
    std::shared_ptr<const SolvedTable> solved_;
};

/// Asks a scene for values and their derivatives; made by Brdf::derivatives. Copies share their
/// data.
class BrdfDerivatives {
  public:
    /// Values as Brdf::evaluate and Brdf::albedo give them.
    /// @throws UsageError  as these, and where a derivative has no bound: by the albedo of a
    ///         half-space that absorbs nothing
    WithDerivatives<BrdfValues> evaluate(const Directions& directions,
                                         const BrdfParts& parts = {}) const;
    /// As Brdf::albedo.
    WithDerivatives<AlbedoValues> albedo(const std::vector<double>& mu_in) const;

    const std::vector<std::string>& parameters() const;  ///< names

  private:
    friend class Brdf;
    struct State;
    explicit BrdfDerivatives(std::shared_ptr<const State> state) : state_(std::move(state)) {}

    std::shared_ptr<const State> state_;
};

struct BrdfState;  // private

/// Where the diffuse light comes from. Radiances are relative: only their shape counts.
struct Sky {
    enum class Kind {
        uniform,
        cie_clear,     ///< CIE S 003 (1996): brighter around the sun and to the horizon
        cie_overcast,  ///< CIE S 003 (1996): (1 + 2 mu) / 3, whatever the sun does
        table,
    };
    Kind kind = Kind::uniform;
    // Of a table, ascending each; linear between them, beyond their ends the last value.
    std::vector<double> wavelength_nm = {};  ///< empty: the same at all wavelengths
    std::vector<double> zenith_deg = {};     ///< in [0, 90]
    std::vector<double> azimuth_deg = {};    ///< from the sun, in [0, 360]; up to 180: symmetric
    std::vector<double> values = {};  ///< [(wavelength * zeniths + zenith) * azimuths + azimuth]
    std::string file = {};            ///< where the table comes from, for messages

    /// @param mu             of the point of the sky, in (0, 1]
    /// @param from_sun_deg   its azimuth, 0 = the sun's
    /// @throws InputError  for a wavelength that a table does not cover
    double radiance(double mu, double from_sun_deg, double mu_sun, double at_nm) const;
};

/// Reads `uniform`, `cie-clear`, `cie-overcast` or `FILE.csv` with the columns
/// zenith_deg,azimuth_deg,radiance and perhaps wavelength_nm: every combination once.
/// @throws UsageError, InputError
Sky sky(const std::string& text);

/// A scene at some wavelengths. Copies share one solution; functions may be called from several
/// threads. Single scattering is computed when it is first needed, as much of it as is needed, and
/// kept.
class Brdf {
  public:
    /// Exact at the directions asked for: nothing is interpolated. Nodes, moments and Fourier
    /// orders are chosen for these directions.
    /// @throws UsageError  for directions out of range; InputError, Cancelled
    BrdfValues evaluate(const Directions& directions, const BrdfParts& parts = {}) const;

    /// Fourier order 0 alone, without phase functions.
    AlbedoValues albedo(const std::vector<double>& mu_in) const;

    /// The Mueller matrix: light with its polarisation, options().stokes components or 3.
    /// @throws UsageError  for directions out of range, and for scenes that polarised light cannot
    /// be
    ///         computed of (surface, boundary, mirror, crowded particles, methods by name), with
    ///         the reason
    MuellerValues mueller(const Directions& directions) const;

    /// Hemispherical-directional reflectance factors: radiance reflected into mu_out over that of a
    /// white Lambertian surface in the same light, (1 - d) pi f + d A(mu_out). Of the irradiance
    /// the share d = diffuse_fraction is uniform over the sky, the rest the sun at mu_in
    /// (Schaepman-Strub et al., Remote Sens. Environ. 103, 27 (2006), eq. 14). The integral of f
    /// over all incidences is the plane albedo A at mu_out, by reciprocity.
    /// @throws UsageError  for directions out of range, diffuse_fraction outside [0, 1], and
    ///         diffuse light on a surface whose coupling is not reciprocal
    HdrfValues hdrf(const Directions& directions, double diffuse_fraction) const;
    /// Under a sky that is not uniform: the diffuse part is the integral of pi f L mu over the sky
    /// over that of L mu, by Gauss nodes in cosine and azimuth (error_estimate has the difference
    /// from half as many). BRDFs are exact at each node.
    /// @throws UsageError  likewise, and InputError for wavelengths that a table does not cover
    HdrfValues hdrf(const Directions& directions, double diffuse_fraction, const Sky& sky) const;

    /// Single scattering by every layer at every wavelength, from the lowest up; nothing of
    /// radiative transfer.
    std::vector<LayerOptics> layers() const;

    /// For those who evaluate millions of directions.
    /// @throws UsageError  for the surface's part of a scene without one, and for components of
    /// light
    ///         that it cannot be computed of (as mueller); Cancelled
    BrdfTable table(const TableOptions& options = {}) const;

    /// How well the scene is solved at directions of all kinds, steep and grazing.
    ResultReport report() const;

    /// Values with derivatives by numbers of the scene: those that have a name (named_numbers),
    /// `n(NAME)` and `k(NAME)`, the index of a material or host at the wavelength of the value.
    /// @throws UsageError  for a parameter that the scene does not have
    BrdfDerivatives derivatives(const std::vector<std::string>& parameters) const;

    const Scene& scene() const;                        ///< as given to solve()
    const std::vector<double>& wavelength_nm() const;  ///< nm, as given to solve()
    const SolverOptions& options() const;              ///< as given to solve()
    const std::vector<std::string>& sources() const;   ///< one line for each medium

  private:
    friend struct BrdfState;
    explicit Brdf(std::shared_ptr<const BrdfState> state) : state_(std::move(state)) {}

    std::shared_ptr<const BrdfState> state_;
};

/// Looks names up and checks everything; the work is done when values are asked for.
/// @param wavelength_nm  in vacuum, at least one
/// @throws UsageError  for scenes, wavelengths and options out of range
/// @throws InputError  for unknown names and wavelengths that a material does not cover
Brdf solve(const Scene& scene, const std::vector<double>& wavelength_nm,
           const SolverOptions& options = {}, const Control& control = {});

/// Provenance::component of a FilmTransmission.
inline constexpr char kTransmitted[] = "transmitted";

/// The BTDF of a film in air (substrate none, or black without a boundary), 1/sr without the
/// cosine: light from mu_in above leaves below at mu_out, the cosine from the normal of that side;
/// azimuth 0 goes straight on. From below upwards the BTDF is the same with mu_in and mu_out
/// exchanged, as both sides are in air. Light as a number, without polarisation; made for
/// export_brdf and for loops, as BrdfTable. Copies share their data. Spheres of several wavelengths
/// send most of their light into a narrow cone about the straight beam, of which what is scattered
/// twice and more is spread too widely (delta-M): `report` has the light that is missing.
class FilmTransmission : public BrdfSource {
  public:
    /// Solves all wavelengths.
    /// @throws UsageError  with the reason where nothing passes or no direction of it is known:
    ///         half-spaces, grounds, metals, surfaces, rough boundaries
    explicit FilmTransmission(const Brdf& film, const std::string& command_line = {});

    const std::vector<std::string>& channels() const override;
    const std::vector<double>& wavelength_nm() const override;
    /// left_out tells the unscattered share, a delta that no value holds.
    const Provenance& provenance() const override;
    /// @throws UsageError  as BrdfTable
    void evaluate(std::span<const Direction> directions, std::span<double> values) const override;

    /// The share of a beam that passes without being scattered, in [0, 1]; all else that passes is
    /// the integral of BTDF times mu_out.
    /// @throws UsageError  for an index beyond its list and a cosine outside (0, 1]
    double unscattered(std::size_t wavelength, double mu_in) const;

    /// Its error estimates include the light that the directions and the unscattered share together
    /// miss of the plane transmittance along the normal, relative to that.
    const ResultReport& report() const;

  private:
    struct State;
    std::shared_ptr<const State> state_;
};

}  // namespace miebrdf
#pragma GCC visibility pop
