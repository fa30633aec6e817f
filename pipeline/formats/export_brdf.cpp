// Writes formats, reads back those that their readers interpolate, and refuses what came out too
// coarse.
#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <functional>
#include <sstream>

#include "pipeline/formats/check/check.h"
#include "pipeline/formats/common/export_job.h"
#include "pipeline/formats/common/finite_source.h"
#include "pipeline/io/atomic_file.h"
#include "pipeline/solve/solved_table.h"

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

AcceptedErrors accepted_by(const Format& format, const ExportOptions& options) {
    return options.largest_error > 0 ? format.accepted.with_plain(options.largest_error)
                                     : format.accepted;
}

/// "0.052 mu > 0.2, ...".
std::string regions_of(const Deviation& deviation) {
    std::vector<std::string> texts;
    for (const RegionDeviation& region : deviation.regions)
        texts.push_back(fmt::format("{:.2g} {}", region.rms, region.name));
    return fmt::format("{}", fmt::join(texts, ", "));
}

/// The next finer resolution to try: twice as fine, or less where that is ten times the bytes
/// (levels of a tree).
int next_finer(const Format& format, const ExportJob& job, int resolution) {
    int next = std::min(2 * resolution, format.resolution.finest);
    if (format.expected_bytes == nullptr) return next;
    const auto bytes = [&](int fineness) {
        ExportOptions options = job.options;
        options.resolution = fineness;
        return format.expected_bytes(options, job.spectral.wavelength_nm().size());
    };
    constexpr std::uintmax_t kMostGrowth = 10;
    while (next > resolution + 1 && bytes(next) > kMostGrowth * bytes(resolution)) --next;
    return next;
}

/// A deviation divided by the bound of its region.
double excess_of(const RegionDeviation& region, const AcceptedErrors& accepted) {
    return region.rms / accepted.of(region.kind);
}

/// Whether errors that fall as they did between two resolutions come near their bounds at the
/// finest one: what will not help is not computed, for each step takes several times as long.
bool may_suffice(const Format& format, const ExportJob& job, int resolution, double before,
                 double now) {
    constexpr double near = 3.0;  // they may fall faster later
    double expected = now;
    for (int r = resolution; r < format.resolution.finest; r = next_finer(format, job, r))
        expected *= now / before;
    return expected <= near;
}

/// What finer files would do.
struct Finer {
    int sufficient = 0;  ///< the resolution that would do; 0: none
    std::string advice;
};

/// Tries finer and finer files, in memory, for a resolution that would do.
Finer try_finer(const Format& format, const FormatFile& part, const ExportJob& job,
                const AcceptedErrors& accepted, RegionDeviation reached) {
    ExportOptions options = job.options;
    const int finest = format.resolution.finest;
    if (options.resolution >= finest) {
        return {0, fmt::format("the format has no finer one; a table ({}) can hold it",
                               names_of_tables())};
    }
    while (options.resolution < finest) {
        options.resolution = next_finer(format, job, options.resolution);
        std::ostringstream out;
        const ExportJob finer_job{job.spectral, job.rgb, options, job.control};
        part.write(finer_job, out);
        const Deviation found =
            compare(*read_brdf_file(std::move(out).str(), format.name, {&format, 1}), part, job);
        const RegionDeviation* miss = worst_region(found, accepted);
        if (miss == nullptr) {
            return {options.resolution,
                    fmt::format("resolution {} reaches {:.2g}", options.resolution,
                                std::max(found.rms[0], found.lobe))};
        }
        const double before = excess_of(reached, accepted), now = excess_of(*miss, accepted);
        reached = *miss;
        if (!may_suffice(format, job, options.resolution, before, now)) break;
    }
    return {0, fmt::format(
                   "resolution {} reaches no less than {:.2g} at {}{}; a table ({}) can hold it",
                   options.resolution, reached.rms, reached.name,
                   options.resolution < finest ? ", and finer ones gain too little" : "",
                   names_of_tables())};
}

