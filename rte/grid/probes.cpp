// Directions beside those asked for, by which solutions of few values are judged.
#include <algorithm>
#include <iterator>
#include <utility>

#include "rte/grid/discretisation.h"

namespace miebrdf::rte {
namespace {

// Requests of at most so many values, or of fewer pairs of cosines, get probes.
constexpr std::size_t kFew = 16;
constexpr double kProbeOffsets_deg[] = {3.0, 6.0, 12.0};
constexpr double kProbeCosines[] = {0.1, 0.35, 0.9};

}  // namespace

AzimuthProbes::AzimuthProbes(const Stack& stack, const Directions& asked,
                             const SolverOptions& options)
    : directions_(asked), azimuths_(asked.azimuth_deg.size()) {
    const bool are_few = asked.mu_in.size() * asked.mu_out.size() * azimuths_ <= kFew;
    const int streams = options.streams > 0 ? options.streams : first_streams(options.tolerance);
    if (!are_few || !converges_slowly(stack, streams)) return;
    for (const double azimuth : asked.azimuth_deg) {
        for (const double offset : kProbeOffsets_deg) {
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

std::vector<double> AzimuthProbes::largest_nearby(const std::vector<double>& errors) const {
    const std::size_t azimuths = directions_.azimuth_deg.size();
    const std::size_t block = directions_.mu_out.size() * azimuths;
    const std::size_t reach = azimuths > azimuths_ ? azimuths : 1;
    if (block == 0) return errors;
    std::vector<double> all, sorted;
    all.reserve(errors.size());
    for (std::size_t k = 0; k < errors.size(); ++k) {
        if (k % block == 0) {
            const auto first = errors.begin() + std::ptrdiff_t(k);
            sorted.assign(first, first + std::ptrdiff_t(block));
            std::nth_element(sorted.begin(), sorted.begin() + std::ptrdiff_t(block / 2),
                             sorted.end());
        }
        const std::size_t a = k % azimuths;
        const auto here = errors.begin() + std::ptrdiff_t(k);
        const auto first = here - std::ptrdiff_t(std::min(a, reach));
        const auto end = here + 1 + std::ptrdiff_t(std::min(azimuths - 1 - a, reach));
        all.push_back(std::max(*std::max_element(first, end), sorted[block / 2]));
    }
    return without(std::move(all));
}

std::size_t AzimuthProbes::asked_for(std::size_t index) const {
    const std::size_t stride = directions_.azimuth_deg.size();
    if (stride == 0) return 0;
    std::size_t azimuth = index % stride;
    if (azimuth >= azimuths_) azimuth = (azimuth - azimuths_) / std::size(kProbeOffsets_deg);
    return index / stride * azimuths_ + azimuth;
}

RequestedDirections collect_with_probes(const Directions& directions) {
    RequestedDirections requested = collect(directions.mu_in, directions.mu_out);
    const bool are_few = directions.mu_in.size() * directions.mu_out.size() < kFew;
    if (!are_few || only_fourier_order_zero(requested)) return requested;
    std::vector<double> mu_in = directions.mu_in;
    std::vector<double> mu_out = directions.mu_out;
    mu_in.insert(mu_in.end(), std::begin(kProbeCosines), std::end(kProbeCosines));
    mu_out.insert(mu_out.end(), std::begin(kProbeCosines), std::end(kProbeCosines));
    requested = collect(mu_in, mu_out);
    requested.probes = std::size(kProbeCosines);
    return requested;
}

}  // namespace miebrdf::rte
