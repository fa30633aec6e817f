#include "pipeline/parallel.h"

#include <oneapi/tbb/parallel_for.h>
#include <oneapi/tbb/task_arena.h>

namespace miebrdf {

void run_parallel(std::size_t count, int threads, const std::function<void(std::size_t)>& job) {
    if (count == 1 || threads == 1) {
        for (std::size_t i = 0; i < count; ++i) job(i);
        return;
    }
    tbb::task_arena arena(threads > 0 ? threads : tbb::task_arena::automatic);
    arena.execute([&] {
        // Jobs differ in cost by orders of magnitude, so each is a task of its own.
        tbb::parallel_for(tbb::blocked_range<std::size_t>(0, count, 1),
                          [&](const tbb::blocked_range<std::size_t>& range) {
                              for (std::size_t i = range.begin(); i != range.end(); ++i) job(i);
                          },
                          tbb::simple_partitioner());
    });
}

}  // namespace miebrdf
