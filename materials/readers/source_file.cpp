#include "materials/readers/source_file.h"

#include <cerrno>
#include <cstring>
#include <fstream>
#include <iterator>

#include "materials/errors.h"

namespace miebrdf::materials {
namespace {

constexpr std::uintmax_t largest_file = 256u << 20;

bool ends_with(const std::string& name, const std::string& ending) {
    return name.size() > ending.size() && name.ends_with(ending);
}

}  // namespace

std::string read_text(const std::filesystem::path& file) {
    std::error_code error;
    if (std::filesystem::is_directory(file, error)) {
        throw ImportError(file.string(), 0, "is a folder");
    }
    const auto size = std::filesystem::file_size(file, error);
    if (!error && size > largest_file) throw ImportError(file.string(), 0, "larger than 256 MiB");
    std::ifstream stream(file, std::ios::binary);
    if (!stream) throw ImportError(file.string(), 0, std::strerror(errno));
    std::string text{std::istreambuf_iterator<char>(stream), {}};
    if (stream.bad()) throw ImportError(file.string(), 0, "cannot be read");
    return text;
}

SourceFile read_source(const std::filesystem::path& file) {
    SourceFile source{file, {}, {}};
    const std::string base = spd_base(file).string();
    if (base == file.string()) {
        source.text = read_text(file);
        return source;
    }
    const std::filesystem::path eta = base + ".eta.spd";
    const std::filesystem::path k = base + ".k.spd";
    if (std::filesystem::exists(eta)) source.text = read_text(eta);
    if (std::filesystem::exists(k)) source.k_text = read_text(k);
    if (source.text.empty() && source.k_text.empty())
        throw ImportError(file.string(), 0, "is empty");
    return source;
}

std::filesystem::path spd_base(const std::filesystem::path& file) {
    const std::string name = file.string();
    for (const char* ending : {".eta.spd", ".k.spd"}) {
        if (ends_with(name, ending)) return name.substr(0, name.size() - std::strlen(ending));
    }
    return file;
}

std::string source_stem(const std::filesystem::path& file) {
    const std::filesystem::path base = spd_base(file);
    return base == file ? file.stem().string() : base.filename().string();
}

}  // namespace miebrdf::materials
