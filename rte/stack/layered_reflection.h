// Reflection by coats on a base: the whole radiative transfer of one wavelength behind two
// functions. Symbols, signs and normalisation: docs/conventions.md.
#pragma once

#include <functional>
#include <memory>
#include <vector>

#include <miebrdf/optics.h>
#include <miebrdf/solver.h>
#include <miebrdf/surface.h>
#include "rte/grid/discretisation.h"

namespace miebrdf::rte {

/// What stacks solved one after the other use again, in directions that stay the same: matrices,
/// grids and Legendre tables, for each number of nodes up to 64 of their own. Results are the same
/// to the last bit. Not thread-safe.
class SolutionMemory {
  public:
    SolutionMemory();
    ~SolutionMemory();
    SolutionMemory(SolutionMemory&&) noexcept;
    SolutionMemory& operator=(SolutionMemory&&) noexcept;

    struct Parts;
    Parts& parts() { return *parts_; }

  private:
    std::unique_ptr<Parts> parts_;
};

/// reflection[(i * mu_out.size() + o) * azimuth_deg.size() + a] = R(mu_in[i], mu_out[o],
/// azimuth_deg[a]); BRDF = R / pi.
struct ReflectionTable {
    std::vector<double> reflection;
    /// At each mu_in, from the same solution, the mirror's part included; NaN if it is not
    /// physical.
    std::vector<double> plane_albedo;
    /// At each mu_in, what is reflected into the mirror direction and nowhere else, by boundaries
    /// and mirrors: a delta that `reflection` is without. Empty where there is none.
    std::vector<double> mirror_reflectance;
    /// Of each value of `reflection`, an estimate relative to the largest value at its incidence.
    std::vector<double> errors;
    bool steps_converged = false;  ///< all but the comparison with other numbers of nodes
    SolverReport report;
};

struct AlbedoTable {
    std::vector<double> plane_albedo;  ///< one for each mu_in, with the mirror's part
    double spherical_albedo = 0.0;     ///< of uniform light from everywhere
    /// Net flux into what lies below the layers, where that is a ground or nothing: one for each
    /// mu_in, then that of uniform light. Empty for half-spaces.
    std::vector<double> transmittance;
    /// Into the mirror direction and nowhere else, at each mu_in; empty where there is none.
    std::vector<double> mirror_reflectance;
    SolverReport report;
};

/// @throws UsageError  naming the cosine, azimuth or option that is out of range
void validate(const Directions& directions);
void validate(const SolverOptions& options);

/// R at the directions asked for, by the equations themselves: nothing is interpolated.
/// @param memory  where stacks are solved one after the other; null: of its own
/// @param watch   of the numbers of nodes that are tried
/// @throws UsageError  for optics, optical depths, cosines, azimuths or options out of range. Not
///         converging is an outcome.
ReflectionTable reflect(const Stack& stack, const Directions& directions,
                        const SolverOptions& options = {}, SolutionMemory* memory = nullptr,
                        const LadderWatch& watch = {});

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

}  // namespace miebrdf::rte
