// How often this program has allocated memory. Counted is what Eigen takes, too: its matrices do
// not go through operator new. Defines malloc and its like: for one source file of a program.
#pragma once

#include <cstddef>
#include <cstdlib>

// Sanitizers bring an allocator of their own.
#if defined(__GLIBC__) && !defined(__SANITIZE_ADDRESS__) && !defined(__clang__)

#include <atomic>

namespace miebrdf::support {

inline constexpr bool kCountsAllocations = true;
inline std::atomic<long> allocations_so_far{0};
inline long allocation_count() { return allocations_so_far; }

inline void count_allocation() { allocations_so_far.fetch_add(1, std::memory_order_relaxed); }

}  // namespace miebrdf::support

extern "C" {
void* __libc_malloc(std::size_t size);
void* __libc_calloc(std::size_t count, std::size_t size);
void* __libc_realloc(void* memory, std::size_t size);
void* __libc_memalign(std::size_t alignment, std::size_t size);

void* malloc(std::size_t size) {
    miebrdf::support::count_allocation();
    return __libc_malloc(size);
}
void* calloc(std::size_t count, std::size_t size) {
    miebrdf::support::count_allocation();
    return __libc_calloc(count, size);
}
void* realloc(void* memory, std::size_t size) {
    miebrdf::support::count_allocation();
    return __libc_realloc(memory, size);
}
void* aligned_alloc(std::size_t alignment, std::size_t size) {
    miebrdf::support::count_allocation();
    return __libc_memalign(alignment, size);
}
}

#else

namespace miebrdf::support {

inline constexpr bool kCountsAllocations = false;
inline long allocation_count() { return 0; }

}  // namespace miebrdf::support

#endif
