// The list of readers, and how a file finds its own.
#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>

#include "materials/readers/text_table.h"
#include "pipeline/measured/reader.h"

namespace miebrdf::measured {

extern const Reader kAsd, kSvc, kOcean, kEnvi, kCxf, kOpenMaterial, kCgats, kJcamp, kRxt,
    kEcostress, kSplib, kCsv;

std::span<const Reader* const> readers() {
    static constexpr const Reader* kReaders[] = {&kAsd, &kSvc,          &kOcean, &kEnvi,
                                                 &kCxf, &kOpenMaterial, &kCgats, &kJcamp,
                                                 &kRxt, &kEcostress,    &kSplib, &kCsv};
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
    const std::string bytes = materials::without_mark(materials::read_bytes(path), path.string());
    const MeasuredFile file{path.string(), bytes};
    if (bytes.empty()) refuse(file, 0, "is empty");
    const auto knows = [&](const Reader* reader) { return reader->looks_like(file); };
    if (chosen == nullptr) {
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
