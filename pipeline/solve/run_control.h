// How a caller watches and stops a computation.
#pragma once

#include <atomic>
#include <cstddef>
#include <functional>
#include <string>

#include <miebrdf/error.h>

namespace miebrdf {

class ResultCache;
class SharedWork;

struct RunControl {
    int threads = 0;  ///< most threads to use; 0: one for each processor
    /// Called after each finished job of a stage, one call at a time, from any thread.
    std::function<void(const std::string& stage, std::size_t done, std::size_t total)> progress =
        {};
    /// Looked at before each job; may be raised from a signal handler.
    const std::atomic<bool>* cancelled = nullptr;
    /// Where results are looked up and remembered; none: everything is computed.
    ResultCache* cache = nullptr;
    /// What the requests of one run have in common (shared_work.h); none: each is on its own.
    SharedWork* shared = nullptr;
};

}  // namespace miebrdf
