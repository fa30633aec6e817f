// Judging by directions beside those asked for.
#include <algorithm>
#include <iterator>
#include <utility>

#include "rte/grid/discretisation.h"

namespace miebrdf::rte {
namespace {

// Requests of fewer pairs of cosines get probes.
constexpr std::size_t kFew = 16;
constexpr double kProbeCosines[] = {0.1, 0.35, 0.9};

}  // namespace

std::vector<double> largest_nearby(const std::vector<double>& errors,
                                   const Directions& directions) {
    const std::size_t azimuths = directions.azimuth_deg.size();
    const std::size_t block = directions.mu_out.size() * azimuths;
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
        all.push_back(std::max(*std::max_element(here - (a > 0), here + 1 + (a + 1 < azimuths)),
                               sorted[block / 2]));
    }
    return all;
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
