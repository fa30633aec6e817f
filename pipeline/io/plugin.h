// Plug-ins: shared modules of ours around libraries that few requests need and that take long to
// load (libnetcdf and librsvg bring 40 others each). Opened when asked for, not when the program
// starts; looked for where the RPATH of the program or the Python module says (miebrdf_plugin and
// miebrdf_finds_plugins in tools/cmake/MiebrdfLibrary.cmake), without /proc too.
#pragma once

#include <string>

namespace miebrdf {

/// Whether it can be opened, with every library that it needs. @param plugin  "netcdf"
bool has_plugin(const std::string& plugin);

/// @throws UsageError  when the plug-in cannot be opened, with the loader's reason and the package
void* plugin_symbol(const std::string& plugin, const char* function, const std::string& package);

/// A function that a plug-in offers as extern "C".
/// @param package  of Debian, which the plug-in is built with
template <typename Function>
Function* plugin_function(const std::string& plugin, const char* function,
                          const std::string& package) {
    return reinterpret_cast<Function*>(plugin_symbol(plugin, function, package));
}

}  // namespace miebrdf
