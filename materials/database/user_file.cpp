#include "materials/database/user_file.h"

#include <cstdlib>

namespace miebrdf::materials {

std::string from_environment(const char* variable) {
    const char* value = std::getenv(variable);
    return value == nullptr ? "" : value;
}

std::filesystem::path user_file(const char* variable, const char* below_home,
                                const std::string& name) {
    namespace fs = std::filesystem;
    const fs::path home = from_environment("HOME");
    fs::path folder = from_environment(variable);
    if (!folder.is_absolute())
        folder = home.empty() ? fs::temp_directory_path() : home / below_home;
    return folder / "miebrdf" / name;
}

}  // namespace miebrdf::materials
