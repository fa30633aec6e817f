// Derivatives of reflection and albedos by any number of a stack: of the discrete solution, with
// its nodes, moments and Fourier orders as they are (docs/derivatives.md).
#pragma once

#include <functional>
#include <span>
#include <vector>

#include <miebrdf/transfer.h>

namespace miebrdf::rte {

/// A stack with one number a little larger and a little smaller: the same layers, their optics made
/// by the same sums, so that differences are smooth.
struct StackChange {
    Stack plus, minus;
    double apart = 0.0;  ///< the difference of the two numbers
    /// The surface above the layers, for albedos, as of `albedo`; empty: that of the stack.
    std::function<SurfaceWeights(double mu)> surface_plus = {}, surface_minus = {};
};

/// For each change the derivatives of `reflection` and `mirror_reflectance`.
/// @param solved  of the stack, by `reflect` or `reflect_polarised`
/// @throws UsageError  where the derivative has no bound (require_bounded)
std::vector<ReflectionTable> reflection_derivatives(
    const Stack& stack, std::span<const StackChange> changes, const Directions& directions,
    const SolvedLight& light, const SolverOptions& options, const SolverReport& solved);

struct AlbedoQuestion {
    std::vector<double> mu_in;
    int components = 1;      ///< 3: polarised_albedo
    bool transmits = false;  ///< transmittances are wanted
};

/// For each change the derivatives of an AlbedoTable.
/// @param solved  of the stack, by `albedo` or `polarised_albedo`
std::vector<AlbedoTable> albedo_derivatives(const Stack& stack,
                                            std::span<const StackChange> changes,
                                            const AlbedoQuestion& question,
                                            const std::function<SurfaceWeights(double mu)>& surface,
                                            const SolverOptions& options,
                                            const SolverReport& solved);

/// Whether the derivative has a bound: a half-space that absorbs nothing reflects everything, and
/// what it absorbs rises like the square root of 1 - albedo.
bool is_bounded(const Stack& stack, const StackChange& change);

}  // namespace miebrdf::rte
