// The parts of a solved BRDF that are evaluated at every direction itself, at some wavelengths.
#pragma once

#include <span>
#include <vector>

#include "pipeline/solve/first_order.h"
#include "pipeline/solve/wavelength_solution.h"

namespace miebrdf::exports {

/// The first order of scattering, as far as a surface lets it through, and the surface lobe.
class SharpPart {
  public:
    /// Wavelengths that share their tables: few enough that parts can be made in parallel.
    static constexpr std::size_t kMostWavelengths = 16;

    /// @param solutions  at most kMostWavelengths; must outlive this. Their media are taken over.
    SharpPart(std::span<WavelengthSolution> solutions, const rte::SolverOptions& solver);

    std::size_t wavelengths() const { return solutions_.size(); }

    /// BRDF at directions that share their cosines: values[d * wavelengths() + w].
    void evaluate(std::span<const Direction> directions, std::span<double> values) const;

  private:
    std::span<const WavelengthSolution> solutions_;
    FirstOrder first_order_;
};

}  // namespace miebrdf::exports
