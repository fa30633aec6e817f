#include "pipeline/exports/wavelength_solution.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>

#include "rte/discretisation.h"
#include "rte/layered_reflection.h"

namespace miebrdf::exports {
namespace {

constexpr double kPi = std::numbers::pi;
/// Stands for the horizon, where R itself has a limit but mu = 0 is no direction.
constexpr double kHorizon = 1e-9;
constexpr int kStencil = 6;
/// Narrow features closer to the horizon are those of this cosine.
constexpr double kLeastCosine = 1e-3;

double node_cosine(int k, int intervals) {
    const double sine = std::sin(kPi * k / (2.0 * intervals));
    return k == intervals ? 1.0 : std::max(sine * sine, kHorizon);
}

/// Lagrange weights of six neighbouring nodes.
struct Stencil {
    std::size_t first = 0;
    double weight[kStencil] = {};

    double of(const std::vector<double>& values) const {
        double sum = 0.0;
        for (int j = 0; j < kStencil; ++j)
            sum += weight[j] * values[first + static_cast<std::size_t>(j)];
        return sum;
    }
};

Stencil stencil_at(double mu, int intervals) {
    const double x = 2.0 / kPi * std::asin(std::sqrt(std::clamp(mu, 0.0, 1.0))) * intervals;
    const int first =
        std::clamp(static_cast<int>(x) - kStencil / 2 + 1, 0, intervals + 1 - kStencil);
    Stencil stencil;
    stencil.first = static_cast<std::size_t>(first);
    // Rounding of sin and asin must not turn a node into something between nodes.
    const double nearest = std::round(x);
    const double t = (std::abs(x - nearest) < 1e-11 * intervals ? nearest : x) - first;
    for (int j = 0; j < kStencil; ++j) {
        double weight = 1.0;
        for (int i = 0; i < kStencil; ++i) {
            if (i != j) weight *= (t - i) / (j - i);
        }
        stencil.weight[j] = weight;
    }
    return stencil;
}

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

/// sum a_m cos(m azimuth) by Clenshaw's recurrence.
double cosine_sum(const std::vector<double>& a, double cos_azimuth) {
    double next = 0.0, after = 0.0;
    for (std::size_t m = a.size() - 1; m > 0; --m) {
        const double current = a[m] + 2.0 * cos_azimuth * next - after;
        after = next;
        next = current;
    }
    return a[0] + cos_azimuth * next - after;
}

}  // namespace

WavelengthSolution::WavelengthSolution(const SceneOptics& optics,
                                       std::optional<std::complex<double>> surface_index,
                                       const Request& request, Component component)
    : component_(component), exact_first_order_(request.solver.single_scattering_correction) {
    if (component_ != Component::surface) solve(optics, request);
    if (surface_index && component_ != Component::subsurface) {
        lobe_.emplace(*surface_index, *request.scene.surface);
        const rte::SurfaceTransmission transmission(*lobe_, request.scene.coupling);
        for (int k = 0; k <= kIntervals; ++k) {
            factor_in_.push_back(transmission.in(node_cosine(k, kIntervals)));
            factor_out_.push_back(transmission.out(node_cosine(k, kIntervals)));
        }
    }
}

void WavelengthSolution::solve(const SceneOptics& optics, const Request& request) {
    std::vector<double> nodes;
    for (int k = 0; k <= kIntervals; ++k) nodes.push_back(node_cosine(k, kIntervals));
    // The solver chooses streams and moments where everything shows: at directions of all kinds.
    const rte::Directions probe{
        {0.05, 0.3, 0.6, 1.0}, {0.05, 0.2, 0.5, 0.8, 1.0}, {0, 45, 90, 135, 180}};
    report_ = rte::reflect(optics.stack, probe, request.solver).report;

    rte::SolverOptions options = request.solver;
    options.streams = report_.streams;
    const rte::ScaledStack scaled =
        rte::scale_stack(optics.stack, report_.moments, options.delta_m);
    const rte::ZenithGrid grid = rte::make_zenith_grid(
        rte::choose_discretisation(optics.stack, options, report_.streams).grid, report_.streams);
    rte::RequestedDirections requested;
    requested.mu =
        Eigen::Map<const Eigen::VectorXd>(nodes.data(), static_cast<Eigen::Index>(nodes.size()));
    for (int k = 0; k <= kIntervals; ++k) {
        requested.in.push_back(k);
        requested.out.push_back(k);
    }
    // At most as many orders as moments; so many samples in azimuth determine them exactly.
    const auto samples = static_cast<std::size_t>(std::max(2, scaled.moments));
    std::vector<double> azimuth_deg;
    for (std::size_t j = 0; j <= samples; ++j) {
        azimuth_deg.push_back(180.0 * static_cast<double>(j) / static_cast<double>(samples));
    }
    const rte::MultipleScattering multiple =
        rte::sum_orders(scaled, grid, requested, azimuth_deg, 0.1 * options.tolerance, options);
    media_ = scaled.media;
    if (exact_first_order_) {
        narrow_ = rte::NarrowFeatures(media_, kLeastCosine, 0.1 * options.tolerance);
        narrow_.tabulate();
    }
    orders_ = static_cast<std::size_t>(std::max(1, multiple.orders));
    modes_.resize(nodes.size() * nodes.size() * orders_);
    const Eigen::MatrixXd analysis = analysis_matrix(orders_, samples);
    for (std::size_t i = 0; i < nodes.size(); ++i) {
        for (std::size_t o = 0; o < nodes.size(); ++o) {
            const std::size_t pair = i * nodes.size() + o;
            const Eigen::Map<const Eigen::VectorXd> values(
                &multiple.reflection[pair * (samples + 1)], static_cast<Eigen::Index>(samples + 1));
            Eigen::Map<Eigen::VectorXd>(&modes_[pair * orders_],
                                        static_cast<Eigen::Index>(orders_)) =
                (nodes[i] + nodes[o]) * (analysis * values);
        }
    }
    if (!multiple.physical) {
        std::fill(modes_.begin(), modes_.end(), std::numeric_limits<double>::quiet_NaN());
    }
    report_.azimuthal_orders = multiple.orders;
    report_.converged = report_.converged && multiple.converged && multiple.physical;
}

void WavelengthSolution::series_at(double mu_in, double mu_out, std::vector<double>& series) const {
    const Stencil in = stencil_at(mu_in, kIntervals), out = stencil_at(mu_out, kIntervals);
    series.assign(orders_, 0.0);
    for (int i = 0; i < kStencil; ++i) {
        for (int o = 0; o < kStencil; ++o) {
            const double weight = in.weight[i] * out.weight[o] / (mu_in + mu_out);
            if (weight == 0.0) continue;
            const std::size_t pair = (in.first + static_cast<std::size_t>(i)) * (kIntervals + 1) +
                                     out.first + static_cast<std::size_t>(o);
            const double* a = &modes_[pair * orders_];
            for (std::size_t m = 0; m < orders_; ++m) series[m] += weight * a[m];
        }
    }
}

std::size_t WavelengthSolution::same_pair(std::span<const Direction> directions) {
    const auto differs = [&](const Direction& d) {
        return d.mu_in != directions[0].mu_in || d.mu_out != directions[0].mu_out;
    };
    return static_cast<std::size_t>(std::find_if(directions.begin(), directions.end(), differs) -
                                    directions.begin());
}

void WavelengthSolution::add_layers(std::span<const Direction> directions, double* values,
                                    std::size_t stride) const {
    const double mu_in = directions[0].mu_in, mu_out = directions[0].mu_out;
    std::vector<double> series;
    series_at(mu_in, mu_out, series);
    double transmitted = 1.0;
    if (lobe_) {
        transmitted = stencil_at(mu_in, kIntervals).of(factor_in_) *
                      stencil_at(mu_out, kIntervals).of(factor_out_);
    }
    std::vector<double> cos_azimuth;
    for (const Direction& d : directions)
        cos_azimuth.push_back(std::cos(d.azimuth_deg * kPi / 180));
    std::vector<double> narrow(directions.size(), 0.0);
    narrow_.add_to(narrow.data(), {&mu_in, 1}, {&mu_out, 1}, cos_azimuth);
    for (std::size_t a = 0; a < directions.size(); ++a) {
        const double reflection =
            cosine_sum(series, cos_azimuth[a]) + narrow[a] +
            rte::single_scattering(media_, exact_first_order_, mu_in, mu_out, cos_azimuth[a]);
        values[a * stride] += transmitted * reflection / kPi;
    }
}

void WavelengthSolution::evaluate(std::span<const Direction> directions, double* values,
                                  std::size_t stride) const {
    while (!directions.empty()) {
        const std::size_t count = same_pair(directions);
        for (std::size_t a = 0; a < count; ++a) {
            const Direction& d = directions[a];
            values[a * stride] = lobe_ ? lobe_->brdf(d.mu_in, d.mu_out, d.azimuth_deg) : 0.0;
        }
        if (component_ != Component::surface) add_layers(directions.first(count), values, stride);
        directions = directions.subspan(count);
        values += count * stride;
    }
}

}  // namespace miebrdf::exports
