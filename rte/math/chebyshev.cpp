#include "rte/math/chebyshev.h"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <numeric>

namespace miebrdf::math {
namespace {

using std::numbers::pi;
constexpr int kNodes = AngleTable::kNodes;
constexpr int kFirstPanels = 48;
/// Cells for each panel at most: their indices take half of the memory of one function then.
constexpr std::size_t kMostCellsPerPanel = 8;
/// In t: what rounding may do to an angle at the border of two panels, where both are right.
constexpr double kBorder = 1e-9;

using NodeMatrix = Eigen::Matrix<double, kNodes, kNodes>;

// Row = node, column = degree: values at Chebyshev points times this are coefficients.
NodeMatrix make_analysis() {
    NodeMatrix analysis;
    for (int i = 0; i < kNodes; ++i) {
        for (int k = 0; k < kNodes; ++k) {
            analysis(i, k) = (k == 0 ? 1.0 : 2.0) / kNodes * std::cos(k * pi * (i + 0.5) / kNodes);
        }
    }
    return analysis;
}

double node_angle(double lower, double upper, int i) {
    const double t = std::cos(pi * (i + 0.5) / kNodes);
    return std::clamp(0.5 * (lower + upper) + 0.5 * (upper - lower) * t, 0.0, pi);
}

// Row = function, column = degree.
bool has_converged(const Eigen::MatrixXd& coefficients, const AngleTolerance& tolerance) {
    const Eigen::ArrayXd tail = coefficients.rightCols(2).cwiseAbs().rowwise().maxCoeff();
    const Eigen::ArrayXd largest = coefficients.cwiseAbs().rowwise().maxCoeff();
    return (tail <= tolerance.absolute + tolerance.relative * largest).all();
}

using ChebyshevValues = Eigen::Array<double, kNodes, 1>;

// Polynomials of all degrees at t, by products of lower ones (T_a T_b = (T_{a+b} + T_{a-b}) / 2):
// what is needed next is ready sooner than after steps of one degree.
ChebyshevValues chebyshev_values(double t) {
    static_assert(kNodes == 8);
    const double t2 = 2.0 * t * t - 1.0, t3 = 2.0 * t * t2 - t;
    const double t4 = 2.0 * t2 * t2 - 1.0, t5 = 2.0 * t2 * t3 - t;
    const double t6 = 2.0 * t3 * t3 - 1.0, t7 = 2.0 * t3 * t4 - t;
    ChebyshevValues values;
    values << 1.0, t, t2, t3, t4, t5, t6, t7;
    return values;
}

/// Functions that are summed in registers.
constexpr int kTogether = 4;

// Some neighbouring functions of `count`.
template <int n>
Eigen::Matrix<double, n, 1> sum_of(const ChebyshevValues& chebyshev, const double* coefficients,
                                   Eigen::Index count) {
    using Values = Eigen::Matrix<double, n, 1>;
    Values sum = Eigen::Map<const Values>(coefficients);
    for (int k = 1; k < kNodes; ++k)
        sum += chebyshev[k] * Eigen::Map<const Values>(coefficients + k * count);
    return sum;
}

}  // namespace

ChebyshevPoints::ChebyshevPoints(int count) : points_(count), factors_(count) {
    for (int j = 0; j < count; ++j) {
        const double angle = std::numbers::pi * (j + 0.5) / count;
        points_[j] = std::cos(angle);
        factors_[j] = (j % 2 ? -1.0 : 1.0) * std::sin(angle);
    }
}

Eigen::VectorXd ChebyshevPoints::weights(double t) const {
    Eigen::VectorXd weights(points_.size());
    for (Eigen::Index j = 0; j < points_.size(); ++j) {
        const double distance = t - points_[j];
        if (distance == 0.0) return Eigen::VectorXd::Unit(points_.size(), j);
        weights[j] = factors_[j] / distance;
    }
    return weights / weights.sum();
}

AngleTable::AngleTable(const Functions& functions, double narrowest,
                       const AngleTolerance& tolerance) {
    std::vector<Panel> panels = first_panels();
    while (!panels.empty()) panels = refine(panels, functions, narrowest, tolerance);
    sort_panels();
    index_panels();
}

std::vector<AngleTable::Panel> AngleTable::first_panels() const {
    std::vector<Panel> panels;
    panels.reserve(kFirstPanels);
    for (int p = 0; p < kFirstPanels; ++p) {
        panels.push_back({pi * p / kFirstPanels, pi * (p + 1) / kFirstPanels});
    }
    return panels;
}

std::vector<AngleTable::Panel> AngleTable::refine(const std::vector<Panel>& panels,
                                                  const Functions& functions, double narrowest,
                                                  const AngleTolerance& tolerance) {
    static const NodeMatrix analysis = make_analysis();
    Eigen::VectorXd angles(Eigen::Index(panels.size()) * kNodes);
    for (std::size_t p = 0; p < panels.size(); ++p) {
        for (int i = 0; i < kNodes; ++i) {
            angles[Eigen::Index(p) * kNodes + i] = node_angle(panels[p].lower, panels[p].upper, i);
        }
    }
    const Eigen::MatrixXd values = functions(angles);
    function_count_ = int(values.cols());
    std::vector<Panel> halves;
    for (std::size_t p = 0; p < panels.size(); ++p) {
        const auto [lower, upper] = panels[p];
        const Eigen::MatrixXd coefficients =
            values.middleRows(Eigen::Index(p) * kNodes, kNodes).transpose() * analysis;
        if (upper - lower <= narrowest || has_converged(coefficients, tolerance)) {
            panels_.push_back(panels[p]);
            coefficients_.insert(coefficients_.end(), coefficients.data(),
                                 coefficients.data() + coefficients.size());
        } else {
            const double middle = 0.5 * (lower + upper);
            halves.push_back({lower, middle});
            halves.push_back({middle, upper});
        }
    }
    return halves;
}

void AngleTable::sort_panels() {
    std::vector<std::size_t> order(panels_.size());
    std::iota(order.begin(), order.end(), std::size_t{0});
    std::sort(order.begin(), order.end(),
              [&](std::size_t a, std::size_t b) { return panels_[a].upper < panels_[b].upper; });
    std::vector<Panel> panels;
    std::vector<double> coefficients;
    coefficients.reserve(coefficients_.size());
    const auto size = std::ptrdiff_t(kNodes) * function_count_;
    for (const std::size_t p : order) {
        panels.push_back(panels_[p]);
        const auto own = coefficients_.begin() + std::ptrdiff_t(p) * size;
        coefficients.insert(coefficients.end(), own, own + size);
    }
    panels_ = std::move(panels);
    coefficients_ = std::move(coefficients);
}

void AngleTable::index_panels() {
    double narrowest = pi;
    for (const auto& [lower, upper] : panels_) {
        places_.push_back({0.5 * (lower + upper), 2.0 / (upper - lower)});
        narrowest = std::min(narrowest, upper - lower);
    }
    const auto cells =
        std::min(std::size_t(std::llround(pi / narrowest)), kMostCellsPerPanel * panels_.size());
    std::size_t panel = 0;
    for (std::size_t cell = 0; cell < cells; ++cell) {
        const double start = pi * double(cell) / double(cells) + kBorder * narrowest;
        while (panels_[panel].upper <= start) ++panel;
        first_of_cell_.push_back(std::uint32_t(panel));
    }
}

void AngleTable::evaluate(double angle, Eigen::Ref<Eigen::VectorXd> values) const {
    const auto cell = std::size_t(angle * (double(first_of_cell_.size()) / pi));
    std::size_t panel = first_of_cell_[std::min(cell, first_of_cell_.size() - 1)];
    const auto place = [&] { return (angle - places_[panel].middle) * places_[panel].scale; };
    double t = place();
    for (; t > 1.0 + kBorder && panel + 1 < places_.size(); t = place()) ++panel;
    const ChebyshevValues chebyshev = chebyshev_values(t);
    const Eigen::Index count = function_count_;
    const double* const coefficients = &coefficients_[panel * std::size_t(kNodes * count)];
    if (count == 1) {
        values[0] = (chebyshev * Eigen::Map<const ChebyshevValues>(coefficients)).sum();
        return;
    }
    Eigen::Index f = 0;
    for (; f + kTogether <= count; f += kTogether)
        values.segment<kTogether>(f) = sum_of<kTogether>(chebyshev, coefficients + f, count);
    for (; f < count; ++f) values[f] = sum_of<1>(chebyshev, coefficients + f, count)[0];
}

}  // namespace miebrdf::math
