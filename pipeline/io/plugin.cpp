#include "pipeline/io/plugin.h"

#include <dlfcn.h>
#include <fmt/format.h>
#include <link.h>

#include <algorithm>
#include <bit>
#include <string_view>
#include <system_error>
#include <vector>

#include <miebrdf/error.h>
#include "pipeline/io/program_file.h"

namespace miebrdf {

namespace fs = std::filesystem;

namespace {

/// The folders of the run path of the module that this function is in. The loader asks /proc where
/// $ORIGIN is and, without an answer, leaves out what begins with it.
std::vector<fs::path> folders_of_run_path() {
    Dl_info unused{};
    link_map* module = nullptr;
    if (::dladdr1(reinterpret_cast<const void*>(&folders_of_run_path), &unused,
                  reinterpret_cast<void**>(&module), RTLD_DL_LINKMAP) == 0 ||
        module == nullptr)
        return {};
    ElfW(Addr) names = 0;
    ElfW(Xword) run_path = 0;
    for (const ElfW(Dyn)* entry = module->l_ld; entry->d_tag != DT_NULL; ++entry) {
        if (entry->d_tag == DT_STRTAB) names = entry->d_un.d_ptr;
        if (entry->d_tag == DT_RUNPATH || entry->d_tag == DT_RPATH) run_path = entry->d_un.d_val;
    }
    if (names == 0 || run_path == 0) return {};
    if (names < module->l_addr) names += module->l_addr;  // where the loader has not added that
    const std::string name = module->l_name;
    std::error_code unknown;
    const fs::path own = name.empty() ? program_file() : fs::weakly_canonical(name, unknown);
    if (own.empty()) return {};
    const std::string_view origin = "$ORIGIN";
    std::vector<fs::path> folders;
    std::string_view rest = std::bit_cast<const char*>(names + run_path);
    while (!rest.empty()) {
        const std::string_view folder = rest.substr(0, rest.find(':'));
        rest.remove_prefix(std::min(folder.size() + 1, rest.size()));
        if (folder.starts_with(origin))
            folders.emplace_back(own.parent_path().string() +
                                 std::string(folder.substr(origin.size())));
    }
    return folders;
}

/// The loader counts how often a module was opened; it is never closed here.
void* opened(const std::string& plugin) {
    const std::string name = fmt::format("miebrdf-{}.so", plugin);
    void* module = ::dlopen(name.c_str(), RTLD_LAZY | RTLD_LOCAL);
    if (module != nullptr) return module;
    for (const fs::path& folder : folders_of_run_path()) {
        std::error_code unknown;
        if (!fs::exists(folder / name, unknown)) continue;
        module = ::dlopen((folder / name).c_str(), RTLD_LAZY | RTLD_LOCAL);
        if (module != nullptr) return module;
    }
    return module;
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
