#include "pipeline/exports/exr_writer.h"

#include <ImfChannelList.h>
#include <ImfFloatVectorAttribute.h>
#include <ImfFrameBuffer.h>
#include <ImfHeader.h>
#include <ImfIO.h>
#include <ImfOutputFile.h>
#include <ImfStringAttribute.h>
#include <fmt/format.h>

#include <algorithm>
#include <nlohmann/json.hpp>
#include <numbers>

#include "pipeline/error.h"
#include "pipeline/exports/metadata.h"

namespace miebrdf::exports {
namespace {

class StreamAdapter : public Imf::OStream {
  public:
    explicit StreamAdapter(std::ostream& out) : OStream("spectral BRDF"), out_(out) {}
    void write(const char bytes[], int count) override {
        out_.write(bytes, count);
        if (!out_) throw InputError("exr: cannot write");
    }
    uint64_t tellp() override { return static_cast<uint64_t>(out_.tellp()); }
    void seekp(uint64_t position) override { out_.seekp(static_cast<std::streamoff>(position)); }

  private:
    std::ostream& out_;
};

Imf::FloatVector floats(const std::vector<double>& numbers) {
    return {numbers.begin(), numbers.end()};
}

/// The paper's name of a reflectance channel: a decimal comma, since a point separates layers.
std::string channel_name(double wavelength_nm) {
    std::string number = fmt::format("{:.6f}", wavelength_nm);
    std::replace(number.begin(), number.end(), '.', ',');
    return "T." + number + "nm";
}

}  // namespace

void write_exr(const BrdfSource& source, const RgbWeights& preview, const TableGrid& grid,
               std::ostream& out, const RunControl& control) {
    require_wavelengths(source, "exr");
    const std::vector<double> table = tabulate(source, grid, control);
    const std::size_t wavelengths = source.wavelength_nm().size(), pixels = grid.size();
    std::vector<float> planes(table.begin(), table.end());
    planes.resize((wavelengths + 3) * pixels, 0.0f);
    for (std::size_t c = 0; c < 3; ++c) {
        float* plane = &planes[(wavelengths + c) * pixels];
        for (std::size_t p = 0; p < pixels; ++p) {
            double sum = 0.0;
            for (std::size_t w = 0; w < wavelengths; ++w)
                sum += preview.weight[w][c] * table[w * pixels + p];
            plane[p] = static_cast<float>(std::numbers::pi * sum);
        }
    }

    const int width = static_cast<int>(grid.azimuth_deg.size());
    const int height = static_cast<int>(grid.mu_in.size() * grid.mu_out.size());
    Imf::Header header(width, height);
    header.compression() = Imf::ZIP_COMPRESSION;
    header.insert("spectralLayoutVersion", Imf::StringAttribute("1.0"));
    header.insert("mu_in", Imf::FloatVectorAttribute(floats(grid.mu_in)));
    header.insert("mu_out", Imf::FloatVectorAttribute(floats(grid.mu_out)));
    header.insert("azimuth_deg", Imf::FloatVectorAttribute(floats(grid.azimuth_deg)));
    const auto description =
        metadata(source, {.format = "exr",
                          .cosine_included = false,
                          .azimuth_zero = "mirror side",
                          .colour = "R, G, B: pi times the BRDF; " + preview.description});
    header.insert("miebrdf", Imf::StringAttribute(description.dump()));

    Imf::FrameBuffer buffer;
    const auto add = [&](const std::string& name, std::size_t plane) {
        header.channels().insert(name, Imf::Channel(Imf::FLOAT));
        buffer.insert(name,
                      Imf::Slice(Imf::FLOAT, reinterpret_cast<char*>(&planes[plane * pixels]),
                                 sizeof(float), sizeof(float) * static_cast<std::size_t>(width)));
    };
    for (std::size_t w = 0; w < wavelengths; ++w) add(channel_name(source.wavelength_nm()[w]), w);
    for (std::size_t c = 0; c < 3; ++c) add(std::string(1, "RGB"[c]), wavelengths + c);
    StreamAdapter adapter(out);
    Imf::OutputFile file(adapter, header, 0);  // no threads of its own
    file.setFrameBuffer(buffer);
    file.writePixels(height);
}

}  // namespace miebrdf::exports
