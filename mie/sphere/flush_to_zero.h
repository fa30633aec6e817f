// Numbers below the normal range count as zero, for as long as an object of this file lives.
#pragma once

#include <cstdint>

#if defined(__SSE2__)
#include <immintrin.h>
#endif

namespace miebrdf::mie {

/// Sets the thread's processor to flush denormal numbers to zero, and back to what it was.
///
/// Partial waves fade below 1e-38 (single precision) at the last orders, where every product with
/// them takes the processor a hundred times as long as usual and adds nothing. On machines that
/// have no such switch, or where it is not known here, this does nothing.
class FlushToZero {
  public:
    FlushToZero() : before_(state()) { set_state(before_ | kFlush); }
    ~FlushToZero() { set_state(before_); }
    FlushToZero(const FlushToZero&) = delete;
    FlushToZero& operator=(const FlushToZero&) = delete;

    /// The register that it changes: MXCSR on x86, FPCR on 64-bit ARM, else 0.
#if defined(__SSE2__)
    static std::uint64_t state() { return _mm_getcsr(); }
#elif defined(__aarch64__)
    static std::uint64_t state() {
        std::uint64_t value;
        __asm__ volatile("mrs %0, fpcr" : "=r"(value));
        return value;
    }
#else
    static std::uint64_t state() { return 0; }
#endif

  private:
#if defined(__SSE2__)
    static constexpr std::uint64_t kFlush = 0x8040;  // results (bit 15) and operands (bit 6)
    static void set_state(std::uint64_t value) { _mm_setcsr(static_cast<unsigned>(value)); }
#elif defined(__aarch64__)
    static constexpr std::uint64_t kFlush = std::uint64_t(1) << 24;
    static void set_state(std::uint64_t value) { __asm__ volatile("msr fpcr, %0" ::"r"(value)); }
#else
    static constexpr std::uint64_t kFlush = 0;
    static void set_state(std::uint64_t) {}
#endif

    std::uint64_t before_;
};

}  // namespace miebrdf::mie
