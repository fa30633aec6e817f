#include "pipeline/solve/sharp_part.h"

#include <cmath>
#include <numbers>

#include "pipeline/solve/vector_pairs.h"

namespace miebrdf::exports {
namespace {

FirstOrder first_order_of(std::span<const WavelengthSolution> solutions,
                          const rte::SolverOptions& solver) {
    std::vector<std::vector<rte::ScaledMedium>> stacks;
    for (const WavelengthSolution& solution : solutions) stacks.push_back(solution.media());
    return {stacks, solver.single_scattering_correction, solver.tolerance};
}

}  // namespace

SharpPart::SharpPart(std::span<WavelengthSolution> solutions, const rte::SolverOptions& solver)
    : solutions_(solutions), first_order_(first_order_of(solutions, solver)) {
    for (WavelengthSolution& solution : solutions) solution.drop_media();
}

void SharpPart::evaluate(std::span<const Direction> directions, std::span<double> values) const {
    const double mu_in = directions[0].mu_in, mu_out = directions[0].mu_out;
    const std::size_t count = solutions_.size();
    std::vector<double> cos_azimuth;
    cos_azimuth.reserve(directions.size());
    for (const Direction& d : directions) cos_azimuth.push_back(std::cos(d.azimuth_deg * kDegree));
    first_order_.evaluate(mu_in, mu_out, cos_azimuth, values);
    for (std::size_t w = 0; w < count; ++w) {
        const WavelengthSolution& solution = solutions_[w];
        const double transmitted = solution.transmitted(mu_in, mu_out) / std::numbers::pi;
        for (std::size_t d = 0; d < directions.size(); ++d) {
            double& value = values[d * count + w];
            value *= transmitted;
            if (solution.has_surface()) value += solution.lobe(directions[d]);
        }
    }
}

}  // namespace miebrdf::exports
