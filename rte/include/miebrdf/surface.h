// Reflection by a rough surface, and what it lets through to the layers below.
// Symbols, signs and normalisation: docs/conventions.md; derivations: docs/maths-surface.md.
#pragma once

#include <array>
#include <complex>
#include <functional>
#include <memory>
#include <optional>
#include <span>

#include <miebrdf/language.h>

#pragma GCC visibility push(default)
namespace miebrdf::rte {

/// Density of the normals of the small mirrors that make up the surface.
enum class MicrofacetDistribution {
    beckmann,  ///< slopes are Gaussian (Beckmann & Spizzichino 1963)
    ggx,       ///< longer tails (Trowbridge & Reitz 1975; Walter et al. 2007)
};

/// The share of the mirrors that is lit and seen.
enum class Shadowing {
    smith_correlated,  ///< G = 1 / (1 + Lambda_in + Lambda_out): heights of both rays correlate
    smith_separable,   ///< G = G1(in) G1(out), G1 = 1 / (1 + Lambda)
    v_cavity,          ///< Torrance & Sparrow 1967: long symmetric grooves
};

enum class FresnelKind {
    exact,    ///< unpolarised Fresnel reflectance of n + ik
    schlick,  ///< Schlick 1994 with the exact reflectance at normal incidence
};

/// A surface of microfacets.
struct SurfaceOptions {
    double beckmann_alpha = 0.3;  ///< slope parameter of the distribution, in [1e-4, 4]
    MicrofacetDistribution distribution = MicrofacetDistribution::beckmann;  ///< D
    Shadowing shadowing = Shadowing::smith_correlated;                       ///< G
    FresnelKind fresnel = FresnelKind::exact;                                ///< F
    /// The distribution whose Lambda the Smith forms use. Empty: that of `distribution`, the only
    /// choice for which the visible mirrors add up to the surface that is seen.
    std::optional<MicrofacetDistribution> shadowing_distribution = {};
};

/// @throws UsageError  for a slope parameter out of range
void validate(const SurfaceOptions& options);

/// Refractive indices of media behind a boundary to air.
inline constexpr double kLeastIndex = 1.0;
inline constexpr double kLargestIndex = 3.0;
inline constexpr double kLeastRoughIndex = 1.05;  ///< behind a rough boundary
/// A relative step of the index below this is no boundary: it changes light of cosine mu by about
/// step / mu^2 of itself, which is 1e-5 at mu .1.
inline constexpr double kLeastIndexStep = 1e-7;

/// Where the matrices of a rough boundary come from.
enum class BoundaryMatrices {
    followed,      ///< rays are followed for this very index
    interpolated,  ///< a parabola through indices .01 apart: for hosts whose index varies with the
                   ///< wavelength, of which few matrices serve many wavelengths
};

/// A refracting boundary between air and the medium below it.
struct Boundary {
    /// Slope parameter of the microfacets, in [0.02, 1]; 0: smooth.
    double roughness = 0.0;
    MicrofacetDistribution distribution = MicrofacetDistribution::ggx;  ///< of the microfacets
    BoundaryMatrices matrices = BoundaryMatrices::followed;

    bool is_rough() const { return roughness > 0.0; }  ///< has a roughness
    bool operator==(const Boundary&) const = default;
};

/// @throws UsageError  for a roughness out of range
void validate(const Boundary& boundary);

/// An integral and how it came about.
struct IntegralResult {
    double value = 0.0;           ///< of the integral
    double error_estimate = 0.0;  ///< absolute, from the last two doublings of the nodes
    int nodes = 0;                ///< for each of the two dimensions
    bool converged = false;       ///< error_estimate <= tolerance
};

/// rho_dt(mu_in): the integral of R_s mu_out over the outgoing hemisphere.
///
/// Taken over the slopes of the mirrors' normals instead of over mu_out, where the lobe has the
/// same shape for every roughness and incidence; with the slopes measured along the plane of
/// incidence (x, towards the light) and across it (y) and P their density,
///     rho = integral of P(x, y) (1 + x tan(theta_in)) G F dx dy,  (x - tan)^2 + y^2 < 1 / mu_in^2.
/// Gauss nodes in coordinates in which P is smooth and bounded; their number is doubled until the
/// result moves by less than the tolerance. docs/maths-surface.md derives it and has the measured
/// errors.
///
/// @param mu_in  in (0, 1]
/// @param tolerance  absolute, > 0
/// @throws UsageError  for an index, options, cosine or tolerance out of range
IntegralResult directional_reflectance(std::complex<double> refractive_index,
                                       const SurfaceOptions& options, double mu_in,
                                       double tolerance = 1e-6);

/// Weights of the directions of incidence in a mean over the hemisphere.
enum class HemisphereMean {
    solid_angle,  ///< all directions alike: integral over mu in (0, 1)
    cosine,       ///< as a diffuse illumination arrives: 2 * integral over mu dmu
};

/// Mean of 1 - rho(mu). With `solid_angle` this is the averaged diffuse reflectance factor of
/// Chen et al. 2013, Table 1 (which says neither which mean nor which G; <miebrdf/table1.h>).
///
/// Gauss nodes in t with mu = t^2, so that the steep end at grazing is resolved for small
/// roughness too; doubled until the mean moves by less than the tolerance.
///
/// @param rho  directional reflectance, called for mu in (0, 1)
/// @param tolerance  absolute, > 0; the error of `rho` itself is not seen
IntegralResult mean_transmittance(const std::function<double(double mu)>& rho, HemisphereMean mean,
                                  double tolerance = 1e-5);

/// Torrance-Sparrow lobe R_s = D(h) G F / (4 mu_in mu_out) of one material at one wavelength.
/// Reciprocal; reflects no more than it receives as long as D and Lambda belong together.
class SurfaceLobe {
  public:
    /// @param refractive_index  n + ik of the top material, n > 0, k >= 0
    /// @throws UsageError  for an index or options out of range
    SurfaceLobe(std::complex<double> refractive_index, const SurfaceOptions& options);

