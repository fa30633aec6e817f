#include "mie/ensemble/phase_table.h"

#include <algorithm>
#include <cmath>
#include <cstring>
#include <numbers>
#include <numeric>

#include <miebrdf/error.h>
#include "mie/ensemble/particle_ensemble.h"
#include "mie/sphere/vectors.h"
#include "rte/math/legendre.h"
#include "rte/math/quadrature.h"

namespace miebrdf::mie {
namespace {

constexpr int kNodes = PhaseTable::kPanelNodes;

// Weighted samples over positive cosines mu of P(mu) + P(-mu) and P(mu) - P(-mu): the sum of the
// first times P_l(mu) is 2 chi_l for even l, that of the second for odd l.
struct Samples {
    std::vector<double> mu, even, odd;
};

// P_{l+1} = forward mu P_l - back P_{l-1}
struct Recurrence {
    double forward, back;
};

std::vector<Recurrence> recurrence_up_to(int degree) {
    std::vector<Recurrence> recurrence;
    recurrence.reserve(degree + 1);
    for (int l = 0; l <= degree; ++l)
        recurrence.push_back({(2.0 * l + 1.0) / (l + 1.0), l / (l + 1.0)});
    return recurrence;
}

// Some samples in two registers: as many as hide how long a step of the recurrence takes.
struct SampleGroup {
    static constexpr int kCount = 2 * kVectorSize;
    struct Values {
        Vector first, second;

        MIEBRDF_VECTOR Values(const std::vector<double>& list, std::size_t from, std::size_t end) {
            double some[kCount] = {};
            std::copy(list.begin() + std::ptrdiff_t(from),
                      list.begin() + std::ptrdiff_t(std::min(from + kCount, end)), some);
            std::memcpy(&first, some, sizeof first);
            std::memcpy(&second, some + kVectorSize, sizeof second);
        }
        explicit Values(double value) : first(Vector{} + value), second(first) {}

