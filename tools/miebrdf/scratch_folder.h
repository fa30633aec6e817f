// A folder for the time of a request of the studio.
#pragma once

#include <stdlib.h>

#include <filesystem>
#include <string>
#include <system_error>

#include <miebrdf/error.h>

namespace miebrdf::program {

class ScratchFolder {
  public:
    /// @throws InputError  when none can be made
    ScratchFolder() {
        const std::filesystem::path folder = std::filesystem::temp_directory_path();
        std::string pattern = (folder / "miebrdf-studio-XXXXXX").string();
        if (::mkdtemp(pattern.data()) == nullptr)
            throw InputError("no folder can be made in " + folder.string());
        path_ = pattern;
    }
    ~ScratchFolder() {
        std::error_code ignored;
        std::filesystem::remove_all(path_, ignored);
    }
    ScratchFolder(const ScratchFolder&) = delete;
    ScratchFolder& operator=(const ScratchFolder&) = delete;
    const std::filesystem::path& path() const { return path_; }

  private:
    std::filesystem::path path_;
};

}  // namespace miebrdf::program