    /// R_s in 1/sr, without the cosine.
    /// @param mu_in, mu_out  in (0, 1]
    /// @param azimuth_deg  0 = mirror side, 180 = back towards the source
    /// @throws UsageError  for a cosine out of range or an azimuth that is not finite
    double brdf(double mu_in, double mu_out, double azimuth_deg) const;

    /// rho_dt(mu_in), integral of R_s mu_out over the outgoing hemisphere, to 1e-6.
    /// rte::directional_reflectance has the same with its error estimate.
    double directional_reflectance(double mu_in) const;

    /// Mean of 1 - rho_dt over directions of incidence, uniform in solid angle, to 1e-5:
    /// Chen et al. 2013, Table 1.
    double averaged_diffuse_reflectance_factor() const;

    std::complex<double> refractive_index() const;  ///< n + ik
    const SurfaceOptions& options() const;          ///< as given

  private:
    struct Model;
    std::shared_ptr<const Model> model_;
};

/// How the layers below are weakened by what the surface reflects.
enum class SurfaceCoupling {
    paper,       ///< 1 - rho(mu_in): Chen et al. 2013, eq. (5); not reciprocal
    reciprocal,  ///< (1 - rho(mu_in)) (1 - rho(mu_out)), normalised
};

/// The effect of a surface on light on its way in and out, as far as albedos of the layers see it.
struct SurfaceWeights {
    double in = 1.0;   ///< share of the light from mu that gets to the layers
    double out = 1.0;  ///< what light that leaves the layers towards mu counts
};

/// How much of the subsurface BRDF R / pi is seen through the surface:
///     f = R_s + in(mu_in) out(mu_out) R / pi.
///
/// `paper`, Chen et al. 2013, eq. (5): in = 1 - rho, out = 1. Every incidence reflects
/// rho + (1 - rho) A, A being the layers' plane albedo, but f is not reciprocal.
/// `reciprocal`: in = 1 - rho(mu_in), out = (1 - rho(mu_out)) / T with T = 2 integral of
/// (1 - rho) mu dmu (Kelemen & Szirmay-Kalos 2001). For Lambertian layers of albedo A every
/// incidence again reflects rho + (1 - rho) A; for other layers the mean over a diffuse
/// illumination may differ from the paper's, up to max(1 - rho) / T (docs/maths-surface.md).
class SurfaceTransmission {
  public:
    /// The weights of this lobe.
    SurfaceTransmission(const SurfaceLobe& lobe, SurfaceCoupling coupling);

    /// @param mu  in (0, 1]
    double in(double mu) const;
    double out(double mu) const;              ///< weight, >= 0
    SurfaceWeights weights(double mu) const;  ///< both, from one rho

  private:
    SurfaceLobe lobe_;
    SurfaceCoupling coupling_;
    double mean_transmittance_ = 1.0;
};

/// A parameter of a ground's BRDF, and its range.
struct GroundParameter {
    const char* name;
    double low, high;  ///< the range, in the unit of the parameter: 1, or degrees (thetabar)
};

/// A model of natural grounds: its name in words of scenes and its parameters in their order.
struct GroundModel {
    const char* name;
    std::span<const GroundParameter> parameters;
    std::size_t needed;  ///< so many are given at least; rhoc is rho0 where it is not
};

/// In the order of GroundBrdf::Kind.
std::span<const GroundModel> ground_models();

/// The BRDF of a natural ground by a closed form of few parameters, reciprocal:
/// `rpv` rho0, k, theta, rhoc (Rahman, Pinty & Verstraete 1993; theta < 0 scatters backwards);
/// `ross_li` weights of the constant, Ross-thick and reciprocal Li-sparse kernels of MODIS (Lucht,
/// Schaaf & Strahler 2000); `hapke` w, b, c, b0, h, thetabar in degrees (Hapke 2012: two
/// Henyey-Greenstein lobes of asymmetry b, (1 + c) / 2 of them backwards, shadow-hiding surge of
/// height b0 and width h, macroscopic roughness). Nothing keeps their energy: see energy_of.
struct GroundBrdf {
    enum class Kind { rpv, ross_li, hapke };
    Kind kind = Kind::rpv;
    std::array<double, 6> values =
        {};  ///< of the model's parameters in their order, in the range and unit of each

    bool operator==(const GroundBrdf&) const = default;
    const GroundModel& model() const;  ///< names and ranges of its parameters
    /// R = pi BRDF; a white Lambertian surface has 1.
    /// @param mu_in, mu_out  in (0, 1]
    /// @param cos_azimuth    1 = mirror side, -1 = back towards the source
    double reflection(double mu_in, double mu_out, double cos_azimuth) const;
};

/// @throws UsageError  naming the parameter that is out of range
void validate(const GroundBrdf& ground);

/// What a ground returns, by 16 cosines: some per cent.
struct GroundEnergy {
    double spherical_albedo = 0.0;
    double above_one_below_mu = 0.0;  ///< the plane albedo is above 1 at this mu_in; 0: nowhere
    bool is_negative = false;         ///< R is, somewhere
};
/// Integrates R over all directions; 4,096 values of it, about .5 ms.
GroundEnergy energy_of(const GroundBrdf& ground);

}  // namespace miebrdf::rte
#pragma GCC visibility pop
