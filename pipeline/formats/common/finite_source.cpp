#include "pipeline/formats/common/finite_source.h"

#include <fmt/format.h>

#include <cmath>

#include <miebrdf/error.h>

namespace miebrdf {

void require_finite(std::span<const Direction> directions, std::span<const double> values,
                    std::size_t each) {
    for (std::size_t i = 0; i < directions.size() * each; ++i) {
        if (std::isfinite(values[i])) continue;
        const Direction& d = directions[i / each];
        throw InputError(
            fmt::format("the BRDF is {} at mu_in {:.6g}, mu_out {:.6g}, azimuth {:.6g} degrees; "
                        "allowed: finite numbers",
                        values[i], d.mu_in, d.mu_out, d.azimuth_deg));
    }
}

void FiniteSource::evaluate(std::span<const Direction> directions, std::span<double> values) const {
    source_.evaluate(directions, values);
    require_finite(directions, values, channels().size());
}

void FiniteSource::evaluate_mueller(std::span<const Direction> directions,
                                    std::span<double> values) const {
    source_.evaluate_mueller(directions, values);
    const auto n = static_cast<std::size_t>(components());
    require_finite(directions, values, channels().size() * n * n);
}

}  // namespace miebrdf
