// What the materials database costs: a query as every command makes it, and both large collections,
// stood in for by synthetic files of the same number and size, imported from disk.
#include <benchmark/benchmark.h>
#include <fmt/format.h>
#include <stdlib.h>

#include <cmath>
#include <filesystem>
#include <fstream>
#include <stdexcept>
#include <string>
#include <vector>

#include <miebrdf/database.h>

namespace {

namespace fs = std::filesystem;
using namespace miebrdf::materials;

constexpr int sopra_files = 278, rii_pages = 3478, rows_per_file = 346;

double sum_of_81(const RefractiveIndex& index) {
    double sum = 0;
    for (int i = 0; i < 81; ++i) sum += std::abs(index.at(380 + 5 * i));
    return sum;
}

// What a run does after its start: the database is opened, a name resolved, 81 values computed.
void open_resolve_81_wavelengths(benchmark::State& state) {
    for (auto _ : state) {
        const auto index = Database::embedded().refractive_index("titanium dioxide");
        benchmark::DoNotOptimize(sum_of_81(index));
    }
}
BENCHMARK(open_resolve_81_wavelengths)->Unit(benchmark::kMicrosecond);

void resolve_81_wavelengths(benchmark::State& state) {
    const Database database = Database::embedded();
    for (auto _ : state) {
        benchmark::DoNotOptimize(sum_of_81(database.refractive_index("titanium dioxide")));
    }
}
BENCHMARK(resolve_81_wavelengths)->Unit(benchmark::kMicrosecond);

class TemporaryFolder {
  public:
    TemporaryFolder() {
        std::string pattern = (fs::temp_directory_path() / "miebrdf-bench-XXXXXX").string();
        if (::mkdtemp(pattern.data()) == nullptr) throw std::runtime_error("no temporary folder");
        path = pattern;
    }
    ~TemporaryFolder() { fs::remove_all(path); }
    fs::path path;
};

// Smooth, different in every file, with as many digits as the collections print.
double n_of(int file, int row) { return 1.5 + 0.4 * std::sin(0.01 * row + file); }
double k_of(int file, int row) { return 0.2 + 0.1 * std::cos(0.02 * row + file); }

void write_sopra_collection(const fs::path& folder) {
    fs::create_directories(folder);
    for (int i = 0; i < sopra_files; ++i) {
        std::ofstream file(folder / fmt::format("S{}.NK", i));
        file << fmt::format("1 0.6 6.5 {}\n", rows_per_file - 1);
        for (int row = 0; row < rows_per_file; ++row) {
            file << fmt::format("{:.6f} {:.6f}\n", n_of(i, row), k_of(i, row));
        }
    }
}

void write_rii_page(const fs::path& path, int i) {
    fs::create_directories(path.parent_path());
    std::ofstream file(path);
    file << "REFERENCES: \"A. Author. Journal of Constants <b>1</b>, 1-2 (2001)\"\n"
            "COMMENTS: \"Room temperature\"\nDATA:\n  - type: tabulated nk\n    data: |\n";
    for (int row = 0; row < rows_per_file; ++row) {
        file << fmt::format("        {:.16f} {:.12f} {:.12f}\n", 0.2 + 0.01 * row, n_of(i, row),
                            k_of(i, row));
    }
}

void write_rii_database(const fs::path& folder) {
    fs::create_directories(folder);
    std::ofstream catalogue(folder / "catalog-nk.yml");
    catalogue << "- SHELF: main\n  name: \"MAIN\"\n  content:\n";
    constexpr int pages_per_book = 6;
    for (int i = 0; i < rii_pages; ++i) {
        const int book = i / pages_per_book;
        if (i % pages_per_book == 0) {
            catalogue << fmt::format(
                "    - BOOK: B{0}\n      name: \"B{0} (Substance)\"\n      content:\n", book);
        }
        const std::string page = fmt::format("main/B{}/nk/P{}.yml", book, i);
        catalogue << fmt::format(
            "        - PAGE: P{0}\n          name: \"Author {0}\"\n"
            "          data: {1}\n",
            i, page);
        write_rii_page(folder / "data" / page, i);
    }
}

std::uintmax_t bytes_below(const fs::path& folder) {
    std::uintmax_t bytes = 0;
    for (const auto& entry : fs::recursive_directory_iterator(folder)) {
        if (entry.is_regular_file()) bytes += entry.file_size();
    }
    return bytes;
}

// Argument 0: into a new database; 1: into one that has it all, which changes nothing.
void import_both_collections(benchmark::State& state) {
    const TemporaryFolder folder;
    const std::vector<fs::path> sources{folder.path / "sopra", folder.path / "rii"};
    write_sopra_collection(sources[0]);
    write_rii_database(sources[1]);
    const double megabytes = 1e-6 * static_cast<double>(bytes_below(folder.path));
    const fs::path file = folder.path / "user.sqlite";
    const auto import_all = [&] { return import_files(file, sources); };
    if (state.range(0) == 1) import_all();
    std::size_t accepted = 0, refused = 0;
    for (auto _ : state) {
        if (state.range(0) == 0) fs::remove(file);
        accepted = refused = 0;
        for (const ImportItem& item : import_all()) (item.outcome ? accepted : refused)++;
    }
    state.counters["read_MB"] = megabytes;
    state.counters["database_MiB"] = static_cast<double>(fs::file_size(file)) / (1 << 20);
    state.counters["accepted"] = static_cast<double>(accepted);
    state.counters["refused"] = static_cast<double>(refused);
}
BENCHMARK(import_both_collections)
    ->ArgName("again")
    ->Arg(0)
    ->Arg(1)
    ->Iterations(3)
    ->UseRealTime()
    ->MeasureProcessCPUTime()
    ->Unit(benchmark::kSecond);

}  // namespace

BENCHMARK_MAIN();
