#include "pipeline/sweep/lookup.h"

#include <fmt/format.h>
#include <fmt/ranges.h>
#include <miebrdf/error.h>

#include <algorithm>
#include <cmath>
#include <limits>

#include "pipeline/scene/number_list.h"

namespace miebrdf::sweep {
namespace {

/// Weights of an axis; of one that is listed, every node stands for itself.
struct AxisWeights {
    NodeWeights nodes;
    bool is_listed = false;
    bool error_is_known = true;
};

/// Lagrange's weights at x of the nodes from `first` on.
std::vector<double> lagrange(const std::vector<double>& nodes, std::size_t first, std::size_t count,
                             double x) {
    std::vector<double> weights(count, 1.0);
    for (std::size_t i = 0; i < count; ++i) {
        for (std::size_t k = 0; k < count; ++k) {
            if (k != i)
                weights[i] *= (x - nodes[first + k]) / (nodes[first + i] - nodes[first + k]);
        }
    }
    return weights;
}

/// Weights of the term that the node `extra` adds to the polynomial, over the nodes from `from` on.
std::vector<double> next_term(const std::vector<double>& nodes, std::size_t from, std::size_t size,
                              std::size_t first, std::size_t count, std::size_t extra, double x) {
    double distances = 1.0;
    for (std::size_t k = first; k < first + count; ++k) distances *= x - nodes[k];
    std::vector<double> weights(size, 0.0);
    const auto is_node = [&](std::size_t i) {
        return i == extra || (i >= first && i < first + count);
    };
    for (std::size_t i = from; i < from + size; ++i) {
        if (!is_node(i)) continue;
        double weight = distances;
        for (std::size_t k = from; k < from + size; ++k) {
            if (is_node(k) && k != i) weight /= nodes[i] - nodes[k];
        }
        weights[i - from] = weight;
    }
    return weights;
}

std::size_t place_of_text(const StoredAxis& axis, const std::string& text) {
    const auto found = std::find(axis.texts.begin(), axis.texts.end(), text);
    if (found != axis.texts.end()) return std::size_t(found - axis.texts.begin());
    throw UsageError(fmt::format("{}: the table has no '{}'; it has: {}", axis.name, text,
                                 fmt::join(axis.texts, ", ")));
}

NodeWeights single_node(std::size_t place) { return {place, {1.0}, {}}; }

NodeWeights weights_of_number(const StoredAxis& axis, const std::string& text,
                              Interpolation order) {
    const double asked = parse_number(text, axis.name);
    const auto found = std::find(axis.numbers.begin(), axis.numbers.end(), asked);
    if (found != axis.numbers.end()) return single_node(std::size_t(found - axis.numbers.begin()));
    const auto [least, largest] = std::minmax_element(axis.numbers.begin(), axis.numbers.end());
    if (!(asked >= *least && asked <= *largest) || axis.is_sample) {
        throw UsageError(fmt::format("{}: {} is {}; allowed: {}{} to {}", axis.name, asked,
                                     axis.is_sample ? "no sample" : "outside of the table",
                                     axis.is_sample ? "whole numbers from " : "", *least,
                                     *largest));
    }
    if (!axis.is_logarithmic) return weights_between(axis.numbers, asked, order);
    std::vector<double> logarithms;
    for (const double number : axis.numbers) logarithms.push_back(std::log(number));
    return weights_between(logarithms, std::log(asked), order);
}

AxisWeights weights_of(const StoredAxis& axis, const std::map<std::string, std::string>& asked,
                       Interpolation order) {
    const auto value = asked.find(axis.name);
    if (value == asked.end()) return {{0, std::vector<double>(axis.size(), 1.0), {}}, true, true};
    if (!axis.texts.empty()) return {single_node(place_of_text(axis, value->second)), false, true};
    NodeWeights nodes = weights_of_number(axis, value->second, order);
    const bool is_known = nodes.weights.size() == 1 || !nodes.error_weights.empty();
    return {std::move(nodes), false, is_known};
}

/// The axis of this name, or the only one that begins with it.
std::string axis_named(const std::string& asked, const std::vector<std::string>& names) {
    std::vector<std::string> beginning;
    for (const std::string& name : names) {
        if (name == asked) return name;
        if (name.rfind(asked, 0) == 0) beginning.push_back(name);
    }
    if (beginning.size() == 1) return beginning.front();
    throw UsageError(
        fmt::format("the table has no axis '{}'; it has: {}", asked, fmt::join(names, ", ")));
}

/// A block of values, contracted with one list of weights for each axis; axes that are listed stay.
class Block {
  public:
    Block(std::vector<double> values, const std::vector<AxisWeights>& axes)
        : values_(std::move(values)), axes_(axes) {}

    std::vector<double> contract(const std::vector<const std::vector<double>*>& weights) const {
        std::size_t listed = 1;
        for (const AxisWeights& axis : axes_)
            listed *= axis.is_listed ? axis.nodes.weights.size() : 1;
        std::vector<double> sums(listed, 0.0);
        for (std::size_t i = 0; i < values_.size(); ++i) {
            std::size_t rest = i, place = 0, stride = 1;
            double weight = 1.0;
            for (std::size_t a = axes_.size(); a-- > 0;) {
                const std::size_t size = axes_[a].nodes.weights.size(), at = rest % size;
                rest /= size;
                weight *= (*weights[a])[at];
                if (!axes_[a].is_listed) continue;
                place += at * stride;
                stride *= size;
            }
            // A node that is left out may have failed.
            if (weight != 0.0) sums[place] += weight * values_[i];
        }
        return sums;
    }

