#include "mie/ensemble.h"

#include "mie/ensemble_average.h"

namespace miebrdf::mie {

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
