// A folder of its own for each test that writes files.
#pragma once

#include <filesystem>
#include <string>

namespace miebrdf::support {

class TemporaryFolder {
  public:
    TemporaryFolder();
    ~TemporaryFolder();
    TemporaryFolder(const TemporaryFolder&) = delete;
    TemporaryFolder& operator=(const TemporaryFolder&) = delete;

    const std::filesystem::path& path() const { return path_; }
    std::filesystem::path write(const std::string& name, const std::string& text) const;

  private:
    std::filesystem::path path_;
};

std::string read_bytes(const std::filesystem::path& file);

}  // namespace miebrdf::support
