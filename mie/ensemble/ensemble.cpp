#include "mie/ensemble/ensemble.h"

#include "mie/ensemble/ensemble_average.h"

namespace miebrdf::mie {

EnsembleOptics average_over_sizes(const EnsembleRequest& request, const Executor& run) {
    return EnsembleAverage(request, run).optics();
}

}  // namespace miebrdf::mie
