#include "pipeline/formats/radiance_xml.h"

#include <fmt/format.h>

#include <algorithm>
#include <nlohmann/json.hpp>
#include <ostream>

#include "pipeline/formats/metadata.h"
#include "pipeline/io/markup.h"

namespace miebrdf::exports {
namespace {

/// Linear sRGB to CIE XYZ (IEC 61966-2-1).
constexpr double kXyz[3][3] = {
    {0.4124, 0.3576, 0.1805}, {0.2126, 0.7152, 0.0722}, {0.0193, 0.1192, 0.9505}};

}  // namespace

std::array<double, 3> xyz_of(const double* rgb) {
    std::array<double, 3> xyz{};
    for (std::size_t i = 0; i < 3; ++i) {
        for (std::size_t c = 0; c < 3; ++c) xyz[i] += kXyz[i][c] * rgb[c];
        xyz[i] = std::max(xyz[i], 0.0);
    }
    return xyz;
}

void write_radiance_head(const RgbSource& source, const std::string& definition,
                         std::ostream& out) {
    auto description = metadata(source, {.format = "radiance",
                                         .cosine_included = false,
                                         .azimuth_zero = "mirror side",
                                         .colour = source.weights().description});
    std::string comment = description.dump(1);
    // Two hyphens end an XML comment.
    for (std::size_t at; (at = comment.find("--")) != comment.npos;) comment.replace(at, 2, "- -");
    out << "<?xml version=\"1.0\" encoding=\"UTF-8\"?>\n<!--\n" << comment << "\n-->\n";
    out << "<WindowElement xmlns=\"http://windows.lbl.gov\" "
           "xmlns:xsi=\"http://www.w3.org/2001/XMLSchema-instance\" "
           "xsi:schemaLocation=\"http://windows.lbl.gov/BSDF-v1.4.xsd\">\n"
           "<WindowElementType>System</WindowElementType>\n<FileType>BSDF</"
           "FileType>\n<Optical>\n<Layer>\n<Material>\n";
    out << "<Name>" << escape_markup(source.provenance().title) << "</Name>\n<Manufacturer>"
        << escape_markup(source.provenance().version)
        << "</Manufacturer>\n<DeviceType>Other</DeviceType>\n</Material>\n";
    out << definition;
}

void write_radiance_band(const RadianceBand& band, const std::string& basis, std::size_t row,
                         std::ostream& out) {
    // The names are those of a window seen from inside: what Radiance calls the front is its back.
    out << "<WavelengthData>\n<LayerNumber>System</LayerNumber>\n<Wavelength unit=\"Integral\">"
        << band.wavelength
        << "</Wavelength>\n<SourceSpectrum>CIE Illuminant D65 "
           "1nm.ssp</SourceSpectrum>\n<DetectorSpectrum>"
        << band.detector
        << "</DetectorSpectrum>\n<WavelengthDataBlock>\n<WavelengthDataDirection>Reflection "
           "Back</WavelengthDataDirection>\n"
        << basis << "<ScatteringDataType>BRDF</ScatteringDataType>\n<ScatteringData>\n";
    out << (row == 0 ? "{\n" : "");
    const std::size_t line = row == 0 ? 8 : row;
    for (std::size_t i = 0; i < band.values.size(); i += line) {
        const auto first = band.values.begin() + static_cast<std::ptrdiff_t>(i);
        const auto last = band.values.begin() +
                          static_cast<std::ptrdiff_t>(std::min(i + line, band.values.size()));
        out << fmt::format("{:.7g}\n", fmt::join(first, last, row == 0 ? " " : ",\t"));
    }
    if (row == 0) {
        for (std::size_t i = 0; i < band.values.size(); i += line) out << "0 0 0 0 0 0 0 0\n";
        out << "}\n";
    }
    out << "</ScatteringData>\n</WavelengthDataBlock>\n</WavelengthData>\n";
}

void write_radiance_tail(std::ostream& out) { out << "</Layer>\n</Optical>\n</WindowElement>\n"; }

}  // namespace miebrdf::exports
