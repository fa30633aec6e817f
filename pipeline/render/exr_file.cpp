#include <ImfChannelList.h>
#include <ImfFrameBuffer.h>
#include <ImfHeader.h>
#include <ImfInputFile.h>
#include <ImfOutputFile.h>
#include <ImfStringAttribute.h>
#include <fmt/format.h>

#include <filesystem>

#include <miebrdf/error.h>
#include "pipeline/io/atomic_file.h"
#include "pipeline/render/image.h"

namespace miebrdf::render {
namespace {

/// A float slice of one channel of an image that starts at pixel (x0, y0) of the file.
Imf::Slice slice_of(Image& image, int channel, int x0, int y0) {
    const std::size_t x_stride = sizeof(float) * std::size_t(image.channels);
    const std::size_t y_stride = x_stride * std::size_t(image.width);
    char* base = reinterpret_cast<char*>(image.values.data() + channel);
    base -= std::ptrdiff_t(x0) * std::ptrdiff_t(x_stride) +
            std::ptrdiff_t(y0) * std::ptrdiff_t(y_stride);
    return Imf::Slice(Imf::FLOAT, base, x_stride, y_stride);
}

Image read_open_exr(Imf::InputFile& file, const std::string& path) {
    const Imath::Box2i window = file.header().dataWindow();
    Image image(window.max.x - window.min.x + 1, window.max.y - window.min.y + 1, 3);
    const Imf::ChannelList& channels = file.header().channels();
    const bool is_grey =
        channels.findChannel("R") == nullptr && channels.findChannel("Y") != nullptr;
    const char* const names[] = {"R", "G", "B"};
    Imf::FrameBuffer buffer;
    for (int c = 0; c < (is_grey ? 1 : 3); ++c) {
        const char* name = is_grey ? "Y" : names[c];
        if (channels.findChannel(name) == nullptr) {
            throw InputError(
                fmt::format("{}: has no channel {}; wanted: R, G, B or Y", path, name));
        }
        buffer.insert(name, slice_of(image, c, window.min.x, window.min.y));
    }
    file.setFrameBuffer(buffer);
    file.readPixels(window.min.y, window.max.y);
    if (is_grey) {
        for (std::size_t i = 0; i < image.values.size(); i += 3) {
            image.values[i + 1] = image.values[i + 2] = image.values[i];
        }
    }
    return image;
}

}  // namespace

Image read_exr(const std::string& path) {
    if (!std::filesystem::exists(path)) throw InputError(fmt::format("{}: no such file", path));
    try {
        Imf::InputFile file(path.c_str(), 1);
        return read_open_exr(file, path);
    } catch (const InputError&) {
        throw;
    } catch (const std::exception& error) {
        throw InputError(fmt::format("{}: cannot be read as OpenEXR: {}", path, error.what()));
    }
}

void write_exr(const Image& image, const std::vector<std::string>& channel_names,
               const PictureNotes& notes, const std::string& path) {
    if (channel_names.size() != std::size_t(image.channels)) {
        throw std::invalid_argument(
            fmt::format("{} channel names for {} channels", channel_names.size(), image.channels));
    }
    Image copy = image;  // OpenEXR's slices take pointers to what may change
    Imf::Header header(image.width, image.height);
    header.compression() = Imf::ZIP_COMPRESSION;
    Imf::FrameBuffer buffer;
    for (int c = 0; c < image.channels; ++c) {
        const std::string& name = channel_names[std::size_t(c)];
        header.channels().insert(name, Imf::Channel(Imf::FLOAT));
        buffer.insert(name, slice_of(copy, c, 0, 0));
    }
    for (const auto& [key, text] : notes) header.insert(key, Imf::StringAttribute(text));
    AtomicFile target(path);
    try {
        Imf::OutputFile file(target.temporary_path().c_str(), header, 1);
        file.setFrameBuffer(buffer);
        file.writePixels(image.height);
    } catch (const std::exception& error) {
        throw InputError(fmt::format("{}: cannot be written: {}", path, error.what()));
    }
    target.commit();
}

}  // namespace miebrdf::render
