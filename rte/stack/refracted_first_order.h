// Light scattered once in layers under a refracting boundary or over a mirror: beams bend, and come
// back from below.
#pragma once

#include <memory>
#include <vector>

#include <miebrdf/solver.h>
#include "rte/first_order/first_order.h"
#include "rte/stack/stack_solver.h"

namespace miebrdf::rte {

/// A beam from one direction in air as it passes one medium without being scattered: shares of its
/// energy, all returns between boundaries and mirrors added up.
struct Beam {
    double mu = 1.0;    ///< in the medium
    double down = 0.0;  ///< at its top
    double up = 0.0;    ///< at its bottom, sent back by what lies below
};

/// In all media, from the bottom up as they are listed.
std::vector<Beam> beams_of(const ScaledStack& stack, double mu_air);

/// What of light from a direction in air leaves into its mirror direction without being scattered:
/// by boundaries and mirrors together.
double mirror_reflectance(const ScaledStack& stack, double mu_air);

/// What comes back of light under the topmost boundary without being scattered.
/// @param mu  in the topmost medium
double unscattered_return(const ScaledStack& stack, double mu);

/// Fourier orders within which that lobe falls to 1e-4 of the first.
int mirrored_lobe_orders(const ScaledStack& stack);
/// Adds MirroredLobe of a stack below a rough boundary.
void add_mirrored_lobe(std::vector<double>& reflection, const Directions& directions,
                       const ScaledStack& stack);

/// What light scattered once in a medium counts at a pair of directions: `back` times the strength
/// (first_order_strength) at the angle between a beam down and one up, `forward` times that between
/// two beams that go the same way.
struct FirstOrderPaths {
    double mu_in = 1.0, mu_out = 1.0;  ///< in the medium
    double back = 0.0, forward = 0.0;
};

/// @param in, out  beams of the medium
FirstOrderPaths first_order_paths(const ScaledMedium& medium, const Beam& in, const Beam& out);

/// The cosine of the angle of forward scattering: both beams go down, or both up.
double cos_forward_angle(double mu_in, double mu_out, double cos_azimuth);

/// (exp(-tau / mu) - exp(-tau / mu')) / (mu - mu'), 0 for a layer without bottom.
double forward_quotient(double tau, double mu, double other);

/// Whether all light scattered once goes straight in and out: one index, no mirror below.
bool has_straight_paths(const ScaledStack& stack);

/// What a smooth boundary to a medium of index n leaves of such light: t(mu_in) t(mu_out) / n^2; 1
/// without one.
double straight_paths_factor(double index, double mu_in_air, double mu_out_air);

/// The lobe of light that a rough boundary reflects by one facet.
SurfaceLobe outer_lobe(const Boundary& boundary, double index);

/// FirstOrderSum of any stack. A rough boundary lets no beam through: added are its
/// outer lobe, and the one that mirrors below send back through it.
class StackFirstOrder {
  public:
    /// @param directions  in air
    StackFirstOrder(const Directions& directions, const SolverOptions& options)
        : directions_(directions), options_(options) {}

    /// As FirstOrderSum::add_to.
    void add_to(std::vector<double>& reflection, const ScaledStack& stack,
                std::vector<double>* unresolved = nullptr);

  private:
    void add_straight(std::vector<double>& reflection, const ScaledStack& stack,
                      std::vector<double>* unresolved);
    void add_outer_lobe(std::vector<double>& reflection, const ScaledStack& stack) const;
    void add_all_paths(std::vector<double>& reflection, const ScaledStack& stack) const;

    const Directions& directions_;
    SolverOptions options_;
    Directions inside_;  ///< of the one index
    std::unique_ptr<FirstOrderSum> straight_;
};

}  // namespace miebrdf::rte
