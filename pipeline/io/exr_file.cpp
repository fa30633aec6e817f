#include "pipeline/io/exr_file.h"

#include <openexr.h>

#include <algorithm>
#include <array>
#include <cstdint>
#include <cstdio>
#include <cstring>
#include <ostream>
#include <stdexcept>

namespace miebrdf {
namespace {

/// Bounds of pictures that are read: OpenEXR allocates by what the header says.
constexpr int kLargestWidth = 1 << 16, kLargestHeight = 1 << 20;
constexpr int kPart = 0;

/// The last message of OpenEXR before it returns an error.
using Reason = std::array<char, 256>;

/// Owns an open file.
struct Context {
    exr_context_t handle = nullptr;
    Reason reason{};

    Context() = default;
    Context(const Context&) = delete;
    Context& operator=(const Context&) = delete;
    ~Context() {
        if (handle != nullptr) exr_finish(&handle);
    }
    void require(exr_result_t result) const {
        if (result == EXR_ERR_SUCCESS) return;
        if (reason[0] != '\0') throw std::runtime_error(reason.data());
        throw std::runtime_error(exr_get_default_error_message(result));
    }
};

}  // namespace

struct ExrReader::File : Context {
    std::string_view content;
    int x0 = 0, y0 = 0, width = 0, height = 0;
    std::vector<std::string> channels;
    exr_decode_pipeline_t decoder{};
    bool is_decoding = false;

    ~File() {
        if (is_decoding) exr_decoding_destroy(handle, &decoder);
    }
    void open();
    void require_compression() const;
    template <typename ReadChunk>
    void decode(int columns, int rows, int chunk_width, int chunk_height, ReadChunk chunk_info,
                std::span<const ExrPlane<float>> planes);
};

struct ExrWriter::File : Context {
    explicit File(std::ostream& stream) : out(stream) {}
    ~File() {
        if (is_encoding) exr_encoding_destroy(handle, &encoder);
    }

    std::ostream& out;
    std::uint64_t end = 0;  ///< bytes so far
    int width = 0, height = 0;
    std::vector<std::string> channels;  ///< sorted, as OpenEXR has them
    int lines_per_chunk = 0;
    int lines_written = 0;
    int lines_held = 0;       ///< of the chunk that is not full yet
    std::vector<float> held;  ///< channel by channel
    exr_encode_pipeline_t encoder{};
    bool is_encoding = false;

