#include "rte/math/chebyshev.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>
#include <numeric>

namespace miebrdf::math {
namespace {

using std::numbers::pi;
constexpr int kNodes = AngleTable::kNodes;
constexpr int kFirstPanels = 48;

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
            lower_.push_back(lower);
            upper_.push_back(upper);
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
    std::vector<std::size_t> order(upper_.size());
    std::iota(order.begin(), order.end(), std::size_t{0});
    std::sort(order.begin(), order.end(),
              [&](std::size_t a, std::size_t b) { return upper_[a] < upper_[b]; });
    std::vector<double> lower, upper;
    std::vector<double> coefficients;
    coefficients.reserve(coefficients_.size());
    const auto size = std::ptrdiff_t(kNodes) * function_count_;
    for (const std::size_t p : order) {
        lower.push_back(lower_[p]);
        upper.push_back(upper_[p]);
        const auto own = coefficients_.begin() + std::ptrdiff_t(p) * size;
        coefficients.insert(coefficients.end(), own, own + size);
    }
    lower_ = std::move(lower);
    upper_ = std::move(upper);
    coefficients_ = std::move(coefficients);
}

void AngleTable::index_panels() {
    first_of_cell_.resize(upper_.size());
    std::size_t panel = 0;
    for (std::size_t cell = 0; cell < upper_.size(); ++cell) {
        const double start = pi * double(cell) / double(upper_.size());
        while (upper_[panel] <= start) ++panel;
        first_of_cell_[cell] = std::uint32_t(panel);
    }
}

void AngleTable::evaluate(double angle, Eigen::Ref<Eigen::VectorXd> values) const {
    const auto cell = std::size_t(angle * (double(upper_.size()) / pi));
    std::size_t panel = first_of_cell_[std::min(cell, upper_.size() - 1)];
    while (panel > 0 && lower_[panel] > angle) --panel;  // rounding, at the border of two cells
    while (panel + 1 < upper_.size() && upper_[panel] < angle) ++panel;
    const double t =
        (2.0 * angle - lower_[panel] - upper_[panel]) / (upper_[panel] - lower_[panel]);
    std::array<double, kNodes> chebyshev = {1.0, t};
    for (std::size_t k = 2; k < kNodes; ++k)
        chebyshev[k] = 2.0 * t * chebyshev[k - 1] - chebyshev[k - 2];
    const auto count = std::size_t(function_count_);
    const double* coefficients = &coefficients_[panel * kNodes * count];
    double* const sums = values.data();
    for (std::size_t f = 0; f < count; ++f) sums[f] = coefficients[f];
    for (std::size_t k = 1; k < kNodes; ++k) {
        coefficients += count;
        for (std::size_t f = 0; f < count; ++f) sums[f] += chebyshev[k] * coefficients[f];
    }
}

}  // namespace miebrdf::math
