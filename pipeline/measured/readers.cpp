// The list of readers, and how a file finds its own.
#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>

#include "materials/readers/text.h"
#include "materials/readers/text_table.h"
#include "pipeline/measured/reader.h"

namespace miebrdf::measured {

extern const Reader kAsd, kAvantes, kSvc, kOcean, kEnvi, kCxf, kOpenMaterial, kCgats, kJcamp, kRxt,
    kEcostress, kSplib, kCsv;

namespace {

/// Binary files of spectrometers that are not read: how they begin or end, and their program.
struct UnreadFormat {
    std::string_view begin, endings, program;
};
constexpr UnreadFormat kUnread[] = {
    {"", ".trm .roh .drk .ref .abs .irr", "AvaSoft (Avantes)"},
    {"PK\3\4", ".procspec", "SpectraSuite or OceanView (Ocean Optics)"},
    {"\n\n\xfe\xfe", "", "OPUS (Bruker)"},
    {"PEPE", "", "Spectrum or UV WinLab (PerkinElmer)"},
    {"Spectral Data File", "", "OMNIC (Thermo)"},
    {"", ".jws", "Spectra Manager (JASCO)"},
    {"", ".bsw .csw .dsw", "Cary WinUV (Agilent, Varian)"},
    {"", ".spc", "GRAMS or a program that writes its format (SPC)"},
};

void refuse_unread(const MeasuredFile& file) {
    const std::string ending =
        materials::lower_case(std::filesystem::path(file.path).extension().string());
    const bool is_binary = file.content.find('\0') != std::string_view::npos;
    for (const UnreadFormat& format : kUnread) {
        const bool ends = !ending.empty() && format.endings.find(ending) != std::string_view::npos;
        if (!file.content.starts_with(format.begin) ||
            (!format.endings.empty() && !(ends && is_binary)))
            continue;
        refuse(file, 0,
               fmt::format("a binary file of {}, which is not read: export it as text (ASCII, CSV) "
                           "or JCAMP-DX in that program",
                           format.program));
    }
}

/// Some programs fill lines of texts up with NUL, which binary files have elsewhere.
void blank_padding(std::string& bytes) {
    for (std::size_t i = 0; i < bytes.size(); ++i) {
        const char next = i + 1 < bytes.size() ? bytes[i + 1] : '0';
        const bool is_padding = bytes[i] == '\0' && (next == '\0' || next == '\r' || next == '\n');
        const bool is_text = static_cast<unsigned char>(bytes[i]) >= 0x20 || bytes[i] == '\t' ||
                             bytes[i] == '\r' || bytes[i] == '\n';
        if (!is_padding && !is_text) return;
    }
    std::replace(bytes.begin(), bytes.end(), '\0', ' ');
}

}  // namespace

std::span<const Reader* const> readers() {
    static constexpr const Reader* kReaders[] = {
        &kAsd,   &kAvantes, &kSvc, &kOcean,     &kEnvi,  &kCxf, &kOpenMaterial,
        &kCgats, &kJcamp,   &kRxt, &kEcostress, &kSplib, &kCsv};
    return kReaders;
}

Measurements read_with(std::span<const Reader* const> readers, const std::filesystem::path& path,
                       const MeasuredOptions& options) {
    const Reader* chosen = nullptr;
    std::vector<std::string> names, titles;
    for (const Reader* reader : readers) {
        names.emplace_back(reader->format.name);
        titles.emplace_back(reader->format.title);
        if (options.format == reader->format.name) chosen = reader;
    }
    if (!options.format.empty() && chosen == nullptr)
        throw UsageError("format", options.format, fmt::format("{}", fmt::join(names, ", ")));
    std::string bytes = materials::without_mark(materials::read_bytes(path), path.string());
    blank_padding(bytes);
    const MeasuredFile file{path.string(), bytes};
    if (bytes.empty()) refuse(file, 0, "is empty");
    const auto knows = [&](const Reader* reader) { return reader->looks_like(file); };
    if (chosen == nullptr) {
        if (!knows(&kAvantes)) refuse_unread(file);  // of its endings some are read
        const auto found = std::find_if(readers.begin(), readers.end(), knows);
        if (found == readers.end()) {
            refuse(file, 0,
                   fmt::format("no measurements recognised; known are {}. A table needs "
                               "a line of names, such as wavelength_nm,reflectance",
                               fmt::join(titles, ", ")));
        }
        chosen = *found;
    }
    Measurements list = chosen->read(file, options);
    list.file = path.string();
    list.format = chosen->format.name;
    complete(list, options);
    return list;
}

}  // namespace miebrdf::measured
