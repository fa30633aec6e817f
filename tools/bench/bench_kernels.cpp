// Micro-benchmarks of the kernels that a run spends its time in (docs/benchmarking.md).
#include <benchmark/benchmark.h>

#include <cmath>
#include <complex>

#include <miebrdf/ensemble.h>
#include <miebrdf/sphere.h>
#include <miebrdf/surface.h>
#include "rte/fourier/eigenmodes.h"
#include "rte/half_space/half_space.h"
#include "rte/math/legendre.h"
#include "rte/math/quadrature.h"
#include "rte/stack/layered_reflection.h"

namespace {

using namespace miebrdf;

void sphere(benchmark::State& state) {
    const double x = static_cast<double>(state.range(0));
    const std::complex<double> index(2.6, state.range(1) == 0 ? 0.0 : 0.02);
    for (auto _ : state) benchmark::DoNotOptimize(mie::scatter_by_sphere(index, x));
}
BENCHMARK(sphere)->ArgNames({"x", "absorbing"})->ArgsProduct({{1, 30, 1000}, {0, 1}});

void ensemble(benchmark::State& state) {
    mie::EnsembleRequest request;
    request.refractive_index = {2.6, state.range(0) == 0 ? 0.0 : 0.02};
    request.highest_moment = static_cast<int>(state.range(1));
    request.tolerance = 1e-3;
    for (auto _ : state) benchmark::DoNotOptimize(mie::average_over_sizes(request));
}
BENCHMARK(ensemble)
    ->ArgNames({"absorbing", "moments"})
    ->ArgsProduct({{0, 1}, {16, 64}})
    ->Unit(benchmark::kMillisecond);

void legendre_functions(benchmark::State& state) {
    const auto rule = math::gauss_legendre(static_cast<int>(state.range(0)), 0, 1);
    const Eigen::VectorXd mu =
        Eigen::Map<const Eigen::VectorXd>(rule.nodes.data(), Eigen::Index(rule.nodes.size()));
    Eigen::MatrixXd table;
    for (auto _ : state) {
        math::legendre_functions(0, 2 * static_cast<int>(state.range(0)), mu, table);
        benchmark::DoNotOptimize(table.data());
    }
}
BENCHMARK(legendre_functions)->ArgName("n")->Arg(16)->Arg(64);

// One azimuthal order of a half-space, by method.
void half_space_order(benchmark::State& state) {
    const int n = static_cast<int>(state.range(0)), degrees = n;
    const auto grid = rte::make_gauss_grid(n);
    rte::RequestedDirections requested;
    requested.mu = Eigen::VectorXd::Constant(1, 0.5);
    requested.in = requested.out = {0};
    rte::LegendreSampling sampling;
    rte::FourierMode mode;
    rte::make_fourier_mode(0, degrees, grid, requested, sampling, mode);
    rte::FourierMedium medium;
    medium.strengths.resize(degrees);
    for (int l = 0; l < degrees; ++l) medium.strengths[l] = 0.95 * (2 * l + 1) * std::pow(0.75, l);
    medium.one_minus_albedo = 0.05;
    const auto method = static_cast<rte::HalfSpaceMethod>(state.range(1));
    for (auto _ : state) {
        benchmark::DoNotOptimize(rte::solve_half_space(method, medium, mode, grid, requested));
    }
}
BENCHMARK(half_space_order)
    ->ArgNames({"n", "method"})
    ->ArgsProduct({{16, 32, 64}, {0, 1, 2}})
    ->Unit(benchmark::kMicrosecond);

void coated_reflection(benchmark::State& state) {
    rte::Stack stack;
    stack.base = rte::henyey_greenstein_optics(0.95, 0.7);
    stack.coats.push_back({rte::henyey_greenstein_optics(0.9, 0.46), 0.1});
    const rte::Directions directions{{0.2, 0.5, 0.9}, {0.2, 0.5, 0.9}, {0, 90, 180}};
    const rte::SolverOptions options{.streams = static_cast<int>(state.range(0))};
    for (auto _ : state) benchmark::DoNotOptimize(rte::reflect(stack, directions, options));
}
BENCHMARK(coated_reflection)->ArgName("n")->Arg(8)->Arg(16)->Arg(32)->Unit(benchmark::kMillisecond);

void surface_reflectance(benchmark::State& state) {
    for (auto _ : state) {
        benchmark::DoNotOptimize(rte::directional_reflectance({2.6, 0.01}, {}, 0.5, 1e-6));
    }
}
BENCHMARK(surface_reflectance)->Unit(benchmark::kMicrosecond);

}  // namespace

BENCHMARK_MAIN();