    void open(const ExrHeader& header);
    void write_chunk();
};

namespace {

/// OpenEXR calls these from C: nothing may be thrown.
template <typename File>
void keep_reason(exr_const_context_t context, exr_result_t, const char* message) {
    void* file = nullptr;
    if (context == nullptr || exr_get_user_data(context, &file) != EXR_ERR_SUCCESS) return;
    Reason& reason = static_cast<File*>(file)->reason;
    std::snprintf(reason.data(), reason.size(), "%s", message);
}

template <typename File>
std::int64_t size_of_content(exr_const_context_t, void* file) {
    return static_cast<std::int64_t>(static_cast<File*>(file)->content.size());
}

template <typename File>
std::int64_t read_content(exr_const_context_t, void* file, void* buffer, std::uint64_t size,
                          std::uint64_t offset, exr_stream_error_func_ptr_t) {
    const std::string_view content = static_cast<File*>(file)->content;
    if (offset > content.size()) return -1;
    const std::uint64_t count = std::min<std::uint64_t>(size, content.size() - offset);
    std::memcpy(buffer, content.data() + offset, count);
    return static_cast<std::int64_t>(count);
}

template <typename File>
std::int64_t write_content(exr_const_context_t, void* file, const void* buffer, std::uint64_t size,
                           std::uint64_t offset, exr_stream_error_func_ptr_t) {
    std::ostream& out = static_cast<File*>(file)->out;
    std::uint64_t& end = static_cast<File*>(file)->end;
    const auto seek = [&](std::uint64_t to) {
        const auto position = static_cast<std::streamoff>(to);
        if (out.tellp() != position) out.seekp(position);
    };
    try {
        // OpenEXR leaves out the table of chunks until it is known; streams in memory cannot seek
        // beyond what was written.
        if (offset > end) seek(end);
        for (; offset > end; ++end) out.put('\0');
        seek(offset);
        out.write(static_cast<const char*>(buffer), static_cast<std::streamsize>(size));
        end = std::max(end, offset + size);
    } catch (const std::ios_base::failure&) {
        return -1;
    }
    return out ? static_cast<std::int64_t>(size) : -1;
}

}  // namespace

void ExrReader::File::open() {
    exr_context_initializer_t options = EXR_DEFAULT_CONTEXT_INITIALIZER;
    options.error_handler_fn = keep_reason<File>;
    options.user_data = this;
    options.read_fn = read_content<File>;
    options.size_fn = size_of_content<File>;
    options.max_image_width = kLargestWidth;
    options.max_image_height = kLargestHeight;
    require(exr_start_read(&handle, "exr", &options));
    exr_attr_box2i_t window;
    require(exr_get_data_window(handle, kPart, &window));
    x0 = window.min.x;
    y0 = window.min.y;
    width = window.max.x - window.min.x + 1;
    height = window.max.y - window.min.y + 1;
    const exr_attr_chlist_t* list = nullptr;
    require(exr_get_channels(handle, kPart, &list));
    for (int c = 0; c < list->num_channels; ++c)
        channels.emplace_back(list->entries[c].name.str, list->entries[c].name.length);
}

/// Whether OpenEXR's interface for C knows it.
void ExrReader::File::require_compression() const {
    exr_compression_t compression;
    require(exr_get_compression(handle, kPart, &compression));
    if (compression != EXR_COMPRESSION_DWAA && compression != EXR_COMPRESSION_DWAB) return;
    int major = 0, minor = 0, patch = 0;
    const char* extra = nullptr;
    exr_get_library_version(&major, &minor, &patch, &extra);
    if (major < 3 || (major == 3 && minor < 2))
        throw std::runtime_error(
            "it is compressed by DWA, which needs OpenEXR 3.2; ZIP and PIZ do not");
}

/// All chunks of a picture, which are blocks of lines or tiles, column by column and row by row.
template <typename ReadChunk>
void ExrReader::File::decode(int columns, int rows, int chunk_width, int chunk_height,
                             ReadChunk chunk_info, std::span<const ExrPlane<float>> planes) {
    std::vector<float> unwanted;
    for (int row = 0; row < rows; ++row) {
        for (int column = 0; column < columns; ++column) {
            exr_chunk_info_t chunk;
            require(chunk_info(column, row, &chunk));
            unwanted.resize(std::size_t(chunk.width) * std::size_t(chunk.height));
            const bool is_first = !is_decoding;
            require(is_first ? exr_decoding_initialize(handle, kPart, &chunk, &decoder)
                             : exr_decoding_update(handle, kPart, &chunk, &decoder));
            is_decoding = true;
            for (int c = 0; c < decoder.channel_count; ++c) {
                exr_coding_channel_info_t& channel = decoder.channels[c];
                const auto plane = std::find_if(planes.begin(), planes.end(), [&](const auto& p) {
                    return p.channel == channel.channel_name;
                });
                if (plane == planes.end()) {
                    // OpenEXR 3.1 says that null leaves a channel out, and writes to it if all
                    // channels are of half floats.
                    channel.decode_to_ptr = reinterpret_cast<std::uint8_t*>(unwanted.data());
                    channel.user_pixel_stride = channel.user_bytes_per_element;
                    channel.user_line_stride = channel.width * channel.user_bytes_per_element;
                    continue;
                }
                if (channel.x_samples != 1 || channel.y_samples != 1)
                    throw std::runtime_error("channel " + plane->channel + " has fewer pixels");
                channel.decode_to_ptr = reinterpret_cast<std::uint8_t*>(
                    plane->values +
                    std::size_t(row) * std::size_t(chunk_height) * plane->line_stride +
                    std::size_t(column) * std::size_t(chunk_width) * plane->pixel_stride);
                channel.user_data_type = EXR_PIXEL_FLOAT;
                channel.user_bytes_per_element = sizeof(float);
                channel.user_pixel_stride =
                    static_cast<std::int32_t>(plane->pixel_stride * sizeof(float));
                channel.user_line_stride =
                    static_cast<std::int32_t>(plane->line_stride * sizeof(float));
            }
            if (is_first) require(exr_decoding_choose_default_routines(handle, kPart, &decoder));
            require(exr_decoding_run(handle, kPart, &decoder));
        }
    }
}

ExrReader::ExrReader(std::string_view content) : file_(std::make_unique<File>()) {
    file_->content = content;
    file_->open();
}

ExrReader::~ExrReader() = default;
int ExrReader::width() const { return file_->width; }
int ExrReader::height() const { return file_->height; }
bool ExrReader::begins_at_origin() const { return file_->x0 == 0 && file_->y0 == 0; }
const std::vector<std::string>& ExrReader::channels() const { return file_->channels; }

std::optional<std::vector<float>> ExrReader::list(const char* attribute) const {
    std::int32_t size = 0;
    const float* values = nullptr;
    if (exr_attr_get_float_vector(file_->handle, kPart, attribute, &size, &values) !=
        EXR_ERR_SUCCESS)
        return std::nullopt;
    return std::vector<float>(values, values + size);
}

std::optional<double> ExrReader::number(const char* attribute) const {
    double value = 0.0;
    if (exr_attr_get_double(file_->handle, kPart, attribute, &value) != EXR_ERR_SUCCESS)
        return std::nullopt;
    return value;
}

void ExrReader::read(std::span<const ExrPlane<float>> planes) const {
    const Context& file = *file_;
    file_->require_compression();
    exr_storage_t storage;
    file.require(exr_get_storage(file.handle, kPart, &storage));
    const auto pieces = [](int whole, int piece) { return (whole - 1) / piece + 1; };
    if (storage == EXR_STORAGE_SCANLINE) {
        std::int32_t lines = 0;
        file.require(exr_get_scanlines_per_chunk(file.handle, kPart, &lines));
        const auto chunk_info = [&](int, int row, exr_chunk_info_t* chunk) {
            return exr_read_scanline_chunk_info(file.handle, kPart, file_->y0 + row * lines, chunk);
        };
        file_->decode(1, pieces(file_->height, lines), file_->width, lines, chunk_info, planes);
    } else if (storage == EXR_STORAGE_TILED) {
        std::int32_t width = 0, height = 0;
        constexpr int kFinest = 0;
        file.require(exr_get_tile_sizes(file.handle, kPart, kFinest, kFinest, &width, &height));
        const auto chunk_info = [&](int column, int row, exr_chunk_info_t* chunk) {
            return exr_read_tile_chunk_info(file.handle, kPart, column, row, kFinest, kFinest,
                                            chunk);
        };
        file_->decode(pieces(file_->width, width), pieces(file_->height, height), width, height,
                      chunk_info, planes);
    } else {
        throw std::runtime_error("pixels with several depths");
    }
}

void ExrWriter::File::open(const ExrHeader& header) {
    exr_context_initializer_t options = EXR_DEFAULT_CONTEXT_INITIALIZER;
    options.error_handler_fn = keep_reason<File>;
    options.user_data = this;
    options.write_fn = write_content<File>;
    require(exr_start_write(&handle, "exr", EXR_WRITE_FILE_DIRECTLY, &options));
    int part = 0;
    require(exr_add_part(handle, nullptr, EXR_STORAGE_SCANLINE, &part));
    require(exr_initialize_required_attr_simple(handle, part, header.width, header.height,
                                                EXR_COMPRESSION_ZIP));
    for (const std::string& channel : header.channels)
        require(exr_add_channel(handle, part, channel.c_str(), EXR_PIXEL_FLOAT,
                                EXR_PERCEPTUALLY_LOGARITHMIC, 1, 1));
    for (const auto& [name, text] : header.texts)
        require(exr_attr_set_string(handle, part, name.c_str(), text.c_str()));
    for (const auto& [name, list] : header.lists)
        require(exr_attr_set_float_vector(handle, part, name.c_str(),
                                          static_cast<std::int32_t>(list.size()), list.data()));
    for (const auto& [name, number] : header.numbers)
        require(exr_attr_set_double(handle, part, name.c_str(), number));
    require(exr_write_header(handle));
    require(exr_get_scanlines_per_chunk(handle, part, &lines_per_chunk));
    width = header.width;
    height = header.height;
    channels = header.channels;
    std::sort(channels.begin(), channels.end());
    held.resize(channels.size() * std::size_t(lines_per_chunk) * std::size_t(width));
}

/// Compresses and writes the lines that are held.
void ExrWriter::File::write_chunk() {
    exr_chunk_info_t chunk;
    require(exr_write_scanline_chunk_info(handle, kPart, lines_written, &chunk));
    const bool is_first = !is_encoding;
    require(is_first ? exr_encoding_initialize(handle, kPart, &chunk, &encoder)
                     : exr_encoding_update(handle, kPart, &chunk, &encoder));
    is_encoding = true;
    for (int c = 0; c < encoder.channel_count; ++c) {
        exr_coding_channel_info_t& channel = encoder.channels[c];
        channel.encode_from_ptr = reinterpret_cast<const std::uint8_t*>(
            &held[std::size_t(c) * std::size_t(lines_per_chunk) * std::size_t(width)]);
        channel.user_data_type = EXR_PIXEL_FLOAT;
        channel.user_bytes_per_element = sizeof(float);
        channel.user_pixel_stride = sizeof(float);
        channel.user_line_stride = width * static_cast<std::int32_t>(sizeof(float));
    }
    if (is_first) require(exr_encoding_choose_default_routines(handle, kPart, &encoder));
    require(exr_encoding_run(handle, kPart, &encoder));
    lines_written += lines_held;
    lines_held = 0;
}

ExrWriter::ExrWriter(std::ostream& out, const ExrHeader& header)
    : file_(std::make_unique<File>(out)) {
    file_->open(header);
}

ExrWriter::~ExrWriter() = default;

void ExrWriter::write_lines(int count, std::span<const ExrPlane<const float>> planes) {
    File& file = *file_;
    std::vector<const ExrPlane<const float>*> sorted;
    for (const std::string& channel : file.channels) {
        const auto plane = std::find_if(planes.begin(), planes.end(),
                                        [&](const auto& p) { return p.channel == channel; });
        if (plane == planes.end()) throw std::runtime_error("no plane for channel " + channel);
        sorted.push_back(&*plane);
    }
    const auto width = std::size_t(file.width);
    for (int y = 0; y < count; ++y) {
        float* to = &file.held[std::size_t(file.lines_held) * width];
        for (const auto* plane : sorted) {
            const float* from = plane->values + std::size_t(y) * plane->line_stride;
            for (std::size_t x = 0; x < width; ++x) to[x] = from[x * plane->pixel_stride];
            to += std::size_t(file.lines_per_chunk) * width;
        }
        ++file.lines_held;
        if (file.lines_held == file.lines_per_chunk ||
            file.lines_written + file.lines_held == file.height)
            file.write_chunk();
    }
}

void ExrWriter::finish() {
    File& file = *file_;
    if (file.lines_written != file.height) throw std::runtime_error("the picture ends early");
    if (file.is_encoding) exr_encoding_destroy(file.handle, &file.encoder);
    file.is_encoding = false;
    exr_context_t closing = file.handle;
    file.handle = nullptr;
    const exr_result_t result = exr_finish(&closing);  // the table of chunks
    file.require(result);
}

#undef EXR

}  // namespace miebrdf
