// The only place that starts threads.
#pragma once

#include <cstddef>
#include <functional>

namespace miebrdf {

/// Calls job(0) ... job(count - 1), each once, on at most `threads` threads (0: one for each
/// processor). Jobs must not share what they write; then the results do not depend on the number
/// of threads. The first exception of a job is rethrown here, after the others have stopped.
void run_parallel(std::size_t count, int threads, const std::function<void(std::size_t)>& job);

}  // namespace miebrdf
