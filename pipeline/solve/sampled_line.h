// Functions of an ascending coordinate that are computed at some places and cubic between them.
#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <span>
#include <utility>
#include <vector>

namespace miebrdf {

/// Four neighbouring places of a line around one, and Lagrange's polynomials there with their
/// slopes: those whose weights have the least magnitudes, with which errors of values come through.
/// Lines of fewer places have polynomials of a lower degree.
struct CubicStencil {
    std::size_t first = 0, count = 0;
    std::array<double, 4> weight = {}, slope = {};
};

/// @param line  ascending, not empty
CubicStencil cubic_at(std::span<const double> line, double x);

/// What was computed of a line.
template <typename Value>
struct SampledLine {
    std::vector<std::size_t> places = {};  ///< of the line, ascending
    std::vector<Value> values = {};        ///< of each
    double misfit = 0.0;  ///< the largest between neighbours that were close enough
};

/// Computes the first places, then halves every gap in whose middle the cubic through the places
/// around it misses. A cubic may meet a value by chance: half of what it misses in the two gaps
/// beside counts, too.
///
/// @param line  ascending; where all gaps are halved, all of it is computed
/// @param first  places, ascending, the first and the last of the line among them
/// @param compute  values at places: std::vector<Value>(const std::vector<std::size_t>&)
/// @param misfit  how far a computed value is off the cubic, above 1 too far:
///        double(const CubicStencil&, std::span<const std::size_t> places, std::span<const Value>,
///        place, const Value& computed), of the stencil's places and values there
template <typename Value, typename Compute, typename Misfit>
SampledLine<Value> sample_line(std::span<const double> line, std::vector<std::size_t> first,
                               const Compute& compute, const Misfit& misfit) {
    SampledLine<Value> all;
    all.values = compute(first);
    all.places = std::move(first);
    std::vector<char> is_open(all.places.size(), 1);  // the gap behind each
    while (true) {
        std::vector<std::size_t> behind, middles;
        std::vector<double> known;
        for (const std::size_t place : all.places) known.push_back(line[place]);
        for (std::size_t i = 0; i + 1 < all.places.size(); ++i) {
            const std::size_t low = all.places[i], high = all.places[i + 1];
            if (!is_open[i] || high - low < 2) continue;
            const double half = 0.5 * (known[i] + known[i + 1]);
            const auto above =
                std::size_t(std::lower_bound(line.begin() + std::ptrdiff_t(low),
                                             line.begin() + std::ptrdiff_t(high), half) -
                            line.begin());
            middles.push_back(std::clamp(above, low + 1, high - 1));
            behind.push_back(i);
        }
        if (middles.empty()) return all;
        std::vector<Value> fresh = compute(middles);
        std::vector<double> misfits;
        for (std::size_t k = 0; k < middles.size(); ++k) {
            const CubicStencil stencil = cubic_at(known, line[middles[k]]);
            const auto around = [&](const auto& all_of) {
                return std::span(all_of).subspan(stencil.first, stencil.count);
            };
            misfits.push_back(misfit(stencil, around(std::as_const(all.places)),
                                     around(std::as_const(all.values)), middles[k], fresh[k]));
        }
        std::vector<std::size_t> places;
        std::vector<Value> values;
        std::vector<char> open;
        std::size_t k = 0;
        for (std::size_t i = 0; i < all.places.size(); ++i) {
            places.push_back(all.places[i]);
            values.push_back(std::move(all.values[i]));
            open.push_back(0);
            if (k == behind.size() || behind[k] != i) continue;
            double largest = misfits[k];
            if (k > 0 && behind[k - 1] + 1 == i) largest = std::max(largest, 0.5 * misfits[k - 1]);
            if (k + 1 < behind.size() && behind[k + 1] == i + 1)
                largest = std::max(largest, 0.5 * misfits[k + 1]);
            const bool is_good = largest <= 1.0;
            if (is_good) all.misfit = std::max(all.misfit, largest);
            open.back() = is_good ? 0 : 1;
            places.push_back(middles[k]);
            values.push_back(std::move(fresh[k]));
            open.push_back(open.back());
            ++k;
        }
        all.places = std::move(places);
        all.values = std::move(values);
        is_open = std::move(open);
    }
}

}  // namespace miebrdf
