#include "pipeline/sweep/parts.h"

#include <fmt/format.h>
#include <miebrdf/error.h>
#include <miebrdf/version.h>

#include <algorithm>
#include <cerrno>
#include <cstdio>
#include <cstring>
#include <fstream>
#include <iterator>
#include <system_error>

#include "pipeline/cache/job_key.h"
#include "pipeline/cache/result_cache.h"
#include "pipeline/io/atomic_file.h"
#include "pipeline/solve/resolved_scene.h"
#include "pipeline/sweep/layout.h"

namespace miebrdf::sweep {
namespace {

namespace fs = std::filesystem;

/// A chunk of fewer scenes than this would leave processors idle; one of more loses too much when
/// it is interrupted.
constexpr std::size_t kFewestScenes = 8, kMostScenesPerChunk = 256;
/// 32 MB of values.
constexpr std::size_t kMostValues = std::size_t{4} << 20;

constexpr char kName[] = "chunk-";
constexpr std::size_t kHashLength = 64;

void append(std::string& bytes, const void* data, std::size_t size) {
    bytes.append(static_cast<const char*>(data), size);
}

std::string packed(const std::vector<SceneResult>& results) {
    std::string bytes;
    for (const SceneResult& result : results) {
        append(bytes, result.values.data(), result.values.size() * sizeof(double));
        append(bytes, &result.error_estimate, sizeof(double));
        const auto converged = static_cast<std::uint64_t>(result.converged);
        const auto missing = static_cast<std::uint64_t>(result.missing_wavelengths);
        const auto length = static_cast<std::uint64_t>(result.remark.size());
        append(bytes, &converged, sizeof converged);
        append(bytes, &missing, sizeof missing);
        append(bytes, &length, sizeof length);
        bytes += result.remark;
    }
    return bytes;
}

/// Reads what packed() wrote; its hash was checked.
class PartReader {
  public:
    explicit PartReader(std::string_view bytes) : bytes_(bytes) {}

    SceneResult result(std::size_t record) {
        SceneResult result;
        result.values.resize(record);
        take(result.values.data(), record * sizeof(double));
        take(&result.error_estimate, sizeof(double));
        std::uint64_t converged = 0, missing = 0, length = 0;
        take(&converged, sizeof converged);
        take(&missing, sizeof missing);
        take(&length, sizeof length);
        result.converged = converged != 0;
        result.missing_wavelengths = missing;
        result.remark.resize(std::min<std::size_t>(length, bytes_.size()));
        take(result.remark.data(), result.remark.size());
        return result;
    }
    bool is_whole() const { return is_whole_ && bytes_.empty(); }

  private:
    void take(void* data, std::size_t size) {
        is_whole_ = is_whole_ && size <= bytes_.size();
        if (!is_whole_) return;
        if (size > 0) std::memcpy(data, bytes_.data(), size);
        bytes_.remove_prefix(size);
    }

