// The list of formats, and how a file finds its reader.
#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>

#include "materials/readers/text_table.h"
#include "pipeline/measured/reader.h"

namespace miebrdf {
namespace measured {

extern const Reader kAsd, kCxf, kCgats, kJcamp, kRxt, kEcostress, kSplib, kCsv, kBrdfFile;

std::span<const Reader* const> readers() {
    static constexpr const Reader* kReaders[] = {&kAsd,       &kCxf,   &kCgats,    &kJcamp, &kRxt,
                                                 &kEcostress, &kSplib, &kBrdfFile, &kCsv};
    return kReaders;
}

}  // namespace measured

std::vector<MeasuredFormat> measured_formats() {
    std::vector<MeasuredFormat> formats;
    for (const measured::Reader* reader : measured::readers()) formats.push_back(reader->format);
    return formats;
}

namespace {

Measurements read_recognised(const std::filesystem::path& path, const MeasuredOptions& options) {
    const std::span<const measured::Reader* const> readers = measured::readers();
    const measured::Reader* chosen = nullptr;
    std::vector<std::string> names, titles;
    for (const measured::Reader* reader : readers) {
        names.emplace_back(reader->format.name);
        titles.emplace_back(reader->format.title);
        if (options.format == reader->format.name) chosen = reader;
    }
    if (!options.format.empty() && chosen == nullptr)
        throw UsageError("format", options.format, fmt::format("{}", fmt::join(names, ", ")));

    const std::string bytes = materials::without_mark(materials::read_bytes(path), path.string());
    const measured::MeasuredFile file{path.string(), bytes};
    if (bytes.empty()) measured::refuse(file, 0, "is empty");
    const auto knows = [&](const measured::Reader* reader) { return reader->looks_like(file); };
    if (chosen == nullptr) {
        const auto found = std::find_if(readers.begin(), readers.end(), knows);
        if (found == readers.end()) {
            measured::refuse(file, 0,
                             fmt::format("no measurements recognised; known are {}. A table needs "
                                         "a line of names, such as wavelength_nm,reflectance",
                                         fmt::join(titles, ", ")));
        }
        chosen = *found;
    }
    Measurements list = chosen->read(file, options);
    list.file = path.string();
    list.format = chosen->format.name;
    measured::complete(list, options);
    return list;
}

}  // namespace

Measurements read_measured(const std::filesystem::path& path, const MeasuredOptions& options) {
    try {
        return read_recognised(path, options);
    } catch (const materials::ImportError& error) {
        throw InputError(error.what());  // nothing is imported here
    }
}

}  // namespace miebrdf