    std::vector<double> values() const { return contract(weights_of_values()); }

    /// Sum over the axes of what their left-out nodes show, the larger one where there are two.
    std::vector<double> errors() const {
        std::vector<double> sums;
        for (std::size_t a = 0; a < axes_.size(); ++a) {
            std::vector<double> largest;
            for (const std::vector<double>& error : axes_[a].nodes.error_weights) {
                auto weights = weights_of_values();
                weights[a] = &error;
                std::vector<double> terms = contract(weights);
                largest.resize(terms.size(), 0.0);
                for (std::size_t i = 0; i < terms.size(); ++i) {
                    if (!(std::abs(terms[i]) <= largest[i])) largest[i] = std::abs(terms[i]);
                }
            }
            sums.resize(std::max(sums.size(), largest.size()), 0.0);
            for (std::size_t i = 0; i < largest.size(); ++i) sums[i] += largest[i];
        }
        return sums;
    }

  private:
    std::vector<const std::vector<double>*> weights_of_values() const {
        std::vector<const std::vector<double>*> weights;
        for (const AxisWeights& axis : axes_) weights.push_back(&axis.nodes.weights);
        return weights;
    }

    std::vector<double> values_;
    const std::vector<AxisWeights>& axes_;
};

}  // namespace

Interpolation parse_interpolation(const std::string& text) {
    if (text == "linear") return Interpolation::linear;
    if (text == "cubic") return Interpolation::cubic;
    throw UsageError(fmt::format("unknown interpolation '{}'; allowed: linear, cubic", text));
}

std::vector<std::string> axes_of_table(const StoredTable& table) {
    std::vector<std::string> names;
    for (const std::string& variable : table.variables()) {
        for (const StoredAxis& axis : table.axes_of(variable)) {
            if (std::find(names.begin(), names.end(), axis.name) == names.end())
                names.push_back(axis.name);
        }
    }
    return names;
}

std::map<std::string, std::string> named_values(const StoredTable& table,
                                                const std::map<std::string, std::string>& asked) {
    const std::vector<std::string> names = axes_of_table(table);
    std::map<std::string, std::string> values;
    for (const auto& [name, value] : asked) {
        const std::string axis = axis_named(name, names);
        if (!values.emplace(axis, value).second)
            throw UsageError(fmt::format("{}: given twice", axis));
    }
    return values;
}

std::vector<std::string> named_variables(const StoredTable& table,
                                         const std::vector<std::string>& names) {
    const std::vector<std::string> known = table.variables();
    for (const std::string& name : names) {
        if (std::find(known.begin(), known.end(), name) == known.end())
            throw UsageError(fmt::format("the table has no variable '{}'; it has: {}", name,
                                         fmt::join(known, ", ")));
    }
    return names.empty() ? known : names;
}

NodeWeights weights_between(const std::vector<double>& nodes, double x, Interpolation order) {
    const std::size_t n = nodes.size();
    const bool ascends = nodes.back() > nodes.front();
    std::size_t left = 0;  // x lies between nodes[left] and the next
    while (left + 2 < n && (ascends ? x >= nodes[left + 1] : x <= nodes[left + 1])) ++left;
    // One node at least stays outside, as a witness.
    const std::size_t count = order == Interpolation::cubic && n > 4 ? 4 : 2;
    const std::size_t before = count == 4 ? 1 : 0;
    const std::size_t first = std::min(left - std::min(left, before), n - count);
    const std::size_t from = first > 0 ? first - 1 : 0;
    const std::size_t end = std::min(first + count + 1, n);
    NodeWeights result{from, std::vector<double>(end - from, 0.0), {}};
    const std::vector<double> inner = lagrange(nodes, first, count, x);
    std::copy(inner.begin(), inner.end(), result.weights.begin() + std::ptrdiff_t(first - from));
    for (std::size_t extra = from; extra < end; ++extra) {
        if (extra < first || extra >= first + count)
            result.error_weights.push_back(
                next_term(nodes, from, end - from, first, count, extra, x));
    }
    return result;
}

LookedUp look_up(const StoredTable& table, const std::string& variable,
                 const std::map<std::string, std::string>& asked, Interpolation order) {
    LookedUp result{variable, table.unit_of(variable)};
    std::vector<AxisWeights> axes;
    std::vector<std::size_t> start, count;
    bool error_is_known = true;
    for (const StoredAxis& axis : table.axes_of(variable)) {
        axes.push_back(weights_of(axis, asked, order));
        start.push_back(axes.back().nodes.first);
        count.push_back(axes.back().nodes.weights.size());
        error_is_known = error_is_known && axes.back().error_is_known;
        if (axes.back().is_listed) result.listed.push_back(axis);
    }
    const Block block(table.read(variable, start, count), axes);
    result.values = block.values();
    result.errors = block.errors();
    result.errors.resize(result.values.size(), 0.0);
    if (!error_is_known)
        std::fill(result.errors.begin(), result.errors.end(),
                  std::numeric_limits<double>::quiet_NaN());
    return result;
}

}  // namespace miebrdf::sweep