    std::string_view bytes_;
    bool is_whole_ = true;
};

}  // namespace

Chunks::Chunks(const Sweep& sweep, const Layout& layout) : scenes_(sweep.scenes()) {
    const std::size_t group = sweep.scenes_per_group();
    const std::size_t groups = (kFewestScenes + group - 1) / group;
    scenes_per_chunk_ = std::min(groups * group, kMostScenesPerChunk);
    const std::size_t record = std::max<std::size_t>(layout.record, 1);
    scenes_per_chunk_ = std::max<std::size_t>(std::min(scenes_per_chunk_, kMostValues / record), 1);
    if (sweep.scenes_per_chunk > 0) scenes_per_chunk_ = sweep.scenes_per_chunk;
}

Chunk Chunks::operator[](std::size_t number) const {
    const std::size_t first = number * scenes_per_chunk_;
    return {number, first, std::min(scenes_per_chunk_, scenes_ - first)};
}

std::string identity_of(const Sweep& sweep) {
    // The title and the text are for readers of tables; files in words count by their content.
    const auto& [title, words, dimensions, optical_dimensions, wavelength, incidence, reflection,
                 azimuth, outputs, derivatives, viewing, diffuse_fraction, sky, table_layout,
                 scenes_per_chunk, text, folder] = sweep;
    JobKey key("sweep");
    key.add(kVersion).add(dimensions).add(optical_dimensions).add(scenes_per_chunk);
    key.add(wavelength).add(incidence).add(reflection).add(azimuth);
    for (const TemplateWord& word : words) {
        key.add(word.name).add(word.values.size());
        for (const WordValue& value : word.values) key.add(value.index()).add(text_of(value));
    }
    return key.add(outputs)
        .add(derivatives)
        .add(viewing.illuminant)
        .add(viewing.observer)
        .add(diffuse_fraction)
        .add(sky.kind)
        .add(sky.wavelength_nm)
        .add(sky.zenith_deg)
        .add(sky.azimuth_deg)
        .add(sky.values)
        .add(table_layout)
        .hash();
}

fs::path Parts::folder_of(const fs::path& table) { return table.string() + ".parts"; }

Parts::Parts(const Sweep& sweep, const Layout& layout, fs::path folder)
    : sweep_(sweep),
      layout_(layout),
      chunks_(sweep, layout),
      folder_(std::move(folder)),
      identity_(identity_of(sweep)) {
    std::error_code error;
    fs::create_directories(folder_, error);
    if (error)
        throw InputError(
            fmt::format("cannot make the folder '{}': {}", folder_.string(), error.message()));
}

fs::path Parts::file_of(const Chunk& chunk) const {
    return folder_ / fmt::format("{}{:07}", kName, chunk.number);
}

std::string Parts::header_of(const Chunk& chunk) const {
    JobKey key("sweep chunk");
    key.add(identity_).add(chunk.first).add(chunk.count);
    // n and k, and files that the scene names, as the first scene of each group sees them.
    const std::size_t group = sweep_.scenes_per_group();
    for (std::size_t scene = chunk.first; scene < chunk.first + chunk.count;
         scene += group - scene % group) {
        const SceneLookUp found = look_up(sweep_, scene);
        for (const ResolvedScene& resolved : found.parts) {
            for (std::size_t w = 0; w < resolved.wavelength_nm.size(); ++w) resolved.add_to(key, w);
        }
        for (const auto& [places, reason] : found.refusals) key.add(reason);
    }
    return fmt::format("miebrdf sweep chunk {} of {} scenes {}\n", chunk.number, chunk.count,
                       key.hash());
}

std::optional<std::vector<SceneResult>> Parts::read(const Chunk& chunk) const {
    std::ifstream stream(file_of(chunk), std::ios::binary);
    if (!stream) return std::nullopt;
    const std::string file{std::istreambuf_iterator<char>(stream), {}};
    const std::string header = header_of(chunk);
    if (file.rfind(header, 0) != 0 || file.size() < header.size() + kHashLength)
        return std::nullopt;
    const std::string_view bytes = std::string_view(file).substr(header.size() + kHashLength);
    if (std::string_view(file).substr(header.size(), kHashLength) != checksum_of(header, bytes))
        return std::nullopt;
    PartReader reader(bytes);
    std::vector<SceneResult> results;
    for (std::size_t i = 0; i < chunk.count; ++i) results.push_back(reader.result(layout_.record));
    if (!reader.is_whole()) return std::nullopt;
    return results;
}

bool Parts::take(const Chunk& chunk, const std::string& launch) const {
    const std::string name = file_of(chunk).string() + ".taken-" + launch;
    // Exclusive creation is one step, on NFS too (since version 3). Should a file system break
    // that, two processes compute the same bytes.
    std::FILE* file = std::fopen(name.c_str(), "wx");
    if (file != nullptr) {
        std::fclose(file);
        return true;
    }
    if (errno == EEXIST) return false;
    throw InputError(fmt::format("cannot write '{}': {}", name, std::strerror(errno)));
}

std::optional<fs::file_time_type> Parts::time_of(const Chunk& chunk) const {
    std::error_code error;
    const auto time = fs::last_write_time(file_of(chunk), error);
    return error ? std::nullopt : std::optional(time);
}

void Parts::write(const Chunk& chunk, const std::vector<SceneResult>& results) const {
    const std::string bytes = packed(results);
    AtomicFile file(file_of(chunk));
    const std::string header = header_of(chunk);
    file.stream() << header << checksum_of(header, bytes) << bytes;
    file.commit();
}

fs::path Parts::unfinished_table(const fs::path& table) const {
    return folder_ / (kName + table.filename().string());
}

void Parts::remove() const {
    std::error_code ignored;
    for (const fs::directory_entry& entry : fs::directory_iterator(folder_, ignored)) {
        // Temporary files of processes that were killed begin with the name of a chunk too.
        if (entry.path().filename().string().rfind(kName, 0) == 0)
            fs::remove(entry.path(), ignored);
    }
    fs::remove_all(optics_folder(), ignored);
    fs::remove(folder_, ignored);
}

}  // namespace miebrdf::sweep
