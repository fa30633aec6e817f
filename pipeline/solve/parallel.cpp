#include "pipeline/solve/parallel.h"

#include <miebrdf/error.h>
#include <oneapi/tbb/info.h>
#include <oneapi/tbb/parallel_for.h>
#include <oneapi/tbb/task_arena.h>

#include <algorithm>
#include <mutex>

#include "rte/math/interruption.h"

namespace miebrdf {
namespace {

/// Wraps a job so that each call can be refused before and is counted after.
class WatchedJob {
  public:
    WatchedJob(const std::string& stage, std::size_t count, const Control& control,
               const std::function<void(std::size_t)>& job)
        : stage_(stage), count_(count), control_(control), job_(job) {}

    void operator()(std::size_t index) {
        if (control_.is_cancelled && control_.is_cancelled()) throw Cancelled();
        if (control_.job_begun) control_.job_begun(stage_, count_);
        {
            const math::Interruptible interruptible(control_.is_cancelled);
            job_(index);
        }
        if (!control_.progress) return;
        const std::lock_guard lock(mutex_);
        control_.progress(stage_, ++done_, count_);
    }

  private:
    const std::string& stage_;
    std::size_t count_;
    const Control& control_;
    const std::function<void(std::size_t)>& job_;
    std::mutex mutex_;
    std::size_t done_ = 0;
};

}  // namespace

void run_parallel(const std::string& stage, std::size_t count, const Control& control,
                  const std::function<void(std::size_t)>& job) {
    WatchedJob watched(stage, count, control, job);
    if (control.threads == 1) {
        for (std::size_t i = 0; i < count; ++i) watched(i);
        return;
    }
    // More threads than processors gain nothing, and TBB complains about them on standard error.
    const int processors = tbb::info::default_concurrency();
    tbb::task_arena arena(control.threads > 0 ? std::min(control.threads, processors) : processors);
    arena.execute([&] {
        // Jobs differ in cost by orders of magnitude, so each is a task of its own.
        tbb::parallel_for(
            tbb::blocked_range<std::size_t>(0, count, 1),
            [&](const tbb::blocked_range<std::size_t>& range) {
                for (std::size_t i = range.begin(); i != range.end(); ++i) watched(i);
            },
            tbb::simple_partitioner());
    });
}

mie::Executor pieces_of_job(const Control& control) {
    const auto watched = [told = control.piece_done, is_cancelled = control.is_cancelled](
                             const std::function<void(int)>& piece, int i) {
        const math::Interruptible interruptible(is_cancelled);
        math::interruption_point();
        piece(i);
        if (told) told();
    };
    if (control.threads == 1) {
        return [watched](int count, const std::function<void(int)>& piece) {
            for (int i = 0; i < count; ++i) watched(piece, i);
        };
    }
    return [watched](int count, const std::function<void(int)>& piece) {
        // Isolated: while it waits for its last piece, a thread must not begin another job, which
        // this one would then wait for.
        tbb::this_task_arena::isolate([&] {
            tbb::task_group_context context;
            tbb::parallel_for(
                tbb::blocked_range<int>(0, count, 1),
                [&](const tbb::blocked_range<int>& range) {
                    for (int i = range.begin(); i != range.end(); ++i) watched(piece, i);
                },
                tbb::simple_partitioner(), context);
            // When another job has failed or was refused, TBB leaves out the pieces of this one and
            // returns as if they were done.
            if (context.is_group_execution_cancelled()) throw Cancelled();
        });
    };
}

}  // namespace miebrdf