        MIEBRDF_VECTOR void add_to(double* sum, const Values& weight) const {
            Vector before;
            std::memcpy(&before, sum, sizeof before);
            before += first * weight.first + second * weight.second;
            std::memcpy(sum, &before, sizeof before);
        }
        // In place of the degree before.
        MIEBRDF_VECTOR void step(const Recurrence& by, const Values& mu, const Values& here) {
            first = (by.forward * mu.first) * here.first - by.back * first;
            second = (by.forward * mu.second) * here.second - by.back * second;
        }
    };
};

// sum of samples times P_l(mu) over [first, end), l = 0 ... highest_moment.
std::vector<double> projected(const Samples& samples, std::size_t first_sample, std::size_t end,
                              const std::vector<Recurrence>& recurrence, int highest_moment) {
    using Values = SampleGroup::Values;
    // One degree more may be summed, which nobody asks for.
    std::vector<double> sums((highest_moment + 2) * kVectorSize, 0.0);
    for (std::size_t first = first_sample; first < end; first += SampleGroup::kCount) {
        const Values mu(samples.mu, first, end);
        const Values even(samples.even, first, end), odd(samples.odd, first, end);
        Values here(1.0), before(0.0);
        double* sum = sums.data();
        for (int l = 0; l <= highest_moment; l += 2, sum += 2 * kVectorSize) {
            here.add_to(sum, even);
            before.step(recurrence[l], mu, here);
            before.add_to(sum + kVectorSize, odd);
            here.step(recurrence[l + 1], mu, before);
        }
    }
    std::vector<double> projections;
    projections.reserve(highest_moment + 1);
    for (int l = 0; l <= highest_moment; ++l)
        projections.push_back(std::accumulate(sums.begin() + l * kVectorSize,
                                              sums.begin() + (l + 1) * kVectorSize, 0.0));
    return projections;
}

// From 0 to pi/2: edges of panels, and those from pi on as seen from there. Between two of them
// both P(theta) and P(pi - theta) are polynomials.
std::vector<double> edges_of_both_sides(const std::vector<double>& edges) {
    constexpr double end = 0.5 * std::numbers::pi, least = 1e-9;
    std::vector<double> all = {0, end};
    for (const double edge : edges) all.push_back(std::min(edge, std::numbers::pi - edge));
    std::sort(all.begin(), all.end());
    std::vector<double> apart = {0};
    for (const double edge : all) {
        if (edge > apart.back() + least) apart.push_back(edge);
    }
    return apart;
}

}  // namespace

double panel_value(const double* coefficients, double t) {
    double b1 = 0, b2 = 0;
    for (int k = kNodes - 1; k >= 1; --k) {
        const double b = coefficients[k] + 2 * t * b1 - b2;
        b2 = b1;
        b1 = b;
    }
    return coefficients[0] + t * b1 - b2;
}

std::vector<double> panel_nodes(double lower, double upper) {
    std::vector<double> nodes;
    for (int i = kNodes - 1; i >= 0; --i) {
        const double t = std::cos(std::numbers::pi * i / (kNodes - 1));
        nodes.push_back(0.5 * (lower + upper) + 0.5 * (upper - lower) * t);
    }
    nodes.front() = lower;
    nodes.back() = upper;
    return nodes;
}

Eigen::MatrixXd series_on_panels(std::span<const double> chi, const std::vector<double>& edges) {
    const auto panels = static_cast<Eigen::Index>(edges.size()) - 1;
    Eigen::VectorXd cosines(kNodes * panels);
    for (Eigen::Index panel = 0; panel < panels; ++panel) {
        const std::vector<double> nodes =
            panel_nodes(edges[std::size_t(panel)], edges[std::size_t(panel) + 1]);
        for (int i = 0; i < kNodes; ++i)
            cosines[panel * kNodes + i] = std::cos(nodes[std::size_t(i)]);
    }
    Eigen::MatrixXd weights(1, Eigen::Index(chi.size()));
    for (Eigen::Index l = 0; l < weights.cols(); ++l)
        weights(0, l) = (2.0 * double(l) + 1.0) * chi[std::size_t(l)];
    return math::legendre_sums(weights, cosines).reshaped(kNodes, panels);
}

// c_k = 2/N sum'' f_i cos(pi k i / N), N = kPanelNodes - 1; first and last terms, and c_0 and c_N,
// count half.
Eigen::VectorXd panel_coefficients(const Eigen::VectorXd& values) {
    constexpr int N = kNodes - 1;
    static const Eigen::MatrixXd of_values = [] {
        Eigen::MatrixXd of(kNodes, kNodes);
        for (int k = 0; k <= N; ++k) {
            for (int i = 0; i <= N; ++i) {
                const double halves = (i % N == 0 ? 0.5 : 1.0) * (k % N == 0 ? 0.5 : 1.0);
                of(k, N - i) = halves * 2 / N * std::cos(std::numbers::pi * k * i / N);
            }
        }
        return of;
    }();
    return of_values * values;
}

PhaseTable make_phase_table(PhaseTable::Parts parts, const Eigen::MatrixXd& values,
                            double least_noise) {
    parts.coefficients.clear();
    for (std::size_t p = 0; p < parts.noise.size(); ++p) {
        const double phase = values.col(Eigen::Index(p)).mean();
        parts.noise[p] =
            std::max(parts.noise[p], least_noise * phase / std::max(phase, parts.noise_floor));
    }
    for (Eigen::Index panel = 0; panel < values.cols(); ++panel) {
        const Eigen::VectorXd coefficients = panel_coefficients(values.col(panel));
        parts.coefficients.insert(parts.coefficients.end(), coefficients.begin(),
                                  coefficients.end());
    }
    const math::Quadrature rule = math::gauss_legendre(kNodes);
    double integral = 0;
    for (std::size_t p = 0; p + 1 < parts.edges.size(); ++p) {
        const double half = 0.5 * (parts.edges[p + 1] - parts.edges[p]);
        for (int i = 0; i < kNodes; ++i) {
            const double theta = parts.edges[p] + half * (1 + rule.nodes[i]);
            integral += half * rule.weights[i] * std::sin(theta) *
                        panel_value(&parts.coefficients[p * kNodes], rule.nodes[i]);
        }
    }
    parts.mean = 0.5 * integral;
    return PhaseTable(std::move(parts));
}

PhaseTable::PhaseTable(Parts parts) : parts_(std::move(parts)) {
    const std::size_t panels = parts_.edges.empty() ? 0 : parts_.edges.size() - 1;
    if (panels < 1 || parts_.coefficients.size() != kNodes * panels ||
        (!parts_.noise.empty() && parts_.noise.size() != panels) ||
        !std::is_sorted(parts_.edges.begin(), parts_.edges.end())) {
        throw UsageError("parts of a phase table that do not fit each other");
    }
}

std::size_t PhaseTable::panel_at(double theta) const {
    const auto above = std::upper_bound(parts_.edges.begin() + 1, parts_.edges.end() - 1, theta);
    return static_cast<std::size_t>(above - parts_.edges.begin()) - 1;
}

double PhaseTable::at_angle(double theta) const {
    const std::size_t panel = panel_at(theta);
    const double lower = parts_.edges[panel], upper = parts_.edges[panel + 1];
    const double t = (2 * theta - lower - upper) / (upper - lower);
    return panel_value(&parts_.coefficients[panel * kNodes], t);
}

double PhaseTable::operator()(double cos_theta) const {
    return at_angle(std::acos(std::clamp(cos_theta, -1.0, 1.0)));
}

double PhaseTable::noise(double cos_theta) const {
    if (parts_.noise.empty()) return 0;
    const double theta = std::acos(std::clamp(cos_theta, -1.0, 1.0));
    const std::size_t panel = panel_at(theta);
    const double of_sizes = parts_.noise[panel] * std::max(at_angle(theta), parts_.noise_floor);
    // The last two coefficients bound what interpolation leaves out; noise is in them, too, but
    // averages without ripple have hardly any.
    const double* coefficients = &parts_.coefficients[panel * kNodes];
    const double tail = std::abs(coefficients[kNodes - 2]) + std::abs(coefficients[kNodes - 1]);
    return std::max(of_sizes, 0.5 * tail);
}

std::vector<double> PhaseTable::moments(int highest_moment, const Executor& run) const {
    // Each polynomial in pieces of 16 Gauss nodes: those integrate P (degree 7) times a wave of up
    // to 2 rad per node to rounding.
    constexpr int kPieceNodes = 16;
    const math::Quadrature rule = math::gauss_legendre(kPieceNodes);
    const std::vector<double> edges = edges_of_both_sides(parts_.edges);
    Samples samples;
    for (std::size_t p = 0; p + 1 < edges.size(); ++p) {
        const double width = edges[p + 1] - edges[p];
        const int pieces =
            static_cast<int>(std::ceil(width * highest_moment / (2.0 * kPieceNodes) + 0.5));
        for (int piece = 0; piece < pieces; ++piece) {
            const double half = 0.5 * width / pieces;
            const double centre = edges[p] + half * (2 * piece + 1);
            for (int i = 0; i < kPieceNodes; ++i) {
                const double theta = centre + half * rule.nodes[i];
                const double weight = half * rule.weights[i] * std::sin(theta);
                const double forward = at_angle(theta);
                const double backward = at_angle(std::numbers::pi - theta);
                samples.mu.push_back(std::cos(theta));
                samples.even.push_back(weight * (forward + backward));
                samples.odd.push_back(weight * (forward - backward));
            }
        }
    }
    constexpr int kJobs = 8;
    const std::vector<Recurrence> recurrence = recurrence_up_to(highest_moment + 1);
    std::vector<std::vector<double>> parts(kJobs);
    const std::size_t share = (samples.mu.size() + kJobs - 1) / kJobs;
    run(kJobs, [&](int job) {
        const std::size_t first = std::min(samples.mu.size(), job * share);
        parts[job] = projected(samples, first, std::min(samples.mu.size(), first + share),
                               recurrence, highest_moment);
    });
    std::vector<double> chi(highest_moment + 1, 0.0);
    for (const auto& part : parts) {
        for (int l = 0; l <= highest_moment; ++l) chi[l] += 0.5 * part[l];
    }
    return chi;
}

double noise_around(double lower, double upper, const Eigen::ArrayXd& noise,
                    const Eigen::ArrayXd& angles, double half_period) {
    const double reach = kNoiseReach * half_period;
    // Straight back all degrees add up in step: the noise is largest there, and only there.
    const bool is_backward = upper > AverageLimits::kBackward;
    double squares = 0, largest = 0;
    int count = 0;
    for (Eigen::Index k = 0; k < noise.size(); ++k) {
        if (!(angles[k] >= lower - reach && angles[k] <= upper + reach)) continue;
        squares += noise[k] * noise[k];
        largest = std::max(largest, std::abs(noise[k]));
        ++count;
    }
    return is_backward ? largest : std::sqrt(squares / std::max(count, 1));
}

PhaseTable table_of_series(const std::vector<double>& chi, const Eigen::ArrayXd& noise,
                           const Eigen::ArrayXd& angles, double floor, double tolerance) {
    // One panel for half a period of the fastest wave: eight nodes leave 1e-6 of it.
    const double width = std::numbers::pi / double(chi.size());
    PhaseTable::Parts parts;
    for (std::size_t p = 0; p < chi.size(); ++p) parts.edges.push_back(double(p) * width);
    parts.edges.push_back(std::numbers::pi);
    const Eigen::MatrixXd values = series_on_panels(chi, parts.edges);
    for (std::size_t p = 0; p < chi.size() && noise.size() > 0; ++p) {
        parts.noise.push_back(
            noise_around(parts.edges[p], parts.edges[p + 1], noise, angles, width));
        parts.size_error = std::max(parts.size_error, parts.noise.back());
    }
    parts.noise_floor = floor;
    parts.gave_moments = true;
    return make_phase_table(std::move(parts), values, stated_error(0, tolerance));
}

}  // namespace miebrdf::mie
