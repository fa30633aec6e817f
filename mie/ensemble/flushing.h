// Pieces of work without denormal numbers.
#pragma once

#include <miebrdf/ensemble.h>

#include "mie/sphere/flush_to_zero.h"

namespace miebrdf::mie {

/// Every thread that takes a piece of the work flushes denormal numbers meanwhile. Not the caller
/// around it: threads that `run` starts would inherit that for good.
/// @param run  must outlive the result
inline Executor flushing(const Executor& run) {
    return [&run](int count, const std::function<void(int)>& job) {
        run(count, [&job](int i) {
            const FlushToZero flush;
            job(i);
        });
    };
}

}  // namespace miebrdf::mie
