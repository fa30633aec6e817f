#include "mie/ensemble.h"

#include <numbers>

#include "mie/ensemble_average.h"
#include "mie/terms.h"

namespace miebrdf::mie {

int highest_moment_of(const EnsembleRequest& request) {
    const double largest_nm = 1e3 * radius_range(request.sizes).largest_um;
    const double size_parameter =
        2.0 * std::numbers::pi * largest_nm * request.host_index / request.wavelength_nm;
    return 2 * number_of_terms(size_parameter);
}

EnsembleOptics average_over_sizes(const EnsembleRequest& request) {
    EnsembleAverage average(request);
    do {
        for (int chunk = 0; chunk < average.chunk_count(); ++chunk) {
            average.merge(average.compute(chunk));
        }
    } while (average.finish_pass());
    return average.optics();
}

}  // namespace miebrdf::mie
