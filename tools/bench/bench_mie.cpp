// Mie theory: error against CPU time for the reference ensembles, scaling, and what each request
// costs. One line per case; `error` is the largest of q_ext, albedo and moments (absolute, chi_0 =
// 1). Every line has every counter (--benchmark_format=csv wants that); nan: not known.
#include <benchmark/benchmark.h>
#include <fmt/format.h>
#include <oneapi/tbb/parallel_for.h>
#include <oneapi/tbb/task_arena.h>
#include <sys/resource.h>

#include <cmath>
#include <cstdlib>
#include <fstream>
#include <functional>
#include <map>
#include <memory>
#include <sstream>
#include <string>
#include <utility>
#include <vector>

#include <miebrdf/ensemble.h>
#include <miebrdf/sphere.h>
#include "mie/sphere/sphere_block.h"
#include "tools/bench/process_memory.h"
#include "tools/miebrdf/program.h"

using namespace miebrdf;

namespace {

struct ReferenceCase {
    mie::EnsembleRequest request;
    double q_ext = 0, albedo = 0;
    std::vector<double> chi;
};

std::vector<std::vector<double>> rows_of(const std::string& name) {
    std::ifstream file(std::string(MIEBRDF_REFERENCE_DIR) + "/mie/" + name);
    std::vector<std::vector<double>> rows;
    std::string line, field;
    bool header = true;
    while (std::getline(file, line)) {
        if (line.empty() || line[0] == '#') continue;
        if (std::exchange(header, false)) continue;
        std::istringstream fields(line);
        rows.emplace_back();
        while (std::getline(fields, field, ','))
            rows.back().push_back(std::strtod(field.c_str(), nullptr));
    }
    return rows;
}

std::vector<ReferenceCase> reference_cases() {
    std::map<int, ReferenceCase> cases;
    for (const auto& row : rows_of("poly_summary.csv")) {
        ReferenceCase& c = cases[static_cast<int>(row[0])];
        c.request.sizes.effective_radius_um = row[1];
        c.request.wavelength_nm = 1e3 * row[2];
        c.request.refractive_index = {row[3], row[4]};
        c.request.highest_moment = 64;
        c.q_ext = row[9];
        c.albedo = row[11];
    }
    for (const auto& row : rows_of("poly_moments.csv")) {
        ReferenceCase& c = cases[static_cast<int>(row[0])];
        if (row[1] <= 64) c.chi.push_back(row[2]);
    }
    std::vector<ReferenceCase> list;
    for (auto& [number, c] : cases) list.push_back(std::move(c));
    return list;
}

double error_of(const ReferenceCase& c, const mie::EnsembleOptics& optics) {
    double error = std::max(std::abs(optics.q_ext / c.q_ext - 1),
                            std::abs(optics.single_scattering_albedo / c.albedo - 1));
    for (std::size_t l = 0; l < c.chi.size(); ++l) {
        error = std::max(error, std::abs(optics.chi[l] - c.chi[l]));
    }
    return error;
}

// Of the process so far: meaningful with --benchmark_filter on one row.
double peak_mebibytes() {
    rusage usage{};
    getrusage(RUSAGE_SELF, &usage);
    return static_cast<double>(usage.ru_maxrss) / 1024;
}

struct Counters {
    double error = NAN;
    double estimate = NAN;
    double nodes = NAN;
    double spheres = 0;  ///< in one run; 0: of no interest
};

void report(benchmark::State& state, const Counters& counters) {
    state.counters["error"] = counters.error;
    state.counters["estimate"] = counters.estimate;
    state.counters["nodes"] = counters.nodes;
    state.counters["peak_MiB"] = peak_mebibytes();
    state.counters["spheres_per_s"] = benchmark::Counter(
        counters.spheres > 0 ? counters.spheres * static_cast<double>(state.iterations()) : NAN,
        benchmark::Counter::kIsRate);
}

void run_ensemble(benchmark::State& state, const ReferenceCase& c) {
    mie::EnsembleOptics optics;
    for (auto _ : state) optics = mie::average_over_sizes(c.request);
    report(state, {c.chi.empty() ? NAN : error_of(c, optics), optics.error_estimate,
                   static_cast<double>(optics.size_nodes)});
}

void register_reference_cases() {
    for (const double tolerance : {1e-3, 1e-4, 1e-5}) {
        for (ReferenceCase c : reference_cases()) {
            c.request.tolerance = tolerance;
            const auto name = fmt::format(
                "ensemble/n={},k={},r_eff={},nm={:.0f}/tolerance={:.0e}",
                c.request.refractive_index.real(), c.request.refractive_index.imag(),
                c.request.sizes.effective_radius_um, c.request.wavelength_nm, tolerance);
            benchmark::RegisterBenchmark(name.c_str(), [c](benchmark::State& s) {
                run_ensemble(s, c);
            })->Unit(benchmark::kMillisecond);
        }
    }
}

// What is not asked for is not paid for; and how cost grows with moments and with x_max.
void register_requests() {
    for (const std::complex<double> m : {std::complex<double>(2.6, 0), {3.3, 0.02}}) {
        const auto add = [m](const std::string& what, const mie::EnsembleRequest& request) {
            ReferenceCase c;
            c.request = request;
            c.request.refractive_index = m;
            const auto name = fmt::format("request/n={},k={}/{}", m.real(), m.imag(), what);
            benchmark::RegisterBenchmark(name.c_str(), [c](benchmark::State& s) {
                run_ensemble(s, c);
            })->Unit(benchmark::kMillisecond);
        };
        add("albedo", {});
        for (const int moments : {16, 32, 64, 128, 255, 2900}) {
            add(fmt::format("moments={}", moments), {.highest_moment = moments});
        }
        add("angles=8", {.angles_deg = {0, 30, 60, 90, 120, 150, 170, 180}});
        add("table", {.with_phase_table = true});
        add("moments=64+table", {.highest_moment = 64, .with_phase_table = true});
        for (const double radius : {1.0, 5.0, 20.0, 100.0}) {
            mie::EnsembleRequest request{.highest_moment = 64};
            request.sizes.effective_radius_um = radius;
            add(fmt::format("r_eff={}", radius), request);
        }
    }
}

// One large ensemble on several threads; every number of threads gives the same bits.
void register_threads() {
    // One for all runs, and pieces of their own, as in the program.
    const std::shared_ptr<tbb::task_arena> arenas[] = {std::make_shared<tbb::task_arena>(1),
                                                       std::make_shared<tbb::task_arena>(2)};
    for (const std::complex<double> m : {std::complex<double>(2.6, 0), {3.3, 0.02}}) {
        for (const bool table : {false, true}) {
            for (const int threads : {1, 2}) {
                const auto arena = arenas[threads - 1];
                mie::EnsembleRequest request{.refractive_index = m, .highest_moment = 64};
                request.with_phase_table = table;
                const auto name = fmt::format("threads/n={},k={}/{}/threads={}", m.real(), m.imag(),
                                              table ? "moments+table" : "moments", threads);
                benchmark::RegisterBenchmark(
                    name.c_str(),
                    [=](benchmark::State& state) {
                        const mie::Executor run = [&](int count,
                                                      const std::function<void(int)>& job) {
                            arena->execute([&] {
                                tbb::parallel_for(
                                    tbb::blocked_range<int>(0, count, 1),
                                    [&](const tbb::blocked_range<int>& range) {
                                        for (int i = range.begin(); i != range.end(); ++i) job(i);
                                    },
                                    tbb::simple_partitioner());
                            });
                        };
                        mie::EnsembleOptics optics;
                        for (auto _ : state) optics = mie::average_over_sizes(request, run);
                        report(state, {NAN, optics.error_estimate,
                                       static_cast<double>(optics.size_nodes)});
                    })
                    ->Unit(benchmark::kMillisecond)
                    ->UseRealTime();
            }
        }
    }
}

void single_sphere(benchmark::State& state, std::complex<double> m, double x) {
    for (auto _ : state) benchmark::DoNotOptimize(mie::scatter_by_sphere(m, x));
    report(state, {.spheres = 1});
}

void sphere_block(benchmark::State& state, std::complex<double> m, double x) {
    std::vector<double> sizes, weights(64, 1.0);
    for (int i = 0; i < 64; ++i) sizes.push_back(x + 0.1 * i);
    for (auto _ : state) benchmark::DoNotOptimize(mie::compute_spheres(m, sizes, weights, nullptr));
    report(state, {.spheres = 64});
}

}  // namespace

int main(int argc, char** argv) {
    for (const std::complex<double> m :
         {std::complex<double>(2.6, 0), {1.46, 0}, {3.3, 0.02}, {1.5, 1000}}) {
        for (const double x : {10.0, 1000.0, 100000.0}) {
            const auto name = fmt::format("n={},k={},x={}", m.real(), m.imag(), x);
            benchmark::RegisterBenchmark(("sphere/" + name).c_str(), [=](benchmark::State& s) {
                single_sphere(s, m, x);
            })->Unit(benchmark::kMicrosecond);
            if (x > 1e4) continue;
            benchmark::RegisterBenchmark(("block_of_64/" + name).c_str(), [=](benchmark::State& s) {
                sphere_block(s, m, x);
            })->Unit(benchmark::kMicrosecond);
        }
    }
    register_requests();
    register_threads();
    register_reference_cases();
    program::keep_freed_memory();  // as the program does
    benchmark::Initialize(&argc, argv);
    benchmark::RunSpecifiedBenchmarks();
    return 0;
}
