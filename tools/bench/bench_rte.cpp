// Error against time of radiative transfer: each benchmark reports the error beside the time, so
// that a faster but worse method cannot look like progress.
#include <benchmark/benchmark.h>
#include <fmt/format.h>
#include <miebrdf/layer_albedos.h>

#include <algorithm>
#include <cmath>
#include <vector>

#include "rte/fourier/eigenmodes.h"
#include "rte/half_space/half_space.h"
#include "rte/phase/scaled_medium.h"
#include "rte/stack/layered_reflection.h"
#include "rte/stack/stack_solver.h"
#include "tests/support/allocation_count.h"

using namespace miebrdf;

namespace {

// Order-by-order reflection matrix of a half-space between all nodes, until two successive orders
// are below the tolerance: what discrete-ordinate codes deliver.
int all_modes(const rte::Optics& optics, int streams, double tolerance) {
    const int moments = int(std::min<std::size_t>(2 * std::size_t(streams), optics.chi.size()));
    const auto scaled = rte::scale_optics(optics, moments, true);
    const auto grid = rte::make_mapped_gauss_grid(streams);
    const Eigen::VectorXd strengths = scaled.strengths();
    const Eigen::VectorXd D = rte::flux_weights(grid);
    rte::RequestedDirections none{Eigen::VectorXd(0), {}, {}};
    rte::LegendreSampling sampling;
    rte::FourierMode mode;
    double order_zero = 0.0;
    int small_orders = 0;
    int order = 0;
    for (; order < moments && small_orders < 2; ++order) {
        rte::make_fourier_mode(order, moments, grid, none, sampling, mode);
        const rte::FourierMedium medium{strengths.tail(moments - order), scaled.one_minus_albedo,
                                        order};
        const auto half_space = rte::solve_half_space(rte::HalfSpaceMethod::automatic, medium, mode,
                                                      grid, none, tolerance);
        const Eigen::MatrixXd single = mode.at_nodes *
                                       rte::alternating(medium.strengths).asDiagonal() *
                                       mode.at_nodes.transpose();
        double largest = 0.0;
        for (Eigen::Index q = 0; q < grid.size(); ++q) {
            for (Eigen::Index p = 0; p <= q; ++p) {
                const double bounded =
                    half_space.nodes(p, q) / (2.0 * D[p] * D[q]) * (grid.mu[p] + grid.mu[q]);
                largest = std::max(largest, std::abs(bounded - 0.25 * single(p, q)));
            }
        }
        if (order == 0) order_zero = largest;
        small_orders = largest <= tolerance * order_zero ? small_orders + 1 : 0;
    }
    return order;
}

// Largest deviation, relative to the largest value at each incidence, from four times the nodes.
double error_of(const rte::Stack& stack, int streams, double tolerance) {
    const rte::Directions directions{
        {0.1, 0.3, 0.6, 1.0}, {0.1, 0.3, 0.6, 1.0}, {0.0, 60.0, 180.0}};
    const auto value =
        rte::reflect(stack, directions, {.tolerance = tolerance, .streams = streams});
    const auto truth =
        rte::reflect(stack, directions, {.tolerance = 1e-11, .streams = 4 * streams});
    const std::size_t block = 12;
    double largest = 0.0;
    for (std::size_t start = 0; start < truth.reflection.size(); start += block) {
        double scale = 0.0;
        double difference = 0.0;
        for (std::size_t k = start; k < start + block; ++k) {
            scale = std::max(scale, truth.reflection[k]);
            difference = std::max(difference, std::abs(truth.reflection[k] - value.reflection[k]));
        }
        largest = std::max(largest, difference / scale);
    }
    return largest;
}

// Every line has every counter: --benchmark_format=csv wants that. nan: of no meaning there.
void report(benchmark::State& state, double orders, double iterations, double error) {
    state.counters["orders"] = orders;
    state.counters["iterations"] = iterations;
    state.counters["error"] = error;
    state.counters["allocations"] = NAN;
}

// Arguments: albedo in 1e-4, g in 1e-2, nodes, -log10 of the tolerance.
void half_space_all_modes(benchmark::State& state) {
    const auto optics =
        rte::henyey_greenstein_optics(double(state.range(0)) * 1e-4, double(state.range(1)) * 1e-2);
    const int streams = int(state.range(2));
    const double tolerance = std::pow(10.0, -double(state.range(3)));
    int orders = 0;
    for (auto _ : state) orders = all_modes(optics, streams, tolerance);
    report(state, orders, NAN, error_of({.base = optics}, streams, tolerance));
}
BENCHMARK(half_space_all_modes)
    ->Unit(benchmark::kMicrosecond)
    ->Args({9900, 75, 16, 5})
    ->Args({9900, 75, 24, 7})
    ->Args({9900, 75, 32, 9})
    ->Args({9999, 90, 24, 4})
    ->Args({9999, 90, 32, 5})
    ->Args({9999, 90, 64, 7})
    ->Args({9000, 0, 16, 9})
    ->Args({9000, 0, 32, 12});

void order_zero(benchmark::State& state) {
    const auto optics = rte::henyey_greenstein_optics(0.99, 0.75);
    const int streams = int(state.range(0));
    const auto method = rte::HalfSpaceMethod(state.range(1));
    const auto scaled = rte::scale_optics(optics, 2 * streams, true);
    const auto grid = rte::make_mapped_gauss_grid(streams);
    rte::RequestedDirections none{Eigen::VectorXd(0), {}, {}};
    rte::LegendreSampling sampling;
    rte::FourierMode mode;
    rte::make_fourier_mode(0, 2 * streams, grid, none, sampling, mode);
    const rte::FourierMedium medium{scaled.strengths(), scaled.one_minus_albedo};
    int iterations = 0;
    for (auto _ : state) {
        const auto result = rte::solve_half_space(method, medium, mode, grid, none, 1e-7);
        iterations = result.iterations;
        benchmark::DoNotOptimize(result.nodes.data());
    }
    report(state, 1, iterations, NAN);
}
BENCHMARK(order_zero)->Unit(benchmark::kMicrosecond)->ArgsProduct({{16, 32, 64, 128}, {0, 1, 2}});

// One wavelength of the paper's kind of scene: coat on base, 5 x 20 x 2 directions, fixed nodes.
void coat_on_base(benchmark::State& state) {
    const rte::Stack stack{
        .base = rte::henyey_greenstein_optics(0.95, 0.7),
        .coats = {{rte::henyey_greenstein_optics(0.9, 0.46), double(state.range(1)) * 1e-2}}};
    rte::Directions directions{{0.2, 0.4, 0.6, 0.8, 1.0}, {}, {0.0, 180.0}};
    for (int k = 1; k <= 20; ++k) directions.mu_out.push_back(k / 20.0);
    rte::Stack scene = stack;
    if (state.range(1) == 0) scene.coats.clear();
    const rte::SolverOptions options{.tolerance = 1e-5, .streams = int(state.range(0))};
    for (auto _ : state) {
        benchmark::DoNotOptimize(rte::reflect(scene, directions, options).reflection.data());
    }
    report(state, NAN, NAN, error_of(scene, options.streams, options.tolerance));
}
BENCHMARK(coat_on_base)->Unit(benchmark::kMicrosecond)->ArgsProduct({{16, 32}, {0, 10, 1000}});

// A coat as peaked as the half-space under it, which takes as many orders. Arguments: 100 g, 100
// times its optical depth (0: no coat).
void coat_like_its_base(benchmark::State& state) {
    const double g = double(state.range(0)) * 1e-2;
    rte::Stack stack{.base = rte::henyey_greenstein_optics(0.95, g)};
    if (state.range(1) > 0) {
        stack.coats = {{rte::henyey_greenstein_optics(0.9, g), double(state.range(1)) * 1e-2}};
    }
    rte::Directions directions{{0.2, 0.4, 0.6, 0.8, 1.0}, {}, {0.0, 180.0}};
    for (int k = 1; k <= 20; ++k) directions.mu_out.push_back(k / 20.0);
    const rte::SolverOptions options{.tolerance = 1e-5, .streams = 32};
    for (auto _ : state) {
        benchmark::DoNotOptimize(rte::reflect(stack, directions, options).reflection.data());
    }
    report(state, NAN, NAN, error_of(stack, options.streams, options.tolerance));
}
BENCHMARK(coat_like_its_base)
    ->Unit(benchmark::kMicrosecond)
    ->ArgsProduct({{46, 70, 80}, {0, 10, 100, 1000}});

// 31 wavelengths of a coat on a base, one thread: each with memory of its own, or all with the
// same. Arguments: nodes, shared.
void wavelengths_of_a_coat(benchmark::State& state) {
    std::vector<rte::Stack> stacks;
    for (int w = 0; w < 31; ++w) {
        stacks.push_back({.base = rte::henyey_greenstein_optics(0.95 - 1e-3 * w, 0.7 - 2e-3 * w),
                          .coats = {{rte::henyey_greenstein_optics(0.9 - 2e-3 * w, 0.46), 0.1}}});
    }
    rte::Directions directions{{0.2, 0.4, 0.6, 0.8, 1.0}, {}, {0.0, 180.0}};
    for (int k = 1; k <= 20; ++k) directions.mu_out.push_back(k / 20.0);
    rte::SolutionMemory memory;
    rte::SolutionMemory* const shared = state.range(1) == 1 ? &memory : nullptr;
    const rte::SolverOptions options{.tolerance = 1e-5, .streams = int(state.range(0))};
    for (auto _ : state) {
        for (const rte::Stack& stack : stacks) {
            benchmark::DoNotOptimize(
                rte::reflect(stack, directions, options, shared).reflection.data());
        }
    }
    report(state, NAN, NAN, error_of(stacks.back(), options.streams, options.tolerance));
}
BENCHMARK(wavelengths_of_a_coat)->Unit(benchmark::kMicrosecond)->ArgsProduct({{16, 32}, {0, 1}});

// Azimuthal orders of coats on a base, one after the other in the same memory: time of one order
// and allocations in it (nan where they cannot be counted). Arguments: nodes, coats.
void orders_of_a_stack(benchmark::State& state) {
    rte::Stack stack{.base = rte::henyey_greenstein_optics(0.95, 0.7)};
    for (int c = 0; c < int(state.range(1)); ++c) {
        stack.coats.push_back({rte::henyey_greenstein_optics(0.9, 0.7), 0.5});
    }
    const int streams = int(state.range(0));
    const auto scaled = rte::scale_stack(stack, 2 * streams, true);
    const rte::StackGrids grids(rte::make_mapped_gauss_grid(streams));
    rte::RequestedDirections requested{Eigen::VectorXd::LinSpaced(20, 0.05, 1.0), {}, {}};
    for (int k = 0; k < 20; ++k) requested.out.push_back(k);
    requested.in = {3, 9, 19};
    const rte::SolverOptions options{.tolerance = 1e-5};
    rte::StackMemory memory;
    rte::StackSolver solver(scaled, grids, requested, options, memory);
    constexpr int highest = 8;
    solver.solve(0, rte::ReflectorParts::pairs);
    double count = NAN;
    for (auto _ : state) {
        const long before = support::allocation_count();
        for (int m = 1; m <= highest; ++m) solver.solve(m, rte::ReflectorParts::pairs);
        if (support::kCountsAllocations)
            count = double(support::allocation_count() - before) / highest;
    }
    report(state, highest, NAN, NAN);
    state.counters["allocations"] = count;
}
BENCHMARK(orders_of_a_stack)->Unit(benchmark::kMicrosecond)->ArgsProduct({{16, 32, 64}, {0, 1, 2}});

// Plane albedos of 4096 layers of HG media, g from 0 to 0.9 on the slowest axis: layers a second,
// and allocations for each. Argument: 0 half-spaces, 1 layers on grounds, 2 those below a boundary.
void layers_of_a_batch(benchmark::State& state) {
    std::vector<double> albedo, g, depth;
    for (int i = 0; i < 16; ++i) {
        for (int j = 0; j < 256; ++j) {
            g.push_back(0.9 * i / 15.0);
            albedo.push_back(j / 256.0);
            depth.push_back(state.range(0) == 0 ? INFINITY : 0.1 * (1 + j % 32));
        }
    }
    const std::vector<double> index{state.range(0) == 2 ? 1.5 : 1.0}, ground{0.2}, mu_in{0.5};
    long count = 0;
    double converged = 0.0;
    for (auto _ : state) {
        const long before = support::allocation_count();
        const auto all =
            layer_albedos({albedo, g, depth, index, ground, mu_in}, {}, {.threads = 1});
        count += support::allocation_count() - before;
        converged = double(std::count(all.converged.begin(), all.converged.end(), 1));
    }
    const auto layers = double(albedo.size());
    state.counters["layers"] =
        benchmark::Counter(layers * double(state.iterations()), benchmark::Counter::kIsRate);
    state.counters["converged"] = converged / layers;
    state.counters["allocations"] =
        support::kCountsAllocations ? double(count) / double(state.iterations()) / layers : NAN;
}
BENCHMARK(layers_of_a_batch)->Unit(benchmark::kMillisecond)->DenseRange(0, 2);

}  // namespace

BENCHMARK_MAIN();
