// How much memory this process has and had; Linux.
#pragma once

#include <sys/resource.h>
#include <unistd.h>

#include <fstream>

namespace miebrdf::support {

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

}  // namespace miebrdf::support
