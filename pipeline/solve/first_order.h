// Light scattered once by layers, at several wavelengths and any directions.
#pragma once

#include <Eigen/Core>
#include <optional>
#include <span>
#include <vector>

#include "rte/first_order/first_order.h"
#include "rte/first_order/narrow_features.h"
#include "rte/math/chebyshev.h"
#include "rte/stack/refracted_first_order.h"

namespace miebrdf {

/// rte::single_scattering and rte::NarrowFeatures of some wavelengths side by side: what depends on
/// directions alone (angle of scattering, place in the tables, slant) is found once for all of
/// them. Phase functions are read from a table a hundred times finer than the tolerance.
class FirstOrder {
  public:
    /// Narrow features closer to the horizon are those of this cosine: beyond its end their table
    /// is a polynomial gone astray.
    static constexpr double kLeastCosine = 1e-3;

    /// @param stacks     for each wavelength the media from the bottom up
    /// @param exact      the exact phase functions and narrow features, else what the discrete
    ///                   equations use
    /// @param tolerance  the solver's
    FirstOrder(const std::vector<std::vector<rte::ScaledMedium>>& stacks, bool exact,
               double tolerance);

    std::size_t wavelengths() const { return wavelengths_; }

    /// What the layers of the first wavelength scatter once on all their paths, without the
    /// correction for narrow features: reflection[a].
    /// @param layers  of each, from the bottom up (rte::first_order_paths)
    void evaluate_paths(std::span<const rte::FirstOrderPaths> layers,
                        std::span<const double> cos_azimuth, std::span<double> reflection) const;

    /// Memory of one evaluation that the next one can use.
    struct Scratch {
        Eigen::ArrayXXd weights;  ///< of the phase functions: row = wavelength, column = layer
        Eigen::ArrayXd above, lost, sums;
        Eigen::VectorXd phases;
        std::vector<double> angles;  ///< of scattering
        rte::NarrowFeatures::Scratch narrow;
    };

    /// R at directions that share their cosines: reflection[a * wavelengths() + w].
    void evaluate(double mu_in, double mu_out, std::span<const double> cos_azimuth,
                  std::span<double> reflection, Scratch& scratch) const;
    void evaluate(double mu_in, double mu_out, std::span<const double> cos_azimuth,
                  std::span<double> reflection) const {
        Scratch scratch;
        evaluate(mu_in, mu_out, cos_azimuth, reflection, scratch);
    }

  private:
    /// Sets the weights at a slant 1/mu_in + 1/mu_out, times a factor.
    void set_weights(double slant, double factor, Scratch& scratch) const;

    std::size_t wavelengths_;
    Eigen::ArrayXXd depth_;  ///< tau' of wavelength (row) and layer from the top down (column)
    /// alpha / (1 - alpha f) P, function layer * wavelengths + wavelength.
    std::optional<math::AngleTable> phases_;
    rte::NarrowFeatures narrow_;
};

}  // namespace miebrdf