[[noreturn]] void refuse(const Format& format, const ExportJob& job, const AcceptedErrors& accepted,
                         const Deviation& found, const RegionDeviation& worst,
                         const std::string& advice) {
    throw TooCoarse(fmt::format(
        "format '{}' at resolution {} misses this BRDF at {}: by {:.2g} (rms), {:+.0f} % at mu_in "
        "{:.3g}, mu_out {:.3g}, azimuth {:.4g}; by region (rms): {}; allowed: {:.2g} at mu > 0.2 "
        "and near mirror, {:.2g} at retro-reflection and zenith, {:.2g} at mu < 0.2; {}",
        format.name, job.options.resolution, worst.name, worst.rms, 100.0 * worst.worst,
        worst.where.mu_in, worst.where.mu_out, worst.where.azimuth_deg, regions_of(found),
        accepted.plain, accepted.peaks, accepted.grazing, advice));
}

/// A file that has passed, and waits for those that belong to it.
struct PassedFile {
    ExportedFile written;
    std::unique_ptr<AtomicFile> file;
};

/// @param finer  where a finer resolution is put that is needed, and nothing returned; null: what
///               misses is refused
std::optional<PassedFile> write_and_compare(const Format& format, const FormatFile& part,
                                            const ExportJob& job, const ExportJob& truth,
                                            const fs::path& path, int* finer) {
    const AcceptedErrors accepted = accepted_by(format, job.options);
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
    file->flush();
    written.bytes = fs::file_size(temporary);
    written.deviation = compare(*open_brdf_file(temporary, {&format, 1}), part, truth);
    const RegionDeviation* miss = worst_region(*written.deviation, accepted);
    if (miss != nullptr && !job.options.accept_error) {
        const Finer tried = try_finer(format, part, job, accepted, *miss);
        if (finer == nullptr || tried.sufficient == 0)
            refuse(format, job, accepted, *written.deviation, *miss, tried.advice);
        *finer = tried.sufficient;
        return std::nullopt;
    }
    return PassedFile{std::move(written), std::move(file)};
}

/// @param given  what the job's sources were made of: a solved table is written from one for many
///               directions, and compared with itself
/// @param options  the job's; with `is_standard` a finer resolution takes the place of a standard
///                 that does not suffice
std::vector<ExportedFile> export_sampled(const Format& format, const ExportJob& job,
                                         const BrdfSource& given, const fs::path& path,
                                         bool is_standard, ExportOptions& options) {
    const auto* const table = dynamic_cast<const BrdfTable*>(&given);
    std::optional<BrdfTable> fast;
    if (table != nullptr) fast = for_many_directions(*table, job.control);
    const FiniteSource spectral(fast ? *fast : given);
    const RgbSource rgb(spectral, job.rgb.weights());
    const int standard = options.resolution;
    std::vector<PassedFile> passed;
    passed.reserve(format.files.size());
    while (passed.size() < format.files.size()) {
        const FormatFile& part = format.files[passed.size()];
        const ExportJob written{spectral, rgb, options, job.control};
        auto one = write_and_compare(format, part, written, job, path,
                                     is_standard ? &options.resolution : nullptr);
        if (one && options.resolution != standard) one->written.resolution = options.resolution;
        if (one)
            passed.push_back(std::move(*one));
        else
            passed.clear();
    }
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

std::vector<ExportedFile> export_brdf(const BrdfSource& given, const Format& format,
                                      const fs::path& path, const ExportOptions& options,
                                      const Control& control) {
    if (format.files.empty()) refuse_content(format, "a BRDF");
    constexpr std::array kHoldTransmitted = {"csv", "json", "npz", "exr", "rgl", "klems"};
    if (given.provenance().component == "transmitted" &&
        std::find(kHoldTransmitted.begin(), kHoldTransmitted.end(), format.name) ==
            kHoldTransmitted.end()) {
        throw UsageError(fmt::format(
            "format '{}' holds what is reflected alone; formats that take what is transmitted: {}",
            format.name, fmt::join(kHoldTransmitted, ", ")));
    }
    const FiniteSource source(given);
    ExportOptions ready = ready_options(format, options);
    require_ascending(format, source.wavelength_nm());
    const RgbSource rgb(source, colours_of(format, ready, source));
    const ExportJob job{source, rgb, ready, control};
    std::vector<ExportedFile> files =
        format.content == FormatContent::sampled
            ? export_sampled(format, job, given, path, options.resolution == 0, ready)
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
