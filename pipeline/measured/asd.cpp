// ASD field spectrometers (FieldSpec): binary files "ASD", "as6", "as7", "as8". The spectrum of the
// sample and that of the white panel follow each other; their ratio is the reflectance factor.
// Layout: "ASD File Format version 8", ASD Inc., 2012.
#include <fmt/format.h>

#include <algorithm>
#include <cstdint>

#include "materials/readers/text.h"
#include "pipeline/measured/reader.h"

namespace miebrdf::measured {
namespace {

// Places in the header, in bytes.
constexpr std::size_t kDataType = 186, kFirstWavelength = 191, kStep = 195, kNumberFormat = 199,
                      kChannels = 204, kSpectrum = 484;
/// Between the two spectra: a flag, two times, and a text with its length before it.
constexpr std::size_t kBeforeText = 18;
constexpr int kMostChannels = 100000;
/// Bytes that do not belong together give numbers of any exponent.
constexpr double kLeastValue = 1e-25;

enum DataType { kRaw = 0, kReflectance = 1, kTransmittance = 6 };

std::string type_name(int type) {
    static constexpr const char* kNames[] = {"raw",           "reflectance", "radiance",
                                             "no units",      "irradiance",  "quality index",
                                             "transmittance", "unknown",     "absorbance"};
    return type >= 0 && type < 9 ? kNames[type] : fmt::format("{}", type);
}

std::string_view take(const MeasuredFile& file, std::string_view& bytes, std::size_t count) {
    if (count > bytes.size()) {
        refuse(file, 0,
               fmt::format("the file ends {} bytes early (at byte {})", count - bytes.size(),
                           file.content.size()));
    }
    const std::string_view part = bytes.substr(0, count);
    bytes.remove_prefix(count);
    return part;
}

/// Takes a spectrum off the bytes. @throws ImportError  where they end early
std::vector<double> spectrum_of(const MeasuredFile& file, std::string_view& bytes, int format,
                                std::size_t channels) {
    std::vector<double> values;
    const std::size_t size = channels * (format == 2 ? 8 : 4);
    const std::string_view part = take(file, bytes, size);
    for (std::size_t i = 0; i < channels; ++i) {
        values.push_back(format == 2   ? number_in<double>(part, 8 * i)
                         : format == 0 ? double(number_in<float>(part, 4 * i))
                                       : double(number_in<std::int32_t>(part, 4 * i)));
        const double size_of_value = std::abs(values.back());
        if (size_of_value > 0.0 && size_of_value < kLeastValue) {
            refuse(file, 0,
                   fmt::format("channel {} is {:g}, which no instrument writes: bytes are lost, or "
                               "there are too many",
                               i + 1, values.back()));
        }
    }
    return values;
}

bool looks_like_asd(const MeasuredFile& file) {
    const std::string_view start = file.content.substr(0, 3);
    return file.content.size() > kSpectrum &&
           (start == "ASD" || start == "asd" || start == "as6" || start == "as7" ||
            start == "as8") &&
           file.content.find('\0') != std::string_view::npos;
}

Measurements read_asd(const MeasuredFile& file, const MeasuredOptions&) {
    if (file.content.size() <= kSpectrum) refuse(file, 0, "ends within its header");
    Measurements list;
    const int type = static_cast<unsigned char>(file.content[kDataType]);
    const int format = static_cast<unsigned char>(file.content[kNumberFormat]);
    const int channels = number_in<std::int16_t>(file.content, kChannels);
    const double first = double(number_in<float>(file.content, kFirstWavelength));
    const double step = double(number_in<float>(file.content, kStep));
    if (!(first > 0.0 && step > 0.0 && std::isfinite(first + step * channels) && channels > 1 &&
          channels < kMostChannels) ||
        format > 2) {
        refuse(file, 0,
               fmt::format("damaged header: {} channels from {} nm in steps of {} nm, number "
                           "format {}",
                           channels, first, step, format));
    }
    const bool has_panel = file.content.substr(0, 3) != "ASD" && file.content.substr(0, 3) != "asd";
    const bool ratio =
        has_panel && (type == kRaw || type == kReflectance || type == kTransmittance);
    if (!ratio && type != kReflectance && type != kTransmittance) {
        refuse(file, 0,
               fmt::format("holds {} without a white panel: no reflectance can be made of it; "
                           "export reflectance from the instrument's program",
                           type_name(type)));
    }
    std::string_view bytes = file.content.substr(kSpectrum);
    const auto count = static_cast<std::size_t>(channels);
    std::vector<double> values = spectrum_of(file, bytes, format, count), nm;
    if (ratio) {
        const std::string_view between = take(file, bytes, kBeforeText + 2);
        take(file, bytes, number_in<std::uint16_t>(between, kBeforeText));
        const std::vector<double> panel = spectrum_of(file, bytes, format, count);
        // Integration time and gains are the same for both, and leave the ratio.
        for (std::size_t i = 0; i < values.size(); ++i) values[i] /= panel[i];
    }
    for (std::size_t i = 0; i < values.size(); ++i) {
        nm.push_back(first + step * double(i));
        if (is_fill(values[i])) values[i] = MeasuredValue::kNone;  // a panel of 0, too
    }
    list.facts.emplace_back("data",
                            type_name(type) + (ratio ? ", relative to the white panel" : ""));
    const std::string_view words = file.content.substr(3, 157);
    const std::string comment =
        materials::as_utf8(words.substr(0, std::min(words.find('\0'), words.size())));
    if (!comment.empty()) list.facts.emplace_back("comment", comment);
    const auto quantity = type == kTransmittance ? MeasuredQuantity::transmittance
                                                 : MeasuredQuantity::reflectance_factor;
    add_spectrum(list, "spectrum", {quantity, MeasuredGeometry::unknown}, MeasuredValue::kNone, nm,
                 values);
    return list;
}

}  // namespace

extern const Reader kAsd;
constinit const Reader kAsd{{"asd", "ASD field spectrometers (.asd)"}, looks_like_asd, read_asd};

}  // namespace miebrdf::measured
