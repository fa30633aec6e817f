// BRDF files: whatever `miebrdf export` writes and `miebrdf check` reads.
#include <fmt/format.h>

#include <algorithm>

#include <miebrdf/formats.h>
#include "materials/readers/text_table.h"
#include "pipeline/measured/reader.h"

namespace miebrdf::measured {
namespace {

/// Directions at which files are read that have no list of their own.
const ListedDirections& usual_directions() {
    static const ListedDirections kDirections{{0.1, 0.3, 0.5, 0.7, 0.9, 1.0},
                                              {0.1, 0.2, 0.3, 0.4, 0.5, 0.6, 0.7, 0.8, 0.9, 1.0},
                                              {0.0, 30.0, 60.0, 90.0, 120.0, 150.0, 180.0},
                                              true};
    return kDirections;
}

/// Tables as CSV have a reader of their own here, which reads more than grids.
bool looks_like_brdf_file(const MeasuredFile& file) {
    return std::any_of(all_formats().begin(), all_formats().end(), [&](const Format& format) {
        return format.name != "csv" && format.reader.recognise != nullptr &&
               format.reader.recognise(file.content) != Recognised::no;
    });
}

Measurements read_brdf(const MeasuredFile& file, const MeasuredOptions&) {
    const auto brdf = read_brdf_file(std::string(file.content), file.path);
    if (brdf->wavelength_nm().empty()) {
        refuse(file, 0,
               fmt::format("{} holds colours, not wavelengths: nothing that a spectrum could be "
                           "compared with",
                           brdf->format()));
    }
    const auto listed = brdf->listed();
    const ListedDirections& directions = listed ? *listed : usual_directions();
    const std::size_t channels = brdf->channels().size();
    const std::size_t count = directions.mu_in.size() * directions.mu_out.size() *
                              directions.azimuth_deg.size() * channels;
    materials::ReadingBudget::require_values(count, file.path);
    Measurements list;
    list.samples = {brdf->format()};
    list.facts.emplace_back(
        "directions", listed ? "those of the table" : "of a grid, interpolated as renderers do");
    std::vector<double> values(channels);
    for (const double mu_in : directions.mu_in) {
        for (const double mu_out : directions.mu_out) {
            for (const double azimuth : directions.azimuth_deg) {
                brdf->evaluate({mu_in, mu_out, azimuth}, values);
                for (std::size_t c = 0; c < channels; ++c) {
                    if (std::isnan(values[c])) continue;
                    MeasuredValue value;
                    value.quantity = MeasuredQuantity::brdf;
                    value.geometry = MeasuredGeometry::directions;
                    value.wavelength_nm = brdf->wavelength_nm()[c];
                    value.mu_in = mu_in;
                    value.mu_out = mu_out;
                    value.azimuth_deg = azimuth;
                    value.value = values[c];
                    list.values.push_back(value);
                }
            }
        }
    }
    return list;
}

}  // namespace

extern const Reader kBrdfFile;
constinit const Reader kBrdfFile{
    {"brdf", "BRDF files that are exported"}, looks_like_brdf_file, read_brdf};

}  // namespace miebrdf::measured
