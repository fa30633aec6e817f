// Writes formats, reads back those that their readers interpolate, and refuses what came out too
// coarse.
#include <fmt/format.h>

#include <algorithm>
#include <functional>
#include <sstream>

#include "pipeline/formats/check/check.h"
#include "pipeline/formats/common/export_job.h"
#include "pipeline/io/atomic_file.h"

namespace miebrdf {
namespace {

namespace fs = std::filesystem;

constexpr std::size_t kComparedDirections = 1500;

/// "csv, json, npz, exr": formats that hold any BRDF as it is.
std::string names_of_tables() {
    std::vector<std::string> names;
    for (const Format& format : all_formats()) {
        if (format.content == FormatContent::table) names.push_back(format.name);
    }
    return fmt::format("{}", fmt::join(names, ", "));
}

void require_ascending(const Format& format, const std::vector<double>& wavelength_nm) {
    for (std::size_t i = 1; format.needs_ascending_wavelengths && i < wavelength_nm.size(); ++i) {
        if (wavelength_nm[i] > wavelength_nm[i - 1]) continue;
        throw UsageError(fmt::format("format '{}' needs ascending wavelengths; {} nm follows {} nm",
                                     format.name, wavelength_nm[i], wavelength_nm[i - 1]));
    }
}

/// A file that appears whole or not at all; formats that seek go to pipes through memory.
void write_whole(const Format& format, const fs::path& path,
                 const std::function<void(std::ostream&)>& write) {
    AtomicFile file(path);
    try {
        if (!format.seeks || fs::is_regular_file(file.temporary_path())) {
            write(file.stream());
        } else {
            std::stringstream memory;
            write(memory);
            file.stream() << memory.rdbuf();
        }
    } catch (const InputError& error) {
        throw InputError(fmt::format("cannot write '{}': {}", path.string(), error.what()));
    }
    file.commit();
}

fs::path with_suffix(const fs::path& path, const std::string& suffix) {
    fs::path result = path;
    return suffix.empty()
               ? result
               : result.replace_filename(path.stem().string() + suffix + path.extension().string());
}

// ---- Formats whose values their readers interpolate

Deviation compare(const BrdfFile& file, const FormatFile& part, const ExportJob& job) {
    const BrdfSource& truth = part.colours ? static_cast<const BrdfSource&>(job.rgb) : job.spectral;
    return measure_deviation(file, truth, random_directions(kComparedDirections, 99));
}

/// What a bound is for: grazing directions have none, there every format loses digits.
double judged(const Deviation& deviation) { return std::max(deviation.rms[0], deviation.lobe); }

/// Tries finer and finer files, in memory, for a resolution that would do.
std::string advice(const Format& format, const FormatFile& part, const ExportJob& job,
                   double bound) {
    ExportOptions options = job.options;
    const int finest = format.resolution.finest;
    if (options.resolution >= finest) {
        return fmt::format("the format has no finer one; a table ({}) can hold it",
                           names_of_tables());
    }
    double reached = 0.0;
    while (options.resolution < finest) {
        options.resolution = std::min(2 * options.resolution, finest);
        std::ostringstream out;
        const ExportJob finer{job.spectral, job.rgb, options, job.control};
        part.write(finer, out);
        reached = judged(
            compare(*read_brdf_file(std::move(out).str(), format.name, {&format, 1}), part, job));
        if (reached <= bound)
            return fmt::format("resolution {} reaches {:.2g}", options.resolution, reached);
    }
    return fmt::format("resolution {} reaches no less than {:.2g}; a table ({}) can hold it",
                       options.resolution, reached, names_of_tables());
}

[[noreturn]] void refuse(const Format& format, const FormatFile& part, const ExportJob& job,
                         double bound, const Deviation& found) {
    throw TooCoarse(fmt::format(
        "format '{}' at resolution {} misses this BRDF by {:.2g} at mu > 0.2, {:.2g} at 0.05-0.2, "
        "{:.2g} below, {:.2g} near mirror (rms, relative; allowed: {:.2g} at mu > 0.2 "
        "and near mirror); {}",
        format.name, job.options.resolution, found.rms[0], found.rms[1], found.rms[2], found.lobe,
        bound, advice(format, part, job, bound)));
}

/// A file that has passed, and waits for those that belong to it.
struct PassedFile {
    ExportedFile written;
    std::unique_ptr<AtomicFile> file;
};

PassedFile write_and_compare(const Format& format, const FormatFile& part, const ExportJob& job,
                             const fs::path& path) {
    const double bound =
        job.options.largest_error > 0 ? job.options.largest_error : format.accepted_error;
    ExportedFile written{with_suffix(path, part.suffix), 0, {}};
    auto file = std::make_unique<AtomicFile>(written.path);
    const std::string temporary = file->temporary_path().string();
    if (!fs::is_regular_file(temporary)) {
        throw UsageError(
            fmt::format("'{}' is no regular file, and format '{}' is read back after writing; "
                        "pipes and devices take {}",
                        written.path.string(), format.name, names_of_tables()));
    }
    part.write(job, file->stream());
    file->stream().flush();
    written.bytes = fs::file_size(temporary);
    written.deviation = compare(*open_brdf_file(temporary, {&format, 1}), part, job);
    if (!(judged(*written.deviation) <= bound))
        refuse(format, part, job, bound, *written.deviation);
    return {std::move(written), std::move(file)};
}

std::vector<ExportedFile> export_sampled(const Format& format, const ExportJob& job,
                                         const fs::path& path) {
    std::vector<PassedFile> passed;
    for (const FormatFile& part : format.files)
        passed.push_back(write_and_compare(format, part, job, path));
    // Not before all of them are there: half of a pair is of no use.
    std::vector<ExportedFile> files;
    for (PassedFile& one : passed) {
        one.file->commit();
        files.push_back(std::move(one.written));
    }
    return files;
}

std::vector<ExportedFile> export_tables(const Format& format, const ExportJob& job,
                                        const fs::path& path) {
    std::vector<ExportedFile> files;
    for (const FormatFile& part : format.files) {
        const fs::path target = with_suffix(path, part.suffix);
        write_whole(format, target, [&](std::ostream& out) { part.write(job, out); });
        std::error_code no_size;  // pipes and devices have none
        const std::uintmax_t bytes = fs::file_size(target, no_size);
        files.push_back({target, no_size ? 0 : bytes, {}});
    }
    return files;
}

[[noreturn]] void refuse_content(const Format& format, const char* wanted) {
    throw UsageError(fmt::format("format '{}' does not hold {}", format.name, wanted));
}

}  // namespace

std::vector<ExportedFile> export_brdf(const BrdfSource& source, const Format& format,
                                      const fs::path& path, const ExportOptions& options,
                                      const Control& control) {
    if (format.files.empty()) refuse_content(format, "a BRDF");
    const ExportOptions ready = ready_options(format, options);
    require_ascending(format, source.wavelength_nm());
    const RgbSource rgb(source, colours_of(format, ready, source));
    const ExportJob job{source, rgb, ready, control};
    std::vector<ExportedFile> files = format.content == FormatContent::sampled
                                          ? export_sampled(format, job, path)
                                          : export_tables(format, job, path);
    if (format.sidecar != nullptr) {
        AtomicFile sidecar(path.string() + ".json");
        sidecar.stream() << format.sidecar(job);
        sidecar.commit();
    }
    return files;
}

std::vector<ExportedFile> export_brdf(const BrdfSource& source, const std::string& format,
                                      const fs::path& path, const ExportOptions& options,
                                      const Control& control) {
    return export_brdf(source, find_format(format), path, options, control);
}

void export_spectrum(const ReflectanceSpectrum& spectrum, const std::string& format,
                     const fs::path& path) {
    const Format& known = find_format(format);
    if (known.write_spectrum == nullptr) refuse_content(known, "a spectrum");
    if (spectrum.wavelength_nm.empty())
        throw UsageError("a spectrum needs at least one wavelength");
    require_ascending(known, spectrum.wavelength_nm);
    write_whole(known, path, [&](std::ostream& out) { known.write_spectrum(spectrum, out); });
}

void export_scattering(const ScatteringTable& table, const std::string& format,
                       const fs::path& path) {
    const Format& known = find_format(format);
    if (known.write_scattering == nullptr) refuse_content(known, "single scattering");
    write_whole(known, path, [&](std::ostream& out) { known.write_scattering(table, out); });
}

}  // namespace miebrdf
