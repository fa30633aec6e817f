// The only place that starts threads.
#pragma once

#include <cstddef>
#include <functional>
#include <string>

#include <miebrdf/control.h>
#include <miebrdf/ensemble.h>

namespace miebrdf {

/// Calls job(0) ... job(count - 1), each once, on at most control.threads threads. Jobs must not
/// share what they write; then the results do not depend on the number of threads. The first
/// exception of a job is rethrown here, after the others have stopped.
/// @throws Cancelled  when control.is_cancelled said so before the last job began
void run_parallel(const std::string& stage, std::size_t count, const Control& control,
                  const std::function<void(std::size_t)>& job);

/// For the pieces of one job of run_parallel: they go to threads of the same run that have no job
/// of their own left, so that one large job is not done by one thread.
mie::Executor pieces_of_job(const Control& control);

}  // namespace miebrdf
