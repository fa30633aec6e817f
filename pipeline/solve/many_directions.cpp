// for_many_directions: a solved table whose azimuthal series hold light scattered once as well.
#include <Eigen/Core>
#include <algorithm>
#include <array>
#include <cmath>

#include "pipeline/solve/parallel.h"
#include "pipeline/solve/solved_table.h"

namespace miebrdf {
namespace {

/// (Error of the series) / (the largest value at the incidence) is at most this x the tolerance.
constexpr double kSeriesShare = 0.1;
/// Series are made from samples at azimuths 180 j / n degrees, j = 0 ... n, for the first n that is
/// enough (samples_to_orders).
constexpr std::array<int, 3> kIntervals = {32, 64, 128};

/// R of light scattered once, without the surface: row = wavelength, column = azimuth.
Eigen::MatrixXd scattered_once(const SharpPart& part, double mu_in, double mu_out,
                               std::span<const double> cos_azimuth,
                               rte::SpectralFirstOrder::Scratch& scratch) {
    Eigen::MatrixXd values(Eigen::Index(part.wavelengths()), Eigen::Index(cos_azimuth.size()));
    part.first_order().evaluate(mu_in, mu_out, cos_azimuth,
                                {values.data(), std::size_t(values.size())}, scratch);
    return values;
}

/// The first of kIntervals whose orders are enough at some pairs of cosines; 0: none is.
int intervals_for(const SharpPart& part, double tolerance) {
    constexpr int n = kIntervals.back();
    const Eigen::MatrixXd to_orders = samples_to_orders(n);
    const std::vector<double> cos_azimuth = cosines_of_azimuths(n);
    rte::SpectralFirstOrder::Scratch scratch;
    std::vector<double> smooth;
    int needed = 0;
    for (const double mu_in : {1e-3, 0.1, 0.3, 0.6, 0.9}) {
        for (const double mu_out : {1e-3, 0.1, 0.3, 0.6, 0.9}) {
            const Eigen::MatrixXd orders =
                scattered_once(part, mu_in, mu_out, cos_azimuth, scratch) * to_orders;
            for (Eigen::Index w = 0; w < orders.rows(); ++w) {
                part.wavelength(std::size_t(w)).smooth().series_at(mu_in, mu_out, smooth);
                const double allowed =
                    kSeriesShare * tolerance * (std::abs(orders(w, 0)) + std::abs(smooth[0]));
                double tail = 0.0;
                int count = int(orders.cols());
                while (count > 0 && tail + std::abs(orders(w, count - 1)) <= allowed)
                    tail += std::abs(orders(w, --count));
                needed = std::max(needed, count);
            }
        }
    }
    for (const int intervals : kIntervals) {
        if (needed < resolved_orders(intervals)) return intervals;
    }
    return 0;
}

/// Series of light scattered once that the surface lets through, by wavelength.
std::vector<SmoothPart> series_of(const SharpPart& part, int n, const Control& control) {
    const std::vector<double>& nodes = SmoothPart::nodes();
    const std::size_t orders = std::size_t(resolved_orders(n)), count = nodes.size();
    const Eigen::MatrixXd to_orders = samples_to_orders(n);
    const std::vector<double> cos_azimuth = cosines_of_azimuths(n);
    std::vector<std::vector<double>> modes(part.wavelengths());
    for (auto& of_wavelength : modes) of_wavelength.resize(count * count * orders);
    run_parallel("light scattered once", count, control, [&](std::size_t i) {
        rte::SpectralFirstOrder::Scratch scratch;
        for (std::size_t o = i; o < count; ++o) {  // without the surface R is reciprocal
            const Eigen::MatrixXd series =
                scattered_once(part, nodes[i], nodes[o], cos_azimuth, scratch) * to_orders *
                (nodes[i] + nodes[o]);
            for (std::size_t w = 0; w < modes.size(); ++w) {
                const SolvedWavelength& at = part.wavelength(w);
                const double there = at.transmitted(nodes[i], nodes[o]);
                const double back = at.transmitted(nodes[o], nodes[i]);
                for (std::size_t m = 0; m < orders; ++m) {
                    const double a = series(Eigen::Index(w), Eigen::Index(m));
                    modes[w][(i * count + o) * orders + m] = there * a;
                    modes[w][(o * count + i) * orders + m] = back * a;
                }
            }
        }
    });
    std::vector<SmoothPart> parts;
    parts.reserve(modes.size());
    for (const auto& of_wavelength : modes) parts.emplace_back(of_wavelength, orders);
    return parts;
}

/// Whether the series agree with exact values halfway between the nodes, where interpolation is
/// worst, from retro-reflection to the horizon.
bool are_accurate(const std::vector<SmoothPart>& series, const SharpPart& part, double tolerance,
                  const Control& control) {
    const std::size_t steps = SmoothPart::nodes().size() - 1;
    // Below the second node values are exact (SolvedTable::instead).
    constexpr std::array<std::size_t, 11> kIncidences = {1, 2, 4, 8, 13, 19, 26, 33, 40, 45, 47};
    constexpr int kAzimuths = 15;  // divides none of kIntervals
    const std::vector<double> cos_azimuth = cosines_of_azimuths(kAzimuths);
    const auto halfway = [&](std::size_t k) {
        return half_sine((double(k) + 0.5) / double(steps));
    };
    std::array<char, kIncidences.size()> good = {};
    run_parallel("light scattered once", good.size(), control, [&](std::size_t i) {
        rte::SpectralFirstOrder::Scratch scratch;
        Eigen::ArrayXd error = Eigen::ArrayXd::Zero(Eigen::Index(series.size())), largest = error;
        std::vector<double> of_series, smooth;
        const double mu_in = halfway(kIncidences[i]);
        for (std::size_t o = 0; o < steps; ++o) {
            const double mu_out = halfway(o);
            const Eigen::MatrixXd once = scattered_once(part, mu_in, mu_out, cos_azimuth, scratch);
            for (std::size_t w = 0; w < series.size(); ++w) {
                const SolvedWavelength& at = part.wavelength(w);
                const double surface = at.transmitted(mu_in, mu_out);
                series[w].series_at(mu_in, mu_out, of_series);
                at.smooth().series_at(mu_in, mu_out, smooth);
                const auto row = Eigen::Index(w);
                for (std::size_t a = 0; a < cos_azimuth.size(); ++a) {
                    const double exact = surface * once(row, Eigen::Index(a));
                    const double missed = math::cosine_sum(of_series, cos_azimuth[a]) - exact;
                    const double all = exact + math::cosine_sum(smooth, cos_azimuth[a]);
                    // std::max would lose NaN.
                    if (!(std::abs(missed) <= error[row])) error[row] = std::abs(missed);
                    largest[row] = std::max(largest[row], std::abs(all));
                }
            }
        }
        good[i] = char((error <= kSeriesShare * tolerance * largest).all());
    });
    return std::all_of(good.begin(), good.end(), [](char one) { return one != 0; });
}

}  // namespace

SolvedTable::SolvedTable(const BrdfTable& whole, const Control& control)
    : scene(whole.solved().scene),
      solver(whole.solved().solver),
      part(whole.solved().part),
      channels(whole.solved().channels),
      provenance(whole.solved().provenance),
      wavelengths(whole.solved().wavelengths),
      components(whole.solved().components),
      report(whole.solved().report),
      exact(whole) {
    std::size_t first = 0;
    sharp.reserve(whole.solved().sharp.size());
    for (const SharpPart& one : whole.solved().sharp) {
        const int intervals = intervals_for(one, solver.tolerance);
        std::vector<SmoothPart> series;
        if (intervals > 0) series = series_of(one, intervals, control);
        const bool is_smooth =
            intervals > 0 && are_accurate(series, one, solver.tolerance, control);
        for (std::size_t w = 0; is_smooth && w < series.size(); ++w)
            wavelengths[first + w].add_smooth(series[w]);
        sharp.emplace_back(one, std::span(wavelengths).subspan(first, one.wavelengths()),
                           is_smooth);
        first += one.wavelengths();
    }
}

BrdfTable for_many_directions(const BrdfTable& exact, const Control& control) {
    if (exact.solved().exact || exact.solved().part == BrdfPart::surface) return exact;
    return BrdfTable(std::make_shared<const SolvedTable>(exact, control));
}

}  // namespace miebrdf
