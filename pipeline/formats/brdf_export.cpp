#include "pipeline/formats/brdf_export.h"

#include <fmt/format.h>

#include <nlohmann/json.hpp>

#include <miebrdf/error.h>
#include "pipeline/formats/exr_writer.h"
#include "pipeline/formats/metadata.h"
#include "pipeline/formats/sampled_export.h"
#include "pipeline/formats/table_writer.h"
#include "pipeline/io/atomic_file.h"

namespace miebrdf::exports {
namespace {

namespace fs = std::filesystem;

TableGrid grid_of(const ExportOptions& options) {
    TableGrid grid = options.grid;
    const int fineness = options.resolution > 0 ? options.resolution : 16;
    if (grid.mu_in.empty()) grid.mu_in = sine_squared_cosines(fineness);
    if (grid.mu_out.empty()) grid.mu_out = sine_squared_cosines(fineness);
    if (grid.azimuth_deg.empty()) grid.azimuth_deg = equally_spaced(0.0, 180.0, fineness + 3);
    return grid;
}

ExportedFile export_table(const ExportJob& job, const fs::path& path) {
    const TableGrid grid = grid_of(job.options);
    if (job.options.format == "npz") {
        write_table_npz(job.spectral, grid, path, job.control);
    } else {
        AtomicFile file(path);
        if (job.options.format == "csv")
            write_table_csv(job.spectral, grid, file.stream(), job.control);
        if (job.options.format == "json")
            write_table_json(job.spectral, grid, file.stream(), job.control);
        if (job.options.format == "exr") {
            write_exr(job.spectral, job.rgb.weights(), grid, file.stream(), job.control);
        }
        file.commit();
    }
    std::error_code no_size;  // pipes and devices have none
    const std::uintmax_t bytes = fs::file_size(path, no_size);
    return {path, no_size ? 0 : bytes, {}};
}

}  // namespace

const std::vector<std::string>& export_formats() {
    static const std::vector<std::string> names = {
        "csv", "json", "npz", "exr", "pbrt", "rgl", "merl", "ssdd", "astm", "radiance", "klems"};
    return names;
}

std::vector<ExportedFile> export_brdf(const BrdfSource& source, const ExportOptions& options,
                                      const fs::path& path, const RunControl& control) {
    RgbWeights weights = options.rgb;
    if (weights.weight.empty()) weights = nearest_wavelengths(source.wavelength_nm());
    const RgbSource rgb(source, weights);
    const ExportJob job{source, rgb, options, control};
    std::vector<ExportedFile> files;
    for (const char* table : {"csv", "json", "npz", "exr"}) {
        if (options.format == table) files.push_back(export_table(job, path));
    }
    for (auto& file : export_sampled(job, path)) files.push_back(std::move(file));
    if (files.empty()) {
        throw UsageError(fmt::format("unknown format '{}'; allowed: {}", options.format,
                                     fmt::join(export_formats(), ", ")));
    }
    if (options.format == "merl") {  // the one format without room for a word
        auto description = metadata(rgb, {.format = "merl",
                                          .cosine_included = false,
                                          .azimuth_zero = "difference angle, Rusinkiewicz",
                                          .colour = weights.description});
        description["wavelength_nm"] = source.wavelength_nm();
        write_sidecar(path, description);
    }
    return files;
}

}  // namespace miebrdf::exports
