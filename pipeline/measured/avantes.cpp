// Binary files of Avantes' programs: counts of the sample, of the white reference and in the dark,
// whose ratio (sample - dark) / (reference - dark) is what the programs show. AvaSoft 6 and 7
// (.trm, .abs): floats alone, the first is the version of the layout. AvaSoft 8 (.rfl8, .trm8,
// .raw8): "AVS82" or "AVS84", the number of spectra, and the spectra one after the other.
// Layouts: lr_parse_avantes_trm and lr_parse_avasoft8 of the R package lightr, which has them from
// Avantes.
#include <fmt/format.h>

#include <algorithm>
#include <bit>
#include <cstdint>

#include "materials/readers/text.h"
#include "materials/readers/text_table.h"
#include "pipeline/measured/reader.h"

namespace miebrdf::measured {
namespace {

static_assert(std::endian::native == std::endian::little, "the files are little-endian");

double real_at(std::string_view bytes, std::size_t index) {
    return double(number_in<float>(bytes, sizeof(float) * index));
}

/// AvaSoft 6 and 7, in floats: five coefficients of the wavelengths, the first pixel and the last,
/// the counts, three more numbers.
struct OldLayout {
    std::size_t coefficients, pixels, counts, channels, in_pixel;
};

/// The layout of a file of this size; in_pixel 0: none.
OldLayout old_layout(std::string_view bytes) {
    if (bytes.size() % sizeof(float) != 0 || bytes.empty()) return {};
    const double version = real_at(bytes, 0);
    OldLayout layout = version == 60.0   ? OldLayout{1, 15, 19, 0, 0}
                       : version == 70.0 ? OldLayout{74, 79, 100, 0, 0}
                                         : OldLayout{};
    if (layout.counts == 0 || bytes.size() < sizeof(float) * layout.counts) return {};
    const double first = real_at(bytes, layout.pixels), last = real_at(bytes, layout.pixels + 1);
    if (!(first >= 0.0 && last > first && last < 1e6)) return {};
    layout.channels = std::size_t(last - first) + 1;
    const std::size_t numbers = bytes.size() / sizeof(float) - layout.counts;
    for (const std::size_t in_pixel : {1U, 3U}) {
        if (numbers == in_pixel * layout.channels + 3) layout.in_pixel = in_pixel;
    }
    return layout;
}

bool is_new(std::string_view bytes) {
    return bytes.starts_with("AVS8") && bytes.find('\0') != std::string_view::npos &&
           bytes.size() > 6;
}

bool looks_like_avantes(const MeasuredFile& file) {
    return is_new(file.content) || old_layout(file.content).in_pixel > 0;
}

double share(double sample, double reference, double dark) {
    const double white = reference - dark;
    const double ratio = (sample - dark) / white;
    return is_fill(ratio) ? MeasuredValue::kNone : ratio;  // a reference as dark as the dark, too
}

[[noreturn]] void refuse_counts(const MeasuredFile& file, const std::string& what) {
    refuse(file, 0,
           what +
               ": no reflectance can be made of it. Save the spectrum in AvaSoft's reflectance "
               "or transmittance mode, after those of the dark and of the white reference");
}

Measurements read_old(const MeasuredFile& file) {
    const std::string_view bytes = file.content;
    const OldLayout at = old_layout(bytes);
    if (at.in_pixel == 1) refuse_counts(file, "holds the counts of one spectrum");
    std::vector<double> nm, values;
    for (std::size_t i = 0; i < at.channels; ++i) {
        const double pixel = real_at(bytes, at.pixels) + double(i);
        double wavelength = 0.0;
        for (std::size_t c = 5; c-- > 0;)
            wavelength = wavelength * pixel + real_at(bytes, at.coefficients + c);
        if (!(wavelength > 0.0)) refuse(file, 0, fmt::format("a wavelength of {} nm", wavelength));
        nm.push_back(wavelength);
        const std::size_t counts = at.counts + 3 * i;
        values.push_back(
            share(real_at(bytes, counts), real_at(bytes, counts + 1), real_at(bytes, counts + 2)));
    }
    Measurements list;
    list.facts.emplace_back("data",
                            "sample over reference, both less the dark counts; AvaSoft 7 names "
                            "reflectance transmittance, too: --quantity reflectance");
    add_spectrum(list, "spectrum", {MeasuredQuantity::transmittance, MeasuredGeometry::unknown},
                 MeasuredValue::kNone, nm, values);
    return list;
}

/// Places in one spectrum of AvaSoft 8, in bytes.
constexpr std::size_t kMode = 5, kSerial = 8, kFirstPixel = 83, kLastPixel = 85, kComment = 192,
                      kWavelengths = 322;

Measurements read_new(const MeasuredFile& file, const MeasuredOptions& options) {
    static constexpr const char* kModes[] = {
        "counts",     "counts less the dark", "absorbance",     "transmittance",
        "irradiance", "reflectance",          "relative light", "temperature"};
    const std::string_view version = file.content.substr(0, 5);
    if (version != "AVS82" && version != "AVS84")
        refuse(
            file, 0,
            fmt::format("AvaSoft layout '{}'; read are AVS82 and AVS84. Export text from AvaSoft",
                        version));
    Measurements list;
    std::string_view rest = file.content.substr(6);
    const int spectra = static_cast<unsigned char>(file.content[5]);
    for (int s = 0; s < spectra; ++s) {
        const std::size_t channels = rest.size() < kWavelengths
                                         ? 0
                                         : std::size_t(number_in<std::uint16_t>(rest, kLastPixel)) +
                                               1 - number_in<std::uint16_t>(rest, kFirstPixel);
        // Wavelengths, sample, dark, reference; AVS84 adds settings and a white standard.
        const std::size_t part = sizeof(float) * channels,
                          size = kWavelengths + 4 * part + (version == "AVS84" ? 3779 : 0);
        if (channels == 0 || part > rest.size() || rest.size() < size ||
            number_in<std::uint32_t>(rest, 0) != size)
            refuse(file, 0,
                   fmt::format("spectrum {} of {}: the file ends early or is damaged", s + 1,
                               spectra));
        const auto mode = static_cast<unsigned char>(rest[kMode]);
        if (mode > 7 || (mode != 2 && mode != 3 && mode != 5 && options.quantity.empty()))
            refuse_counts(file, fmt::format("spectrum {} holds {}", s + 1,
                                            mode > 7 ? "an unknown quantity" : kModes[mode]));
        std::vector<double> nm, values;
        const auto at = [&](std::size_t array, std::size_t i) {
            return double(number_in<float>(rest, kWavelengths + array * part + sizeof(float) * i));
        };
        for (std::size_t i = 0; i < channels; ++i) {
            nm.push_back(at(0, i));
            if (!(nm.back() > 0.0))
                refuse(file, 0, fmt::format("a wavelength of {} nm", nm.back()));
            values.push_back(share(at(1, i), at(3, i), at(2, i)));
        }
        const auto text = [&](std::size_t place, std::size_t length) {
            const std::string_view words = rest.substr(place, length);
            return materials::as_utf8(materials::without_blanks(words.substr(0, words.find('\0'))));
        };
        const std::string comment = text(kComment, kWavelengths - kComment);
        const std::string name = comment.empty() ? text(kSerial, 10) : comment;
        list.facts.emplace_back(name.empty() ? "data" : "data of " + name, kModes[mode]);
        const auto quantity =
            mode == 5 ? MeasuredQuantity::reflectance : MeasuredQuantity::transmittance;
        add_spectrum(list, name.empty() ? "spectrum" : name, {quantity, MeasuredGeometry::unknown},
                     MeasuredValue::kNone, nm, values);
        rest.remove_prefix(std::min(size + 10, rest.size()));  // 10: the group of merged spectra
    }
    return list;
}

Measurements read_avantes(const MeasuredFile& file, const MeasuredOptions& options) {
    if (is_new(file.content)) return read_new(file, options);
    if (old_layout(file.content).in_pixel == 0) refuse(file, 0, "no binary file of AvaSoft");
    return read_old(file);
}

}  // namespace

extern const Reader kAvantes;
constinit const Reader kAvantes{
    {"avantes", "AvaSoft of Avantes (.trm, .rfl8)"}, looks_like_avantes, read_avantes};

}  // namespace miebrdf::measured
