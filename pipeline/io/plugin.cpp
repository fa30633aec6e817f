#include "pipeline/io/plugin.h"

#include <dlfcn.h>
#include <fmt/format.h>

#include <miebrdf/error.h>

namespace miebrdf {
namespace {

/// The loader counts how often a module was opened; it is never closed here.
void* opened(const std::string& plugin) {
    return ::dlopen(fmt::format("miebrdf-{}.so", plugin).c_str(), RTLD_LAZY | RTLD_LOCAL);
}

}  // namespace

bool has_plugin(const std::string& plugin) { return opened(plugin) != nullptr; }

void* plugin_symbol(const std::string& plugin, const char* function, const std::string& package) {
    void* module = opened(plugin);
    void* found = module != nullptr ? ::dlsym(module, function) : nullptr;
    if (found != nullptr) return found;
    const char* reason = ::dlerror();
    throw UsageError(fmt::format(
        "the plug-in miebrdf-{}.so cannot be opened: {}; install {}, then configure, build and "
        "install again",
        plugin, reason != nullptr ? reason : "unknown reason", package));
}

}  // namespace miebrdf
