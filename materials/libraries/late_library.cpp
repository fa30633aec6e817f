#include "materials/libraries/late_library.h"

#include <dlfcn.h>

#include <stdexcept>

namespace miebrdf {
namespace {

/// The loader counts how often a library was opened; it is never closed here.
void* opened(const char* file) { return ::dlopen(file, RTLD_LAZY | RTLD_LOCAL); }

[[noreturn]] void fail_to_load(const char* file) {
    const char* reason = ::dlerror();
    throw std::runtime_error(std::string("the library ") + file + " cannot be loaded: " +
                             (reason != nullptr ? reason : "unknown reason"));
}

}  // namespace

bool LateLibrary::is_there() const { return opened(file_) != nullptr; }

void* LateLibrary::symbol(const char* name) const {
    void* library = opened(file_);
    if (library == nullptr) fail_to_load(file_);
    // Also in the libraries that this one is linked to.
    void* found = ::dlsym(library, name);
    if (found == nullptr) fail_to_load(file_);
    return found;
}

}  // namespace miebrdf
