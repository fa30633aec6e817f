#include "pipeline/exports/brdf_source.h"

#include <fmt/format.h>

#include <algorithm>

#include "pipeline/error.h"
#include "pipeline/parallel.h"

namespace miebrdf::exports {
namespace {

/// Directions of one job: enough to make starting it cheap, few enough to share out evenly.
constexpr std::size_t kChunk = 4096;

}  // namespace

std::vector<std::string> channel_names(const std::vector<double>& wavelength_nm) {
    std::vector<std::string> names;
    names.reserve(wavelength_nm.size());
    for (const double wavelength : wavelength_nm) names.push_back(fmt::format("{} nm", wavelength));
    return names;
}

std::vector<double> evaluate_all(const BrdfSource& source, std::span<const Direction> directions,
                                 const std::string& stage, const RunControl& control) {
    const std::size_t channels = source.channels().size();
    std::vector<double> values(directions.size() * channels);
    const std::size_t jobs = (directions.size() + kChunk - 1) / kChunk;
    run_parallel(stage, jobs, control, [&](std::size_t job) {
        const std::size_t first = job * kChunk;
        const std::size_t count = std::min(kChunk, directions.size() - first);
        source.evaluate(directions.subspan(first, count),
                        std::span(values).subspan(first * channels, count * channels));
    });
    return values;
}

void require_wavelengths(const BrdfSource& source, const std::string& format) {
    if (source.wavelength_nm().empty()) {
        throw UsageError(fmt::format("format '{}' holds spectra; this BRDF has the channels {}",
                                     format, fmt::join(source.channels(), ", ")));
    }
}

}  // namespace miebrdf::exports
