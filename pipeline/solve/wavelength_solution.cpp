#include "pipeline/solve/wavelength_solution.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>

#include "pipeline/solve/probe_directions.h"
#include "rte/grid/discretisation.h"
#include "rte/math/tolerance_budget.h"
#include "rte/stack/fourier_sum.h"
#include "rte/stack/layered_reflection.h"
#include "rte/stack/stack_solver.h"

namespace miebrdf::exports {
namespace {

constexpr double kPi = std::numbers::pi;

/// Row m: the weights that turn n + 1 samples at azimuths pi j / n into the coefficient of order m.
Eigen::MatrixXd analysis_matrix(std::size_t orders, std::size_t n) {
    Eigen::MatrixXd matrix(static_cast<Eigen::Index>(orders), static_cast<Eigen::Index>(n + 1));
    for (std::size_t m = 0; m < orders; ++m) {
        for (std::size_t j = 0; j <= n; ++j) {
            const double angle =
                kPi * static_cast<double>((m * j) % (2 * n)) / static_cast<double>(n);
            matrix(static_cast<Eigen::Index>(m), static_cast<Eigen::Index>(j)) =
                (j == 0 || j == n ? 0.5 : 1.0) * (m == 0 ? 1.0 : 2.0) / static_cast<double>(n) *
                std::cos(angle);
        }
    }
    return matrix;
}

/// The solver's table of (in, out, azimuth) as Fourier series.
SmoothPart tabulate(const rte::MultipleScattering& multiple, std::size_t samples) {
    const std::vector<double>& nodes = SmoothPart::nodes();
    const auto orders = static_cast<std::size_t>(std::max(1, multiple.fourier_orders));
    std::vector<double> modes(nodes.size() * nodes.size() * orders);
    const Eigen::MatrixXd analysis = analysis_matrix(orders, samples);
    for (std::size_t pair = 0; pair < nodes.size() * nodes.size(); ++pair) {
        const Eigen::Map<const Eigen::VectorXd> values(&multiple.reflection[pair * (samples + 1)],
                                                       static_cast<Eigen::Index>(samples + 1));
        Eigen::Map<Eigen::VectorXd>(&modes[pair * orders], static_cast<Eigen::Index>(orders)) =
            (nodes[pair / nodes.size()] + nodes[pair % nodes.size()]) * (analysis * values);
    }
    if (!multiple.physical) {
        std::fill(modes.begin(), modes.end(), std::numeric_limits<double>::quiet_NaN());
    }
    return {std::move(modes), orders};
}

}  // namespace

WavelengthSolution::WavelengthSolution(const SceneOptics& optics,
                                       std::optional<std::complex<double>> surface_index,
                                       const Request& request, Component component) {
    if (component != Component::surface) solve(optics, request);
    if (surface_index && component != Component::subsurface) {
        lobe_.emplace(*surface_index, *request.scene.surface);
        const rte::SurfaceTransmission transmission(*lobe_, request.scene.coupling);
        for (const double mu : SmoothPart::nodes()) {
            factor_in_.push_back(transmission.in(mu));
            factor_out_.push_back(transmission.out(mu));
        }
        smooth_.scale(factor_in_, factor_out_);
    }
}

void WavelengthSolution::solve(const SceneOptics& optics, const Request& request) {
    const std::vector<double>& nodes = SmoothPart::nodes();
    report_ = rte::reflect(optics.stack, probe_directions(), request.solver).report;

    rte::SolverOptions options = request.solver;
    options.streams = report_.streams;
    const rte::ScaledStack scaled =
        rte::scale_stack(optics.stack, report_.moments, options.delta_m);
    const rte::ZenithGrid grid = rte::make_zenith_grid(
        rte::choose_discretisation(optics.stack, options, report_.streams).grid, report_.streams);
    rte::RequestedDirections requested;
    requested.mu =
        Eigen::Map<const Eigen::VectorXd>(nodes.data(), static_cast<Eigen::Index>(nodes.size()));
    for (int k = 0; k < static_cast<int>(nodes.size()); ++k) {
        requested.in.push_back(k);
        requested.out.push_back(k);
    }
    // At most as many orders as moments; so many samples in azimuth determine them exactly.
    const auto samples = static_cast<std::size_t>(std::max(2, scaled.moments));
    std::vector<double> azimuth_deg;
    for (std::size_t j = 0; j <= samples; ++j) {
        azimuth_deg.push_back(180.0 * static_cast<double>(j) / static_cast<double>(samples));
    }
    const rte::MultipleScattering multiple = rte::sum_fourier_orders(
        scaled, grid, requested, azimuth_deg, kFourierTailShare * options.tolerance, options);
    media_ = scaled.media;
    smooth_ = tabulate(multiple, samples);
    report_.fourier_orders = multiple.fourier_orders;
    report_.converged = report_.converged && multiple.converged && multiple.physical;
}

Direction WavelengthSolution::worst_direction() const {
    const std::size_t azimuths = probe_directions().azimuth_deg.size(),
                      outs = probe_directions().mu_out.size();
    const std::size_t pair = report_.worst_value / azimuths;
    return {probe_directions().mu_in[pair / outs], probe_directions().mu_out[pair % outs],
            probe_directions().azimuth_deg[report_.worst_value % azimuths]};
}

double WavelengthSolution::lobe(const Direction& direction) const {
    return lobe_ ? lobe_->brdf(direction.mu_in, direction.mu_out, direction.azimuth_deg) : 0.0;
}

double WavelengthSolution::transmitted(double mu_in, double mu_out) const {
    return lobe_ ? at_cosine(factor_in_, mu_in) * at_cosine(factor_out_, mu_out) : 1.0;
}

void add_smooth(const SmoothPart& smooth, std::span<const Direction> directions, double* values,
                std::size_t stride) {
    std::vector<double> series;
    smooth.series_at(directions[0].mu_in, directions[0].mu_out, series);
    for (std::size_t a = 0; a < directions.size(); ++a) {
        const double cos_azimuth = std::cos(directions[a].azimuth_deg * kPi / 180);
        values[a * stride] += cosine_sum(series, cos_azimuth) / kPi;
    }
}

}  // namespace miebrdf::exports
