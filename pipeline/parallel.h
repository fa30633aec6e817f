// The only place that starts threads.
#pragma once

#include <cstddef>
#include <functional>
#include <string>

#include "pipeline/run_control.h"

namespace miebrdf {

/// Calls job(0) ... job(count - 1), each once, on at most control.threads threads. Jobs must not
/// share what they write; then the results do not depend on the number of threads. The first
/// exception of a job is rethrown here, after the others have stopped.
/// @throws Cancelled  when control.cancelled was raised before the last job began
void run_parallel(const std::string& stage, std::size_t count, const RunControl& control,
                  const std::function<void(std::size_t)>& job);

}  // namespace miebrdf
