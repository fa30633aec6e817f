// Shared libraries that few commands need and that take long to load (libnetcdf brings 40 others):
// loaded when one of their functions is called first, not when the program starts.
#pragma once

#include <string>

namespace miebrdf {

/// A C library that is loaded late, and then stays.
class LateLibrary {
  public:
    /// @param file  as the loader knows it: "libzip.so.4"
    explicit LateLibrary(const char* file) : file_(file) {}

    /// @throws std::runtime_error  when the library cannot be loaded or lacks the function
    template <typename Function>
    Function function(const char* name) const {
        return reinterpret_cast<Function>(symbol(name));
    }

    /// Whether it can be loaded.
    bool is_there() const;

  private:
    void* symbol(const char* name) const;
    const char* file_;
};

}  // namespace miebrdf

/// A function of a LateLibrary by the name and the type that its header declares. Looked up once.
/// Headers such as pipeline/formats/table/late_zip.h define macros by the names of the functions,
/// so that they are called as ever; one that was forgotten there is an error of the linker.
#define MIEBRDF_LATE(library, name)                                             \
    ([]() -> decltype(&::name) {                                                \
        static const auto found = (library).function<decltype(&::name)>(#name); \
        return found;                                                           \
    }())
