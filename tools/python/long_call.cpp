#include "tools/python/long_call.h"

#include <atomic>
#include <chrono>
#include <condition_variable>
#include <exception>
#include <mutex>
#include <string>
#include <thread>

namespace miebrdf::python {
namespace {

constexpr std::chrono::milliseconds kInterval{50};

bool forked = false;  // set once, right after a fork, while there is one thread

}  // namespace

struct LongCall::Watch {
    std::atomic<bool> cancelled = false;
    std::mutex mutex;
    std::string stage;  ///< these three are guarded by the mutex
    std::size_t done = 0, total = 0;
};

LongCall::LongCall(const CallOptions& options)
    : progress_(options.progress), watch_(std::make_shared<Watch>()) {
    control_.threads = forked ? 1 : options.threads;
    // Both hold the watch: what the library keeps of a call may outlive it.
    control_.is_cancelled = [watch = watch_] { return watch->cancelled.load(); };
    if (!progress_.is_none()) {
        control_.progress = [watch = watch_](const std::string& stage, std::size_t done,
                                             std::size_t total) {
            const std::lock_guard lock(watch->mutex);
            watch->stage = stage;
            watch->done = done;
            watch->total = total;
        };
    }
    if (options.cache) control_.cache = open_cache();
}

LongCall::~LongCall() = default;

void LongCall::run_watched(const std::function<void()>& work) {
    std::exception_ptr failure, raised;
    std::mutex mutex;
    std::condition_variable ended;
    bool finished = false;
    const auto look_after = [&] {
        const py::gil_scoped_acquire lock;
        try {
            if (PyErr_CheckSignals() != 0) throw py::error_already_set();
            if (progress_.is_none()) return;
            std::string stage;
            std::size_t done = 0, total = 0;
            {
                const std::lock_guard guard(watch_->mutex);
                stage = watch_->stage;
                done = watch_->done;
                total = watch_->total;
            }
            if (total > 0) progress_(stage, done, total);
        } catch (...) {
            raised = std::current_exception();
            watch_->cancelled = true;
        }
    };
    {
        const py::gil_scoped_release unlocked;
        std::thread worker([&] {
            try {
                work();
            } catch (...) {
                failure = std::current_exception();
            }
            const std::lock_guard guard(mutex);
            finished = true;
            ended.notify_one();
        });
        std::unique_lock guard(mutex);
        while (!ended.wait_for(guard, kInterval, [&] { return finished; })) {
            guard.unlock();
            if (!raised) look_after();
            guard.lock();
        }
        guard.unlock();
        worker.join();
    }
    if (raised) std::rethrow_exception(raised);
    if (failure) std::rethrow_exception(failure);
}

void set_forked() { forked = true; }

}  // namespace miebrdf::python
