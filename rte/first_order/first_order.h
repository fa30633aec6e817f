// Light scattered exactly once: known in closed form for any phase function and any layers. Fourier
// sums (first_order_sum.h), tables, error estimates and pages all ask here.
#pragma once

#include <Eigen/Core>
#include <algorithm>
#include <cmath>
#include <cstddef>
#include <functional>
#include <span>
#include <vector>

#include <miebrdf/solver.h>
#include <miebrdf/surface.h>
#include "rte/phase/stack_of_media.h"

namespace miebrdf::rte {

/// The angles between a pair of directions at all azimuths, as cosines kept in [-1, 1].
class ScatteringAngles {
  public:
    ScatteringAngles(double mu_in, double mu_out)
        : cosines_(mu_in * mu_out),
          sines_(std::sqrt((1.0 - mu_in) * (1.0 + mu_in) * (1.0 - mu_out) * (1.0 + mu_out))) {}

    /// cos Theta = -mu_in mu_out + sqrt(1-mu_in^2) sqrt(1-mu_out^2) cos(azimuth).
    double back(double cos_azimuth) const {
        return std::clamp(sines_ * cos_azimuth - cosines_, -1.0, 1.0);
    }
    /// cos Theta of light that goes on: both beams go down, or both up.
    double forward(double cos_azimuth) const {
        return std::clamp(sines_ * cos_azimuth + cosines_, -1.0, 1.0);
    }

  private:
    double cosines_, sines_;
};
inline double cos_scattering_angle(double mu_in, double mu_out, double cos_azimuth) {
    return ScatteringAngles(mu_in, mu_out).back(cos_azimuth);
}

/// P(cos Theta) of the medium: its own function if it has one, else the sum of all its moments.
double exact_phase(const Optics& optics, double cos_theta);

/// Light that goes straight in and out adds alpha P / (1 - alpha f) times these weights to R:
/// (1 - exp(-tau' q)) / (4 (mu_in + mu_out)) weakened by the media above, q = 1/mu_in + 1/mu_out.
/// @param depth_of  tau' of medium k, from the top down
/// @param set       called with (k, weight)
template <typename DepthOf, typename Set>
void find_straight_weights(std::size_t media, const DepthOf& depth_of, double mu_in, double mu_out,
                           const Set& set) {
    const double slant = 1.0 / mu_in + 1.0 / mu_out;
    double above = 0.25 / (mu_in + mu_out);  // what is left on the way through the media above
    for (std::size_t k = 0; k < media; ++k) {
        const double x = slant * depth_of(k);
        set(k, -above * std::expm1(-x));
        if (k + 1 < media) above *= std::exp(-x);  // 1 + expm1(-x) has no digits of faint light
    }
}

/// dR/dP of one medium at a pair of directions.
struct PhaseWeights {
    double mu_in = 1.0, mu_out = 1.0;  ///< in the medium
    double back = 0.0;                 ///< at ScatteringAngles::back
    /// At ScatteringAngles::forward: light that mirrors or boundaries send up before or after.
    double forward = 0.0;
};

/// Light scattered once by a stack, as it leaves into air. Boundaries bend it and send it back,
/// mirrors return it. A rough boundary lets no beam through: below it there is none.
class FirstOrder {
  public:
    /// @param stack  must outlive this
    /// @param exact  true: the exact phase functions (Nakajima & Tanaka 1988, TMS); false: the
    ///               moments that the discrete equations use
    FirstOrder(const ScaledStack& stack, bool exact);

    const ScaledStack& stack() const { return *stack_; }
    /// A medium as light scattered once sees it.
    const Optics& optics(std::size_t medium) const {
        return seen_.empty() ? stack_->media[medium].exact : seen_[medium];
    }
    /// Whether all of it goes straight in and out: one index, no mirror below.
    bool is_straight() const { return !stack_->has_mirrors(); }

    /// One entry for each medium, from the bottom up: R is the sum of their P times these.
    /// @param list  overwritten; its memory is used again
    void find_weights(double mu_in, double mu_out, std::vector<PhaseWeights>& list) const;
    std::vector<PhaseWeights> weights(double mu_in, double mu_out) const {
        std::vector<PhaseWeights> list;
        find_weights(mu_in, mu_out, list);
        return list;
    }
    double reflection(double mu_in, double mu_out, double cos_azimuth) const;
    /// Element 11 of the Mueller matrix over `reflection`, which knows no polarisation by
    /// boundaries and mirrors: ratio[a]; 1 where nothing is reflected.
    /// @param matrix_at  the scattering matrix of a medium at the cosine of an angle; of a1, a2, a3
    ///                   and b1 alone
    void find_polarised_ratio(
        double mu_in, double mu_out, std::span<const double> cos_azimuth, std::span<double> ratio,
        const std::function<ScatteringMatrix(std::size_t medium, double cos_angle)>& matrix_at)
        const;
    /// The Mueller matrix between the meridian planes.
    Eigen::Matrix4d matrix(double mu_in, double mu_out, double azimuth_deg) const;

  private:
    const ScaledStack* stack_;
    std::vector<Optics> seen_;  ///< empty: the media themselves
};

/// R of light that a ground of BaseKind::brdf reflects and nothing scatters; 0 of other stacks.
double ground_reflection(const ScaledStack& stack, double mu_in, double mu_out, double cos_azimuth);

/// A smooth boundary to a medium of index n leaves t(mu_in) t(mu_out) / n^2 of straight light.
double straight_paths_factor(double index, double mu_in_air, double mu_out_air);

/// The lobe of light that a rough boundary reflects by one facet.
SurfaceLobe outer_lobe(const Boundary& boundary, double index);

/// Orders of a rough boundary over mirrors, whose series has no end. Without the narrowest lobe
/// (MirroredLobe) the orders of the roughness 0.02 have fallen to 1e-4 of the first within so many.
inline constexpr int kMostBoundaryOrders = 192;

/// Adds MirroredLobe of a stack below a rough boundary, as narrow as the facets allow.
void add_mirrored_lobe(std::vector<double>& reflection, const Directions& directions,
                       const ScaledStack& stack);
/// Its Fourier orders, at most kMostBoundaryOrders.
/// @param mu  in air
/// @return    R^m of all pairs of them
std::vector<Eigen::MatrixXd> mirrored_lobe_orders(const Eigen::VectorXd& mu,
                                                  const ScaledStack& stack);

/// R of light scattered once by media without boundaries between them or above.
double single_scattering(const std::vector<ScaledMedium>& media, bool exact, double mu_in,
                         double mu_out, double cos_azimuth);

}  // namespace miebrdf::rte
