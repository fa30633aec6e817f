#include "pipeline/formats/radiance/bsdf_xml.h"

#include <fmt/format.h>

#include <algorithm>
#include <nlohmann/json.hpp>
#include <ostream>

#include "pipeline/io/markup.h"

namespace miebrdf {
namespace {

/// XYZ of Radiance's own R, G and B (src/common/color.h: primaries (.640, .330), (.290, .600),
/// (.150, .060), neutral at X = Y = Z): what it renders are then the numbers of linear sRGB, and
/// grey is grey. Relative to D65 every neutral would come out bluish.
constexpr double kXyz[3][3] = {{0.5141446208, 0.3238844797, 0.1619708995},
                               {0.2651058201, 0.6701058201, 0.0647883598},
                               {0.0241005291, 0.1228527337, 0.8530467372}};

}  // namespace

std::array<double, 3> radiance_xyz(const double* rgb) {
    std::array<double, 3> xyz{};
    for (std::size_t i = 0; i < 3; ++i) {
        for (std::size_t c = 0; c < 3; ++c) xyz[i] += kXyz[i][c] * rgb[c];
        xyz[i] = std::max(xyz[i], 0.0);
    }
    return xyz;
}

void write_radiance_head(const RgbSource& source, const std::string& definition,
                         std::ostream& out) {
    const auto description = metadata(source, {.format = "radiance",
                                               .cosine_included = false,
                                               .azimuth_zero = "mirror side",
                                               .colour = source.weights().description});
    out << "<?xml version=\"1.0\" encoding=\"UTF-8\"?>\n<!--\n"
        << in_xml_comment(description.dump(1)) << "\n-->\n";
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
    out << "<WavelengthData>\n<LayerNumber>System</LayerNumber>\n<Wavelength unit=\"Integral\">"
        << band.wavelength
        << "</Wavelength>\n<SourceSpectrum>CIE Illuminant D65 "
           "1nm.ssp</SourceSpectrum>\n<DetectorSpectrum>"
        << band.detector << "</DetectorSpectrum>\n<WavelengthDataBlock>\n<WavelengthDataDirection>"
        << band.direction << "</WavelengthDataDirection>\n"
        << basis << "<ScatteringDataType>" << (band.direction[0] == 'T' ? "BTDF" : "BRDF")
        << "</ScatteringDataType>\n<ScatteringData>\n";
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

}  // namespace miebrdf
