#include "rte/grid/azimuth_probes.h"

#include <iterator>

#include "rte/fourier/fourier_reflection.h"
#include "rte/grid/discretisation.h"

namespace miebrdf::rte {
namespace {

constexpr std::size_t few = 16;
constexpr int typical_streams = 24;
constexpr double offsets_deg[] = {3.0, 6.0, 12.0};

}  // namespace

AzimuthProbes::AzimuthProbes(const Stack& stack, const Directions& asked,
                             const SolverOptions& options)
    : directions_(asked), azimuths_(asked.azimuth_deg.size()) {
    const bool are_few = asked.mu_in.size() * asked.mu_out.size() * azimuths_ <= few;
    const int streams = options.streams > 0 ? options.streams : typical_streams;
    // Across the plane of incidence half of the orders are not needed: keep it so.
    if (!are_few || is_invisible(1, asked.azimuth_deg) || !converges_slowly(stack, streams)) return;
    for (const double azimuth : asked.azimuth_deg) {
        for (const double offset : offsets_deg) {
            directions_.azimuth_deg.push_back(azimuth + offset);
        }
    }
}

std::vector<double> AzimuthProbes::without(std::vector<double> values) const {
    const std::size_t stride = directions_.azimuth_deg.size();
    if (stride == azimuths_) return values;
    std::vector<double> asked;
    for (std::size_t first = 0; first < values.size(); first += stride) {
        for (std::size_t a = 0; a < azimuths_; ++a) asked.push_back(values[first + a]);
    }
    return asked;
}

std::size_t AzimuthProbes::asked_for(std::size_t index) const {
    const std::size_t stride = directions_.azimuth_deg.size();
    if (stride == 0) return 0;
    std::size_t azimuth = index % stride;
    if (azimuth >= azimuths_) azimuth = (azimuth - azimuths_) / std::size(offsets_deg);
    return index / stride * azimuths_ + azimuth;
}

}  // namespace miebrdf::rte
