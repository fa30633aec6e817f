#include "pipeline/formats/sampled_export.h"

#include <fmt/format.h>

#include <algorithm>
#include <memory>
#include <sstream>

#include <miebrdf/error.h>
#include "pipeline/formats/astm_writer.h"
#include "pipeline/formats/klems_writer.h"
#include "pipeline/formats/pbrt_writer.h"
#include "pipeline/formats/rgl_writer.h"
#include "pipeline/formats/ssdd_writer.h"
#include "pipeline/formats/tensor_tree_writer.h"
#include "pipeline/io/atomic_file.h"

namespace miebrdf::exports {
namespace {

namespace fs = std::filesystem;

constexpr std::size_t kComparedDirections = 1500;

/// A format whose values a reader interpolates, so that its fineness matters.
struct SampledFormat {
    const char* name;
    const char* variant;  ///< appended to the stem of the file's name
    bool spectral;
    int resolution;        ///< by default
    int finest;            ///< the largest resolution worth proposing
    double largest_error;  ///< by default
    void (*write)(const ExportJob& job, int resolution, std::ostream& out);
};

// Errors by default: what the format is known to reach with some room, docs/formats.
constexpr SampledFormat kSampled[] = {
    {"pbrt", "", false, 56, 112, 0.02,
     [](const ExportJob& job, int n, std::ostream& out) {
         write_pbrt(job.rgb, {.intervals = n}, out, job.control);
     }},
    {"rgl", "_spec", true, 64, 256, 0.05,
     [](const ExportJob& job, int n, std::ostream& out) {
         write_rgl_spectral(job.spectral, {n, job.options.incident_angles}, out, job.control);
     }},
    {"rgl", "_rgb", false, 64, 256, 0.05,
     [](const ExportJob& job, int n, std::ostream& out) {
         write_rgl_rgb(job.rgb, {n, job.options.incident_angles}, out, job.control);
     }},
    {"merl", "", false, 90, 90, 0.05,
     [](const ExportJob& job, int, std::ostream& out) {
         write_merl(job.rgb, {job.options.merl_sample}, out, job.control);
     }},
    {"ssdd", "", true, 18, 90, 0.05,
     [](const ExportJob& job, int n, std::ostream& out) {
         write_ssdd(job.spectral, n, out, job.control);
     }},
    {"astm", "", true, 9, 90, 0.1,
     [](const ExportJob& job, int n, std::ostream& out) {
         write_astm(job.spectral, n, out, job.control);
     }},
    {"radiance", "", false, 5, 7, 0.2,
     [](const ExportJob& job, int n, std::ostream& out) {
         write_radiance_tree(job.rgb, n, out, job.control);
     }},
    {"klems", "", false, 145, 145, 0.2,
     [](const ExportJob& job, int, std::ostream& out) {
         write_radiance_klems(job.rgb, out, job.control);
     }},
};

Deviation compare(const BrdfFile& file, const ExportJob& job, bool spectral) {
    const BrdfSource& truth = spectral ? job.spectral : static_cast<const BrdfSource&>(job.rgb);
    return measure_deviation(file, truth, random_directions(kComparedDirections, 99));
}

std::string bands(const Deviation& deviation) {
    return fmt::format("{:.2g} at mu > 0.2, {:.2g} at 0.05-0.2, {:.2g} below, {:.2g} near mirror",
                       deviation.rms[0], deviation.rms[1], deviation.rms[2], deviation.lobe);
}

/// What a bound is for: grazing directions have none, there every format loses digits.
double judged(const Deviation& deviation) { return std::max(deviation.rms[0], deviation.lobe); }

/// Tries finer and finer files, in memory, for a resolution that would do.
std::string advice(const SampledFormat& format, const ExportJob& job, int resolution,
                   double bound) {
    if (resolution >= format.finest)
        return "the format has no finer one; a table (npz, exr, csv) can hold it";
    double reached = 0.0;
    int finer = resolution;
    while (finer < format.finest) {
        finer = std::min(2 * finer, format.finest);
        std::ostringstream out;
        format.write(job, finer, out);
        reached = judged(
            compare(*read_brdf_file(std::move(out).str(), format.name), job, format.spectral));
        if (reached <= bound) return fmt::format("--resolution {} reaches {:.2g}", finer, reached);
    }
    return fmt::format(
        "--resolution {} reaches no less than {:.2g}; a table (npz, exr, csv) can hold it", finer,
        reached);
}

[[noreturn]] void refuse(const SampledFormat& format, const ExportJob& job, int resolution,
                         double bound, const Deviation& found) {
    throw TooCoarse(fmt::format(
        "format '{}' at resolution {} misses this BRDF by {} (rms, relative; allowed: {:.2g} at "
        "mu > 0.2 and near mirror); {}; --max-error accepts it as it is",
        format.name, resolution, bands(found), bound, advice(format, job, resolution, bound)));
}

fs::path with_variant(const fs::path& path, const char* variant) {
    if (*variant == '\0') return path;
    fs::path result = path;
    result.replace_filename(path.stem().string() + variant + path.extension().string());
    return result;
}

/// A file that has passed, and waits for those that belong to it.
struct PassedFile {
    ExportedFile written;
    std::unique_ptr<AtomicFile> file;
};

PassedFile write_and_compare(const SampledFormat& format, const ExportJob& job,
                             const fs::path& path) {
    const int resolution = job.options.resolution > 0 ? job.options.resolution : format.resolution;
    const double bound =
        job.options.largest_error > 0 ? job.options.largest_error : format.largest_error;
    ExportedFile written{with_variant(path, format.variant), 0, {}};
    auto file = std::make_unique<AtomicFile>(written.path);
    if (!fs::is_regular_file(file->temporary_path())) {
        throw UsageError(
            fmt::format("'{}' is no regular file, and format '{}' is read back after writing; "
                        "pipes and devices "
                        "take csv, json and npz",
                        written.path.string(), format.name));
    }
    format.write(job, resolution, file->stream());
    file->stream().flush();
    written.bytes = fs::file_size(file->temporary_path());
    written.deviation =
        compare(*open_brdf_file(file->temporary_path().string()), job, format.spectral);
    if (!(judged(*written.deviation) <= bound))
        refuse(format, job, resolution, bound, *written.deviation);
    return {std::move(written), std::move(file)};
}

}  // namespace

double accepted_error(const std::string& format) {
    constexpr double kTables = 0.05;
    for (const SampledFormat& known : kSampled) {
        if (format == known.name) return known.largest_error;
    }
    return kTables;
}

std::vector<ExportedFile> export_sampled(const ExportJob& job, const fs::path& path) {
    std::vector<PassedFile> passed;
    for (const SampledFormat& format : kSampled) {
        if (job.options.format == format.name)
            passed.push_back(write_and_compare(format, job, path));
    }
    // Not before all of them are there: half of a pair is of no use.
    std::vector<ExportedFile> files;
    for (PassedFile& one : passed) {
        one.file->commit();
        files.push_back(std::move(one.written));
    }
    return files;
}

}  // namespace miebrdf::exports
