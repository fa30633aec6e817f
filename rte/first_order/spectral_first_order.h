// Light scattered once at several wavelengths and any directions: phase functions from tables.
#pragma once

#include <Eigen/Core>
#include <optional>
#include <span>
#include <vector>

#include "rte/first_order/first_order.h"
#include "rte/first_order/glory_correction.h"
#include "rte/math/chebyshev.h"

namespace miebrdf::rte {

/// FirstOrder, narrow features included, of some wavelengths side by side: what depends on
/// directions alone (angle of scattering, place in the tables, slant) is found once for all of
/// them. Phase functions are read from a table a hundred times finer than the tolerance.
class SpectralFirstOrder {
  public:
    /// Narrow features closer to the horizon are those of this cosine: beyond its end their table
    /// is a polynomial gone astray.
    static constexpr double kLeastCosine = 1e-3;

    struct Wavelength {
        const ScaledStack* stack;   ///< must outlive this
        bool is_polarised = false;  ///< R is element 11 of the Mueller matrix
    };
    /// @param exact      as of FirstOrder
    /// @param tolerance  the solver's
    SpectralFirstOrder(std::span<const Wavelength> wavelengths, bool exact, double tolerance);

    std::size_t wavelengths() const { return wavelengths_.size(); }
    const FirstOrder& at_wavelength(std::size_t w) const { return wavelengths_[w].first_order; }

    /// Memory of one evaluation that the next one can use.
    struct Scratch {
        Eigen::ArrayXXd weights;  ///< of the phase functions: row = wavelength, column = medium
        Eigen::ArrayXd sums;
        Eigen::VectorXd phases, shares;
        std::vector<double> angles;  ///< of scattering
        std::vector<double> own;     ///< of one wavelength
        GloryCorrection::Scratch narrow;
    };

    /// R at directions that share their cosines: reflection[a * wavelengths() + w].
    void evaluate(double mu_in, double mu_out, std::span<const double> cos_azimuth,
                  std::span<double> reflection, Scratch& scratch) const;
    void evaluate(double mu_in, double mu_out, std::span<const double> cos_azimuth,
                  std::span<double> reflection) const {
        Scratch scratch;
        evaluate(mu_in, mu_out, cos_azimuth, reflection, scratch);
    }
    /// At one wavelength: reflection[a].
    void evaluate_alone(std::size_t w, double mu_in, double mu_out,
                        std::span<const double> cos_azimuth, std::span<double> reflection,
                        Scratch& scratch) const;

  private:
    struct Known {
        FirstOrder first_order;
        bool is_polarised;
    };
    /// Wavelengths that share their tables: all of them, or one alone where boundaries and mirrors
    /// bend its light in its own way.
    struct Group {
        Group(std::span<const Known> wavelengths, bool exact, double tolerance);

        Eigen::ArrayXXd depth;     ///< tau' of wavelength (row) and medium from the top down
        Eigen::ArrayXXd strength;  ///< alpha / (1 - alpha f), likewise
        std::optional<math::AngleTable> phases;  ///< P: function medium * wavelengths + wavelength
        /// a2 / P, a3 / P and b1 / P of each medium from the top down, where boundaries and mirrors
        /// polarise the light of one wavelength.
        std::optional<math::AngleTable> shares;
        GloryCorrection narrow;

        ScatteringMatrix matrix_at(std::size_t medium, double cos_angle, Scratch& scratch) const;
        void evaluate_straight(double mu_in, double mu_out, std::span<const double> cos_azimuth,
                               std::span<double> reflection, Scratch& scratch) const;
        void evaluate_all_ways(const std::vector<PhaseWeights>& weights,
                               std::span<const double> cos_azimuth, std::span<double> reflection,
                               Scratch& scratch) const;
    };

    std::vector<Known> wavelengths_;
    std::vector<Group> groups_;
};

}  // namespace miebrdf::rte
