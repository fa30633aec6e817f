// Light scattered exactly once: known in closed form for any phase function and any layers. Fourier
// sums, tables, error estimates and pages all ask here.
#pragma once

#include <Eigen/Core>
#include <algorithm>
#include <cmath>
#include <cstddef>
#include <limits>
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
    void find_polarised_ratio(double mu_in, double mu_out, std::span<const double> cos_azimuth,
                              std::span<double> ratio) const;
    /// The Mueller matrix between the meridian planes.
    Eigen::Matrix4d matrix(double mu_in, double mu_out, double azimuth_deg) const;

  private:
    const ScaledStack* stack_;
    std::vector<Optics> seen_;  ///< empty: the media themselves
};

/// A smooth boundary to a medium of index n leaves t(mu_in) t(mu_out) / n^2 of straight light.
double straight_paths_factor(double index, double mu_in_air, double mu_out_air);

/// The lobe of light that a rough boundary reflects by one facet.
SurfaceLobe outer_lobe(const Boundary& boundary, double index);

/// Of a rough boundary over mirrors, whose series has no end. Without the narrowest lobe
/// (MirroredLobe) the orders of the roughness 0.02 have fallen to 1e-4 of the first within so many.
inline constexpr int kMostBoundaryOrders = 192;

/// The lobe that mirrors below a rough boundary send back through it is as narrow as the facets
/// allow: Fourier orders within which it falls to 1e-4 of the first.
int mirrored_lobe_orders(const ScaledStack& stack);
/// Adds MirroredLobe of a stack below a rough boundary.
void add_mirrored_lobe(std::vector<double>& reflection, const Directions& directions,
                       const ScaledStack& stack);

/// R of light scattered once by media without boundaries between them or above.
double single_scattering(const std::vector<ScaledMedium>& media, bool exact, double mu_in,
                         double mu_out, double cos_azimuth);

/// Whether light comes back within 5 degrees of where it came from.
/// Order: [(in * mu_out.size() + out) * azimuth_deg.size() + azimuth]
std::vector<bool> near_retro_reflection(const Directions& directions);

/// Adds what is scattered once to reflection functions or Mueller matrices: exactly, or as the
/// discrete equations see it, by SolverOptions::single_scattering_correction. Of a rough boundary
/// it adds the lobe that one facet reflects, and the one that mirrors below send back through it.
///
/// Exact phase functions do not depend on the number of nodes, nor does what their narrow features
/// scatter from degrees on that delta-M cuts off: both are evaluated once, at the first call, and
/// kept (8 bytes for each direction, and for each medium as many, or 48 of a matrix).
class FirstOrderSum {
  public:
    /// @param directions  in air; must outlive this
    /// @param components  of light: 1 (numbers), 3 or 4 (matrices)
    /// @param shown       c, of the matrices: as many, or 1 for element 11 alone
    FirstOrderSum(const Directions& directions, const SolverOptions& options, int components,
                  int shown);
    FirstOrderSum(const Directions& directions, const SolverOptions& options)
        : FirstOrderSum(directions, options, 1, 1) {}

    /// @param reflection  [((in * mu_out.size() + out) * c^2 + row * c + column) *
    ///                    azimuth_deg.size() + azimuth], added to
    /// @param stack       the same at every call; delta-M may differ
    /// @param unresolved  null, or set to the part of narrow features that the nodes do not
    ///                    resolve, known but roughly; empty: there is none
    void add_to(std::vector<double>& reflection, const ScaledStack& stack,
                std::vector<double>* unresolved = nullptr);

  private:
    /// P or F of each medium at each direction, [medium * directions + direction].
    struct Scattered {
        std::vector<double> phase;
        std::vector<ScatteringMatrix> matrix;
    };
    std::size_t pairs() const { return directions_.mu_in.size() * directions_.mu_out.size(); }
    void add_outer_lobe(std::vector<double>& reflection, const ScaledStack& stack) const;
    void evaluate(const FirstOrder& first_order);
    /// The change by narrow features, without the boundary.
    std::vector<double> narrow_change(const FirstOrder& first_order,
                                      std::vector<double>* unresolved);
    /// Whether these media, too, have what is kept.
    bool has_kept_narrow(const std::vector<ScaledMedium>& media) const;
    void keep_narrow(const std::vector<ScaledMedium>& media);

    const Directions& directions_;
    bool is_polarised_;
    int shown_;
    SolverOptions options_;
    std::vector<double> cos_azimuth_;
    Directions inside_;  ///< as straight light has them in the medium
    double mu_least_ = 1.0;
    Scattered back_, forward_;
    bool narrow_is_known_ = false;
    /// Narrow features from this degree on are kept.
    int first_kept_ = std::numeric_limits<int>::max();
    std::vector<ForwardPeak> kept_;     ///< of each medium, from that degree on
    std::vector<double> narrow_;        ///< what they scatter, at each direction; none: empty
    std::vector<double> narrow_phase_;  ///< and their part of P, as Scattered::phase
};

}  // namespace miebrdf::rte
