// How much memory this process has and had, and what it keeps; Linux.
#pragma once

#include <malloc.h>
#include <sys/resource.h>
#include <unistd.h>

#include <fstream>

namespace miebrdf::bench {

inline double resident_bytes() {
    long size = 0, resident = 0;
    std::ifstream("/proc/self/statm") >> size >> resident;
    return double(resident) * double(sysconf(_SC_PAGESIZE));
}

inline double peak_bytes() {
    rusage usage{};
    getrusage(RUSAGE_SELF, &usage);
    return 1024.0 * double(usage.ru_maxrss);
}

/// Memory that was freed stays with the process. By default glibc gives every matrix above 128 kB
/// back to the system at once and asks for it anew, page by page: 125 thousand page faults and 4 %
/// of the time for 31 wavelengths, more on several threads, which wait for each other there.
inline void keep_freed_memory() {
#ifdef __GLIBC__
    constexpr int largest = 256 << 20;
    mallopt(M_MMAP_THRESHOLD, largest);
    mallopt(M_TRIM_THRESHOLD, largest);
    mallopt(M_TOP_PAD, 16 << 20);
#endif
}

}  // namespace miebrdf::bench
