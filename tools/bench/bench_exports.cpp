// Every export format of two scenes: size, what reading back finds, CPU time and memory beyond the
// solution. Prints the tables of docs/formats/README.md.
#include <fmt/format.h>
#include <malloc.h>
#include <sys/resource.h>
#include <sys/wait.h>
#include <unistd.h>

#include <cstdio>
#include <filesystem>
#include <fstream>

#include <miebrdf/brdf.h>
#include <miebrdf/formats.h>
#include "pipeline/scene/number_list.h"
#include "pipeline/scene/request.h"
#include "tools/bench/process_memory.h"

namespace {

using namespace miebrdf;
namespace fs = std::filesystem;

// One thread: what a child inherits has no threads, and CPU time is that of the work alone.
const Control kControl{.threads = 1};

/// Of a Deviation.
constexpr std::size_t kRegions = 7;

double cpu_seconds() {
    rusage usage{};
    getrusage(RUSAGE_SELF, &usage);
    return double(usage.ru_utime.tv_sec + usage.ru_stime.tv_sec) +
           1e-6 * double(usage.ru_utime.tv_usec + usage.ru_stime.tv_usec);
}

std::string albedo_columns(const ExportedFile& file, const BrdfSource& source) {
    const auto read = open_brdf_file(file.path.string());
    const FileCheck check = check_file(*read);
    return fmt::format(
        "{:.1e} | {}", compare_file(*read, source).albedo_error,
        check.sampled_albedo_error ? fmt::format("{:.1e}", *check.sampled_albedo_error) : "");
}

void print_row(const Format& format, const fs::path& folder, const BrdfSource& source) {
    const double seconds = cpu_seconds(), resident = bench::resident_bytes();
    std::vector<ExportedFile> files;
    try {
        files = export_brdf(source, format, folder / ("a." + format.name), {}, kControl);
    } catch (const TooCoarse& refusal) {
        fmt::print("| {} | refused: {} |\n", format.name, refusal.what());
        return;
    }
    const double took = cpu_seconds() - seconds;
    const double memory = bench::peak_bytes() - resident;
    for (const ExportedFile& file : files) {
        std::string errors;
        for (std::size_t region = 0; region < kRegions; ++region) {
            errors += region == 0 ? "" : " | ";
            const auto& d = file.deviation;
            errors += d ? fmt::format("{:.1e}", d->regions.at(region).rms) : "exact";
        }
        const std::string name = format.name + file.path.stem().string().substr(1);
        fmt::print("| {} | {} | {} | {} | {:.2f} | {:.0f} |\n", name, file.bytes, errors,
                   albedo_columns(file, source), took, 1e-6 * memory);
    }
}

/// Each format in a process of its own, whose peak of memory is that of the format.
void print_table(const char* title, const Request& request, const fs::path& folder) {
    const double start = cpu_seconds();
    const BrdfTable source =
        miebrdf::solve(request.scene, request.wavelength_nm, request.solver, kControl)
            .table({BrdfPart::total, "bench_exports"});
    fmt::print("{} (the solution takes {:.1f} s of CPU time):\n\n", title, cpu_seconds() - start);
    fmt::print(
        "| format | bytes | mu > 0.2 | mu 0.05-0.2 | mu < 0.05 | near mirror | near mirror, mu < "
        "0.2 | retro | zenith | albedo | sampling | s | MB "
        "|\n|---|---|---|---|---|---|---|---|---|---|---|---|---|\n");
    malloc_trim(0);  // else children begin with free memory that no count shows
    for (const Format& format : all_formats()) {
        if (format.files.empty()) continue;  // no BRDF
        if (format.whole_matrix) continue;   // of 5 wavelengths at most, and polarised
        std::fflush(stdout);
        const pid_t child = fork();
        if (child == 0) {
            print_row(format, folder, source);
            std::fflush(stdout);
            _exit(0);
        }
        waitpid(child, nullptr, 0);
    }
    fmt::print("\n");
}

}  // namespace

int main() {
    const fs::path folder = fs::temp_directory_path() / fmt::format("bench_exports.{}", getpid());
    fs::create_directory(folder);
    Request request;
    request.wavelength_nm = parse_wavelengths_nm("400:700:10");
    request.scene.base = medium("hg:0.9,0.4");
    print_table("A Henyey-Greenstein half-space of albedo 0.9, g = 0.4", request, folder);
    request.scene.base = medium("TiO2");
    request.scene.layers = {layer("AlGaAs7@0.1[grey]")};
    print_table("AlGaAs7 of optical depth 0.1 on TiO2 (50 um spheres)", request, folder);
    fs::remove_all(folder);
}
