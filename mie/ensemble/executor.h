// How the independent pieces of a computation are run; threads, if any, belong to the caller.
#pragma once

#include <functional>

namespace miebrdf::mie {

/// Calls job(0) ... job(count - 1), each once, in any order or at the same time, and returns when
/// all are done. Pieces never depend on the executor and their results are merged in order, so that
/// every executor gives the same bits.
using Executor = std::function<void(int count, const std::function<void(int)>& job)>;

inline void run_in_order(int count, const std::function<void(int)>& job) {
    for (int i = 0; i < count; ++i) job(i);
}

}  // namespace miebrdf::mie
