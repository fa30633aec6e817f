// Spectral OpenEXR tables of ours: channels by wavelength, directions from attributes.
#include <ImfChannelList.h>
#include <ImfFloatVectorAttribute.h>
#include <ImfFrameBuffer.h>
#include <ImfHeader.h>
#include <ImfIO.h>
#include <ImfInputFile.h>
#include <fmt/format.h>

#include <algorithm>
#include <charconv>
#include <cstring>

#include <miebrdf/error.h>
#include "pipeline/formats/readers/exr_header.h"
#include "pipeline/formats/readers/grid_file.h"

namespace miebrdf::exports {
namespace {

class MemoryStream : public Imf::IStream {
  public:
    explicit MemoryStream(std::string_view content) : IStream("exr"), content_(content) {}
    bool read(char bytes[], int count) override {
        if (count < 0 || static_cast<std::uint64_t>(count) > content_.size() - position_) {
            throw InputError("exr: the file ends early");
        }
        std::memcpy(bytes, content_.data() + position_, static_cast<std::size_t>(count));
        position_ += static_cast<std::size_t>(count);
        return position_ < content_.size();
    }
    uint64_t tellg() override { return position_; }
    void seekg(uint64_t position) override {
        if (position > content_.size()) throw InputError("exr: the file points beyond its end");
        position_ = position;
    }

  private:
    std::string_view content_;
    std::size_t position_ = 0;
};

std::vector<double> list_attribute(const Imf::Header& header, const char* name) {
    const auto* attribute = header.findTypedAttribute<Imf::FloatVectorAttribute>(name);
    if (attribute == nullptr) throw InputError(fmt::format("exr: no attribute '{}'", name));
    return {attribute->value().begin(), attribute->value().end()};
}

/// Wavelength of T.550,000000nm; 0 for other channels.
double wavelength_of(const std::string& channel) {
    if (!channel.starts_with("T.") || !channel.ends_with("nm")) return 0.0;
    std::string number = channel.substr(2, channel.size() - 4);
    std::replace(number.begin(), number.end(), ',', '.');
    double value = 0.0;
    const auto [end, error] = std::from_chars(number.data(), number.data() + number.size(), value);
    return error == std::errc() && end == number.data() + number.size() ? value : 0.0;
}

GridTable read_table(std::string_view content) {
    check_exr_header(content);
    MemoryStream stream(content);
    Imf::InputFile file(stream, 0);
    const Imf::Header& header = file.header();
    GridTable table;
    table.format = "exr";
    table.in = list_attribute(header, "mu_in");
    table.out = list_attribute(header, "mu_out");
    table.azimuth_deg = list_attribute(header, "azimuth_deg");
    std::vector<std::pair<double, std::string>> spectral;
    for (auto channel = header.channels().begin(); channel != header.channels().end(); ++channel) {
        const double wavelength = wavelength_of(channel.name());
        if (wavelength > 0) spectral.emplace_back(wavelength, channel.name());
    }
    std::sort(spectral.begin(), spectral.end());
    const auto& window = header.dataWindow();
    const auto width = static_cast<std::int64_t>(window.max.x) - window.min.x + 1;
    const auto height = static_cast<std::int64_t>(window.max.y) - window.min.y + 1;
    if (window.min.x != 0 || window.min.y != 0 ||
        width != static_cast<std::int64_t>(table.azimuth_deg.size()) ||
        height != static_cast<std::int64_t>(table.in.size() * table.out.size())) {
        throw InputError("exr: the image does not fit the attributes mu_in, mu_out, azimuth_deg");
    }
    const auto pixels = static_cast<std::uint64_t>(width * height);
    if (pixels * spectral.size() * sizeof(float) > kLargestExpansion * content.size()) {
        throw InputError(fmt::format("exr: {} x {} x {} values in a file of {} bytes", width,
                                     height, spectral.size(), content.size()));
    }
    std::vector<float> planes(pixels * spectral.size());
    Imf::FrameBuffer buffer;
    for (std::size_t c = 0; c < spectral.size(); ++c) {
        table.wavelength_nm.push_back(spectral[c].first);
        buffer.insert(spectral[c].second,
                      Imf::Slice(Imf::FLOAT, reinterpret_cast<char*>(&planes[c * pixels]),
                                 sizeof(float), sizeof(float) * static_cast<std::size_t>(width)));
    }
    file.setFrameBuffer(buffer);
    file.readPixels(window.min.y, window.max.y);
    table.count = planes.size();
    table.value = [planes = std::move(planes)](std::size_t i) { return double(planes[i]); };
    return table;
}

}  // namespace

bool looks_like_exr(std::string_view content) { return content.starts_with("\x76\x2f\x31\x01"); }

std::unique_ptr<BrdfFile> read_exr(std::string content) {
    Imf::Header::setMaxImageSize(1 << 16, 1 << 20);  // of what the library will allocate for
    try {
        return make_grid_file(read_table(content));
    } catch (const InputError&) {
        throw;
    } catch (const std::exception& error) {  // OpenEXR's own
        throw InputError(fmt::format("exr: {}", error.what()));
    }
}

}  // namespace miebrdf::exports
