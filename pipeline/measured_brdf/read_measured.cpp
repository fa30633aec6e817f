// All formats of measurements: those of pipeline/measured, and exported BRDF files.
#include "pipeline/measured/reader.h"

namespace miebrdf {
namespace measured {

extern const Reader kBrdfFile;

namespace {

/// Tables are asked last: they take every text with a line of names.
std::vector<const Reader*> all_readers() {
    std::vector<const Reader*> all(readers().begin(), readers().end());
    all.insert(all.end() - 1, &kBrdfFile);
    return all;
}

}  // namespace
}  // namespace measured

std::vector<MeasuredFormat> measured_formats() {
    std::vector<MeasuredFormat> formats;
    for (const measured::Reader* reader : measured::all_readers())
        formats.push_back(reader->format);
    return formats;
}

Measurements read_measured(const std::filesystem::path& path, const MeasuredOptions& options) {
    try {
        return measured::read_with(measured::all_readers(), path, options);
    } catch (const materials::ImportError& error) {
        throw InputError(error.what());  // nothing is imported here
    }
}

}  // namespace miebrdf
