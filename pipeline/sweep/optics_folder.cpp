#include "pipeline/sweep/optics_folder.h"

#include <miebrdf/error.h>

#include <cstring>
#include <fstream>
#include <iterator>
#include <string_view>
#include <system_error>

#include "pipeline/cache/result_cache.h"
#include "pipeline/io/atomic_file.h"

namespace miebrdf::sweep {
namespace {

namespace fs = std::filesystem;

constexpr std::size_t kChecksumLength = 64;
/// Names of a folder begin alike: 256 folders keep each of them short.
constexpr std::size_t kPrefixLength = 2;

}  // namespace

fs::path OpticsFolder::file_of(const std::string& hash) const {
    return folder_ / hash.substr(0, kPrefixLength) / hash;
}

std::optional<std::vector<double>> OpticsFolder::find(const std::string& hash) {
    std::ifstream stream(file_of(hash), std::ios::binary);
    if (!stream) return std::nullopt;
    const std::string file{std::istreambuf_iterator<char>(stream), {}};
    if (file.size() < kChecksumLength) return std::nullopt;
    const std::string_view bytes = std::string_view(file).substr(kChecksumLength);
    if (bytes.size() % sizeof(double) != 0 ||
        std::string_view(file).substr(0, kChecksumLength) != checksum_of(hash, bytes))
        return std::nullopt;
    std::vector<double> numbers(bytes.size() / sizeof(double));
    if (!numbers.empty()) std::memcpy(numbers.data(), bytes.data(), bytes.size());
    return numbers;
}

void OpticsFolder::store(const std::string& hash, const std::vector<double>& numbers) {
    const std::string_view bytes(reinterpret_cast<const char*>(numbers.data()),
                                 numbers.size() * sizeof(double));
    std::size_t free = free_bytes_.load();
    do {
        if (bytes.size() > free) return;
    } while (!free_bytes_.compare_exchange_weak(free, free - bytes.size()));
    try {
        const fs::path target = file_of(hash);
        // One level at a time: whoever comes when all is done and removed makes no folder again.
        std::error_code ignored;  // the file says it
        fs::create_directory(folder_, ignored);
        fs::create_directory(target.parent_path(), ignored);
        AtomicFile file(target);
        file.stream() << checksum_of(hash, bytes) << bytes;
        file.commit();
    } catch (const Error&) {  // a full disk: the next chunk says so
    }
}

}  // namespace miebrdf::sweep
