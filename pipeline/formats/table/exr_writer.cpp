// exr: spectral OpenEXR (Fichet, Pacanowski & Wilkie 2021, JCGT 10(3)). docs/formats/exr.md
#include <fmt/format.h>

#include <algorithm>
#include <nlohmann/json.hpp>
#include <numbers>

#include "pipeline/formats/table/tabulate.h"
#include "pipeline/io/exr_file.h"

namespace miebrdf {

FormatReader exr_reader();  // exr_reader.cpp

namespace {

std::vector<float> floats(const std::vector<double>& numbers) {
    return {numbers.begin(), numbers.end()};
}

/// The paper's name of a reflectance channel: a decimal comma, since a point separates layers.
std::string channel_name(double wavelength_nm) {
    std::string number = fmt::format("{:.6f}", wavelength_nm);
    std::replace(number.begin(), number.end(), '.', ',');
    return "T." + number + "nm";
}

/// Ours: a plane for each element of the Mueller matrix but the first.
std::string mueller_channel_name(const std::string& element, double wavelength_nm) {
    return "M" + element.substr(1) + channel_name(wavelength_nm).substr(1);
}

/// Channels of each wavelength besides T.
std::vector<std::string> mueller_elements(const BrdfSource& source) {
    std::vector<std::string> names = mueller_names(source.components());
    names.erase(names.begin());
    return names;
}

/// Enough rows of pixels to keep all threads busy, few enough to take little memory.
std::size_t incidences_at_a_time(const rte::Directions& grid) {
    constexpr std::size_t kPixels = 1 << 14;
    return std::max<std::size_t>(1, kPixels / (grid.mu_out.size() * grid.azimuth_deg.size()));
}

/// One plane of pixels for each wavelength, for R, G and B, and for each wavelength those of
/// mueller_elements.
std::vector<float> planes_of(const BrdfSource& source, const RgbWeights& preview,
                             const rte::Directions& part, const Control& control) {
    const std::vector<double> table = tabulate(source, part, control);
    const std::size_t wavelengths = source.wavelength_nm().size(), pixels = size_of(part);
    std::vector<float> planes((wavelengths + 3) * pixels, 0.0f);
    for (std::size_t i = 0; i < table.size(); ++i)
        planes[i] = static_cast<float>(std::numbers::pi * table[i]);
    for (std::size_t c = 0; c < 3; ++c) {
        float* plane = &planes[(wavelengths + c) * pixels];
        for (std::size_t p = 0; p < pixels; ++p) {
            double sum = 0.0;
            for (std::size_t w = 0; w < wavelengths; ++w)
                sum += preview.weight[w][c] * table[w * pixels + p];
            plane[p] = static_cast<float>(std::numbers::pi * sum);
        }
    }
    const std::vector<double> matrices = tabulate_mueller(source, part, control);
    const auto elements = static_cast<std::size_t>(source.components() * source.components());
    for (std::size_t w = 0; w < wavelengths; ++w) {
        for (std::size_t e = 1; e < elements; ++e) {
            for (std::size_t p = 0; p < pixels; ++p) {
                planes.push_back(static_cast<float>(std::numbers::pi *
                                                    matrices[(w * pixels + p) * elements + e]));
            }
        }
    }
    return planes;
}

/// Every channel, in the order of planes_of.
std::vector<std::string> channel_names(const BrdfSource& source) {
    std::vector<std::string> names;
    for (const double wavelength : source.wavelength_nm())
        names.push_back(channel_name(wavelength));
    for (const char* colour : {"R", "G", "B"}) names.emplace_back(colour);
    for (const double wavelength : source.wavelength_nm()) {
        for (const std::string& element : mueller_elements(source))
            names.push_back(mueller_channel_name(element, wavelength));
    }
    return names;
}

/// One 32-bit float channel T.<wavelength>nm for each wavelength, and R, G, B to look at. All of
/// them hold the reflectance factor, pi times the BRDF, since channels T are reflectances: a white
/// Lambertian surface is 1. The attribute `brdf_factor` says so. Column = azimuth, row = mu_in *
/// number of mu_out + mu_out; the three lists are in float-vector attributes of their names.
void write_exr(const ExportJob& job, std::ostream& out) {
    const BrdfSource& source = job.spectral;
    const RgbWeights& preview = job.rgb.weights();
    const rte::Directions grid = table_directions(job.options);
    const int width = static_cast<int>(grid.azimuth_deg.size());
    const int height = static_cast<int>(grid.mu_in.size() * grid.mu_out.size());
    ExrHeader header{.width = width, .height = height, .channels = channel_names(source)};
    header.lists = {{"mu_in", floats(grid.mu_in)},
                    {"mu_out", floats(grid.mu_out)},
                    {"azimuth_deg", floats(grid.azimuth_deg)}};
    header.numbers = {{"brdf_factor", std::numbers::pi}};
    auto description = metadata(source, {.format = "exr",
                                         .cosine_included = false,
                                         .azimuth_zero = "mirror side",
                                         .colour = "R, G, B: " + preview.description});
    description["quantity"] = "reflectance factor, pi times the BRDF, in all channels";
    description["units"] = "1 (pi times 1/sr)";
    header.texts = {{"spectralLayoutVersion", "1.0"}, {"miebrdf", description.dump()}};

    ExrWriter file(out, header);
    const std::size_t block = incidences_at_a_time(grid);
    for (std::size_t first = 0; first < grid.mu_in.size(); first += block) {
        rte::Directions part = grid;
        part.mu_in.assign(grid.mu_in.begin() + static_cast<std::ptrdiff_t>(first),
                          grid.mu_in.begin() + static_cast<std::ptrdiff_t>(
                                                   std::min(first + block, grid.mu_in.size())));
        const std::vector<float> values = planes_of(source, preview, part, job.control);
        const std::size_t pixels = size_of(part);
        std::vector<ExrPlane<const float>> planes;
        for (const std::string& channel : header.channels)
            planes.push_back({channel, &values[planes.size() * pixels], 1, std::size_t(width)});
        file.write_lines(static_cast<int>(part.mu_in.size() * part.mu_out.size()), planes);
    }
    file.finish();
}

}  // namespace

Format exr_format() {
    Format format =
        table_format("exr", "image tools, spectral-exr", ".exr", write_exr, exr_reader());
    format.holds = "every wavelength, any directions, 32-bit floats";
    format.takes_colours = true;
    format.seeks = true;
    return format;
}

}  // namespace miebrdf
