// Radiative transfer of one wavelength for who has the optics of the layers: reflection and albedos
// of coats on a base, of light as a number or with its polarisation. Symbols, signs, planes and
// normalisation: docs/conventions.md, docs/maths-polarisation.md.
#pragma once

#include <functional>
#include <memory>
#include <vector>

#include <miebrdf/optics.h>
#include <miebrdf/solver.h>
#include <miebrdf/surface.h>

#pragma GCC visibility push(default)
namespace miebrdf::rte {

/// Light as it is solved, and what of it is wanted.
struct SolvedLight {
    int components;       ///< 1: a number; 3: (I, Q, U); 4: with V
    bool intensity_only;  ///< of the Mueller matrices element 11 alone is wanted

    SolvedLight(int solved = 1, bool intensity = false)
        : components(solved), intensity_only(intensity) {}

    /// Rows and columns of the matrices that are wanted.
    int shown() const { return intensity_only ? 1 : components; }
};

/// Sees each solution that is not the last one, and the number of nodes that comes next; false: no
/// more of them. Those who estimate the work ahead look in here.
using RefinementCallback = std::function<bool(const SolverReport& report, int next_streams)>;

struct SolutionParts;  // private

/// Memory that stacks solved one after the other in the same directions use again: matrices,
/// grids and Legendre tables, for each number of nodes up to 64 of their own. Results are the same
/// to the last bit. Not thread-safe.
class SolutionMemory {
  public:
    SolutionMemory();
    ~SolutionMemory();
    SolutionMemory(SolutionMemory&&) noexcept;
    SolutionMemory& operator=(SolutionMemory&&) noexcept;

  private:
    friend struct SolutionParts;
    std::unique_ptr<SolutionParts> parts_;
};

/// R of c x c elements (SolvedLight::shown) at pairs of directions; BRDF = R / pi. A matrix takes
/// the Stokes vector of the incident light to that of the reflected light, each with Q = parallel
/// minus perpendicular to its own meridian plane (ray and normal; of a vertical ray the limit at
/// this azimuth). U and V change their sign with the sense of the azimuth: R(-azimuth) = D
/// R(azimuth) D, D = diag(1, 1, -1, -1). Reciprocity: R(mu_in, mu_out, azimuth) = G R(mu_out,
/// mu_in, azimuth)^T G, G = diag(1, 1, 1, -1).
struct ReflectionTable {
    int components = 1;  ///< c = 1, 3 or 4
    /// [(((i * mu_out.size() + o) * azimuth_deg.size() + a) * c + row) * c + column], row =
    /// outgoing component, column = incident component; at mu_in[i], mu_out[o], azimuth_deg[a].
    std::vector<double> reflection;
    /// At each mu_in, from the same solution, the mirror's part included: the reflected share of
    /// the flux of unpolarised light; NaN if it is not physical.
    std::vector<double> plane_albedo;
    /// At each mu_in: what it changes by if the light is fully polarised parallel to the plane of
    /// incidence (Q = I); minus that for perpendicular light, 0 for U and V. Empty for light as a
    /// number.
    std::vector<double> polarised_plane_albedo;
    /// At each mu_in, c x c, what is reflected into the mirror direction and nowhere else, by
    /// boundaries and mirrors: a delta that `reflection` is without. Empty where there is none.
    std::vector<double> mirror_reflectance;
    /// The estimated error of each value of `reflection`, relative to the largest at its incidence.
    /// Empty where c > 1.
    std::vector<double> errors;
    bool steps_converged = false;  ///< all but the comparison with other numbers of nodes
    SolverReport report;
};

/// Albedos of a stack.
struct AlbedoTable {
    std::vector<double> plane_albedo;            ///< as of ReflectionTable
    std::vector<double> polarised_plane_albedo;  ///< as of ReflectionTable
    double spherical_albedo = 0.0;               ///< of uniform unpolarised light from everywhere
    /// Net flux into what lies below the layers, where that is a ground or nothing: one for each
    /// mu_in, then that of uniform light. Empty for half-spaces.
    std::vector<double> transmittance;
    /// The part of it that nothing has scattered, at each mu_in; 0 for half-spaces and below rough
    /// boundaries.
    std::vector<double> unscattered_transmittance;
    /// At each mu_in what is reflected into the mirror direction and nowhere else, of unpolarised
    /// light; empty where there is none.
    std::vector<double> mirror_reflectance;
    SolverReport report;
};

/// @throws UsageError  naming the cosine, azimuth or option that is out of range
void validate(const Directions& directions);
void validate(const SolverOptions& options);

/// R at the directions asked for, by the equations themselves: nothing is interpolated.
/// @param memory   where stacks are solved one after the other; null: of its own
/// @param refined  hears of the numbers of nodes that are tried
/// @throws UsageError  for optics, optical depths, cosines, azimuths or options out of range. Not
///         converging is an outcome.
ReflectionTable reflect(const Stack& stack, const Directions& directions,
                        const SolverOptions& options = {}, SolutionMemory* memory = nullptr,
                        const RefinementCallback& refined = {});

/// Reflection of light with its polarisation. Media are polarising as Optics::polarisation says;
/// grounds (Lambertian, black) return unpolarised light; smooth boundaries and mirrors polarise by
/// Fresnel's equations. Errors are relative to the largest element that is wanted at an incidence.
/// @param light    3 components: V left out, with b2 (R11 changes by less than 2e-6 with spheres);
///                 4
/// @param options  the methods must be `automatic`
/// @throws UsageError  for what `reflect` refuses, for components other than 3 and 4, other
///         methods and a rough boundary
ReflectionTable reflect_polarised(const Stack& stack, const Directions& directions,
                                  const SolvedLight& light, const SolverOptions& options = {},
                                  SolutionMemory* memory = nullptr,
                                  const RefinementCallback& refined = {});

/// Plane albedo at each mu_in and spherical albedo: Fourier order 0 alone.
/// The paper's stepwise coat methods have no transmittance.
/// @param surface  the weights of a surface above the layers at a cosine in (0, 1], smooth in it;
///                 empty: no surface, all weights are 1. Both albedos are of the light that it lets
///                 in, and count what it lets out:
///                     A(mu_in) = 2 integral of R^0(mu, mu_in) out(mu) mu dmu,
///                     spherical = integral of in(mu) A(mu) mu dmu / integral of in(mu) mu dmu.
/// @param memory   where albedos of stacks are found one after the other; null: of its own
AlbedoTable albedo(const Stack& stack, const std::vector<double>& mu_in,
                   const SolverOptions& options = {},
                   const std::function<SurfaceWeights(double mu)>& surface = {},
                   SolutionMemory* memory = nullptr);
/// @param table  overwritten; its memory is used again
void albedo(const Stack& stack, const std::vector<double>& mu_in, const SolverOptions& options,
            const std::function<SurfaceWeights(double mu)>& surface, SolutionMemory& memory,
            AlbedoTable& table);

/// Albedos of light with its polarisation: order 0 of I and Q.
/// @throws UsageError  as reflect_polarised
AlbedoTable polarised_albedo(const Stack& stack, const std::vector<double>& mu_in,
                             const SolverOptions& options = {}, SolutionMemory* memory = nullptr);

}  // namespace miebrdf::rte
#pragma GCC visibility pop
