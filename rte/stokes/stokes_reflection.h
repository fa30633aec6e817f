// Reflection of polarised light by coats on a base: the Mueller matrix in place of the number.
// Symbols, signs and planes: docs/maths-polarisation.md.
#pragma once

#include <vector>

#include <miebrdf/optics.h>
#include <miebrdf/solver.h>
#include "rte/grid/discretisation.h"
#include "rte/stack/fourier_sum.h"
#include "rte/stack/stack_solver.h"

namespace miebrdf::rte {

/// R takes the Stokes vector of the incident light to that of the reflected light, each with Q =
/// parallel minus perpendicular to its own meridian plane (ray and normal; of a vertical ray the
/// limit at this azimuth); BRDF = R / pi. U and V change their sign with the sense of the azimuth:
/// R(-azimuth) = D R(azimuth) D, D = diag(1, 1, -1, -1). Reciprocity: R(mu_in, mu_out, azimuth) =
/// G R(mu_out, mu_in, azimuth)^T G, G = diag(1, 1, 1, -1).
struct MuellerTable {
    int components = 3;  ///< c: 3 for (I, Q, U), 4 with V
    /// [(((i * mu_out.size() + o) * azimuth_deg.size() + a) * c + row) * c + column], row =
    /// outgoing component, column = incident component; at mu_in[i], mu_out[o], azimuth_deg[a].
    std::vector<double> reflection;
    /// At each mu_in: the reflected share of the flux of unpolarised light; NaN if not physical.
    std::vector<double> plane_albedo;
    /// At each mu_in: what it changes by if the light is fully polarised parallel to the plane of
    /// incidence (Q = I); minus that for perpendicular light, 0 for U and V.
    std::vector<double> polarised_plane_albedo;
    /// At each mu_in the Mueller matrix, c x c, of what is reflected into the mirror direction and
    /// nowhere else, by boundaries and mirrors: a delta that `reflection` is without. Empty where
    /// there is none.
    std::vector<double> mirror_reflection;
    SolverReport report;
};

struct PolarisedAlbedoTable {
    std::vector<double> plane_albedo;            ///< as of MuellerTable
    std::vector<double> polarised_plane_albedo;  ///< as of MuellerTable
    double spherical_albedo = 0.0;               ///< of uniform unpolarised light from everywhere
    std::vector<double> transmittance;           ///< as of AlbedoTable, of unpolarised light
    std::vector<double> mirror_reflection;       ///< as of MuellerTable, 3 x 3
    SolverReport report;
};

/// R at the directions asked for, by the equations themselves: nothing is interpolated. Media are
/// polarising as Optics::polarisation says; grounds (Lambertian, black) return unpolarised light;
/// smooth boundaries and mirrors polarise by Fresnel's equations.
///
/// Errors are judged as those of `reflect`: relative to the largest element at that incidence.
/// @param components  3: V left out, with b2 (R11 changes by less than 2e-6 with spheres); 4
/// @param options     the methods must be `automatic`
/// @param watch       of the numbers of nodes that are tried
/// @throws UsageError  for what `reflect` refuses, for components other than 3 and 4, other
///         methods and a rough boundary
MuellerTable reflect_polarised(const Stack& stack, const Directions& directions, int components,
                               const SolverOptions& options = {}, const LadderWatch& watch = {});

/// Plane and spherical albedos: Fourier order 0 of I and Q alone.
/// @throws UsageError  as reflect_polarised
PolarisedAlbedoTable polarised_albedo(const Stack& stack, const std::vector<double>& mu_in,
                                      const SolverOptions& options = {});

/// The stack with as many moments as the longest list of its media's coefficients, so that whatever
/// chooses by the number of moments sees them all.
Stack with_all_moments(Stack stack);

/// Largest |b1| / a1 over all angles: how strongly single scattering polarises unpolarised light.
/// Light scattered again feels no more, so that the scalar solver's R11 is off by about this times
/// the degree of polarisation of the light inside. 0 without polarisation.
double strongest_polarisation(const Optics& optics);

struct TabulatedStokes {
    ScaledStack stack;  ///< as it was solved
    /// R^m for m = 0, 1, ... of light scattered more than once: StokesOrder::multiple, rows and
    /// columns the cosines of the table.
    FourierOrders orders;
    bool converged = true;
    bool physical = true;  ///< false: there may be no orders
};

/// Solves a stack with the nodes and moments of a solution that is known (reflect_polarised).
/// @param mu          cosines, of incidence and of reflection
/// @param components  3 or 4
TabulatedStokes tabulate_polarised(const Stack& stack, const std::vector<double>& mu,
                                   int components, const SolverReport& solved,
                                   const SolverOptions& options);

}  // namespace miebrdf::rte
