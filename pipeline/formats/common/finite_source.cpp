#include "pipeline/formats/common/finite_source.h"

#include <fmt/format.h>

#include <cmath>

#include <miebrdf/brdf.h>
#include <miebrdf/error.h>

namespace miebrdf {

namespace {

[[noreturn]] void refuse(const Direction& d, double value, const char* allowed) {
    throw InputError(
        fmt::format("the BRDF is {} at mu_in {:.6g}, mu_out {:.6g}, azimuth {:.6g} degrees; "
                    "allowed: {}",
                    value, d.mu_in, d.mu_out, d.azimuth_deg, allowed));
}

}  // namespace

void require_finite(std::span<const Direction> directions, std::span<const double> values,
                    std::size_t each) {
    for (std::size_t i = 0; i < directions.size() * each; ++i)
        if (!std::isfinite(values[i])) refuse(directions[i / each], values[i], "finite numbers");
}

FiniteSource::FiniteSource(const BrdfSource& source)
    : source_(source),
      is_solved_(dynamic_cast<const BrdfTable*>(&source) != nullptr),
      may_be_negative_(is_solved_ || source.wavelength_nm().empty()) {}

void FiniteSource::require(std::span<const Direction> directions, std::span<const double> values,
                           std::size_t elements) const {
    const std::size_t each = channels().size() * elements;
    require_finite(directions, values, each);
    if (may_be_negative_) return;
    for (std::size_t i = 0; i < directions.size() * each; i += elements)
        if (values[i] < 0.0) refuse(directions[i / each], values[i], "0 and above");
}

std::unique_ptr<ChannelMix> FiniteSource::mix(const ColourWeights& weights) const {
    return is_solved_ ? source_.mix(weights) : BrdfSource::mix(weights);
}

void FiniteSource::evaluate(std::span<const Direction> directions, std::span<double> values) const {
    source_.evaluate(directions, values);
    require(directions, values, 1);
}

void FiniteSource::evaluate_mueller(std::span<const Direction> directions,
                                    std::span<double> values) const {
    source_.evaluate_mueller(directions, values);
    const auto n = static_cast<std::size_t>(components());
    require(directions, values, n * n);
}

}  // namespace miebrdf
