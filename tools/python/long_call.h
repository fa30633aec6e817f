// Calls that take long: the interpreter's lock is released, Ctrl-C stops them, progress is shown.
#pragma once

#include <miebrdf/control.h>

#include <functional>
#include <memory>
#include <optional>
#include <utility>

#include "tools/python/bindings.h"

namespace miebrdf::python {

/// Options that every long call takes.
struct CallOptions {
    int threads = 0;      ///< 0: one for each processor
    py::object progress;  ///< called as progress(stage, done, total) in the calling thread; or None
    bool cache = false;   ///< results of earlier runs, those of the program
};

/// Threads, cancellation and progress of one call; what the library's threads report is kept here
/// until the calling thread looks, so that none of them ever needs the interpreter.
class LongCall {
  public:
    explicit LongCall(const CallOptions& options);
    ~LongCall();
    LongCall(const LongCall&) = delete;
    LongCall& operator=(const LongCall&) = delete;

    /// To be given to the library.
    const Control& control() const { return control_; }
    Control& control() { return control_; }

    /// Runs `work` in a thread of its own, without the interpreter's lock, while this thread looks
    /// after signals and progress twenty times a second.
    /// @throws what the work throws, and what a signal handler or `progress` raises
    template <typename Work>
    auto run(const Work& work) {
        std::optional<decltype(work())> result;
        run_watched([&] { result.emplace(work()); });
        return std::move(*result);
    }

    /// The same of work that gives what it has when it is stopped: after Ctrl-C, too.
    template <typename Work>
    auto run_until_stopped(const Work& work) {
        std::optional<decltype(work())> result;
        try {
            run_watched([&] { result.emplace(work()); });
        } catch (const py::error_already_set& error) {
            if (!result || !error.matches(PyExc_KeyboardInterrupt)) throw;
        }
        return std::move(*result);
    }

  private:
    struct Watch;
    void run_watched(const std::function<void()>& work);

    py::object progress_;
    std::shared_ptr<Watch> watch_;
    Control control_;
};

/// Whether this process is a child of one that had threads of the library: their pool is not there
/// any more, so that everything runs in the calling thread.
void set_forked();

}  // namespace miebrdf::python
