#include "rte/half_space/kernels_side_by_side.h"

#include <algorithm>

#include "rte/fourier/fourier_mode.h"
#include "rte/math/matrices_side_by_side.h"

namespace miebrdf::rte {

#ifdef MIEBRDF_HAS_FOUR_DOUBLES

void KernelsSideBySide::set(const ZenithGrid& grid, const Eigen::VectorXd& requested, int degrees) {
    const auto alike = [](const Eigen::VectorXd& a, const Eigen::VectorXd& b) {
        return a.size() == b.size() && a == b;
    };
    if (degrees == degrees_ && alike(grid.mu, grid_.mu) && alike(grid.weights, grid_.weights) &&
        grid.panels == grid_.panels && alike(requested, requested_)) {
        return;
    }
    degrees_ = degrees;
    grid_ = grid;
    requested_ = requested;
    tables_.clear();
}

const double* KernelsSideBySide::table_of(int first, int orders,
                                          const RequestedDirections& requested,
                                          FourierModes& modes) {
    for (const Table& table : tables_)
        if (table.first == first && table.orders == orders) return table.values.data();
    constexpr Eigen::Index most = 1 << 18;
    const Eigen::Index size = Eigen::Index(rows()) * (degrees_ - first) * orders;
    const bool is_kept = Eigen::Index(tables_.size() + 1) * size <= most;
    if (is_kept) tables_.emplace_back();
    Table& table = is_kept ? tables_.back() : passing_;
    table.first = first;
    table.orders = orders;
    table.values.setZero(size);
    const auto put = [=](const auto& from, int order, double* to) {
        for (Eigen::Index k = 0; k < from.size(); ++k) to[k * orders + order] = from[k];
    };
    for (int m = first; m < std::min(degrees_, first + orders); ++m) {
        const FourierMode& mode = modes.find(m, degrees_, grid_, requested, !is_kept);
        for (Eigen::Index c = 0; c < mode.scaled_nodes.cols(); ++c) {
            double* column = table.values.data() + c * rows() * orders;
            put(mode.scaled_nodes.col(c), m - first, column);
            put(mode.at_requested.col(c), m - first, column + nodes() * orders);
        }
    }
    return table.values.data();
}

// Column c of the table belongs to the degree m + c of each order m.
template <typename Doubles>
void KernelsSideBySide::form(int first, const Eigen::VectorXd& strengths,
                             const RequestedDirections& requested, FourierModes& modes,
                             Doubles* even, Doubles* odd, Doubles* memory) {
    constexpr int orders = math::kLanes<Doubles>;
    const auto* table = reinterpret_cast<const Doubles*>(table_of(first, orders, requested, modes));
    const int n = nodes(), all = rows(), columns = degrees_ - first;
    // So many degrees that they stay in the cache next to the processor; eight orders of 20 nodes
    // do not fit in there whatever their number, and all degrees at once take 2 % less of the
    // whole.
    constexpr int numbers = orders > 4 ? 20480 : 2560;
    const int at_once = std::clamp(numbers / orders / (all + n), 1, all);
    for (const int parity : {0, 1}) {
        Doubles* kernel = parity == 0 ? even : odd;
        std::fill_n(kernel, all * n, Doubles{});
        for (int begin = parity; begin < columns; begin += 2 * at_once) {
            const int count = std::min(at_once, (columns - begin + 1) / 2);
            for (int k = 0; k < count; ++k) {
                const int c = begin + 2 * k;
                Doubles strength = {};
                for (int order = 0; order < orders && first + order + c < degrees_; ++order)
                    strength[order] = strengths[first + order + c];
                const Doubles* column = table + c * all;
                for (int p = 0; p < n; ++p) memory[p + k * n] = strength * column[p];
            }
            math::multiply_each<true, math::Part::lower>(
                {table + begin * all, 2 * all}, {memory, n, 1}, kernel, all, count, n, all);
        }
    }
}

template <typename Doubles>
void KernelsSideBySide::form_sides(Doubles* even, Doubles* odd, Doubles* same, Doubles* opposite,
                                   Doubles* same_rows, Doubles* opposite_rows) const {
    const int n = nodes(), all = rows();
    for (int q = 0; q < n; ++q) {
        Doubles *even_column = even + q * all, *odd_column = odd + q * all;
        for (int p = 0; p < q; ++p) {
            even_column[p] = even[q + p * all];
            odd_column[p] = odd[q + p * all];
        }
        for (int p = 0; p < n; ++p) {
            *same++ = even_column[p] + odd_column[p];
            *opposite++ = even_column[p] - odd_column[p];
        }
        for (int i = n; i < all; ++i) {
            *same_rows++ = even_column[i] + odd_column[i];
            *opposite_rows++ = even_column[i] - odd_column[i];
        }
    }
}

template void KernelsSideBySide::form(int, const Eigen::VectorXd&, const RequestedDirections&,
                                      FourierModes&, math::FourDoubles*, math::FourDoubles*,
                                      math::FourDoubles*);
template void KernelsSideBySide::form_sides(math::FourDoubles*, math::FourDoubles*,
                                            math::FourDoubles*, math::FourDoubles*,
                                            math::FourDoubles*, math::FourDoubles*) const;
#ifdef MIEBRDF_HAS_EIGHT_DOUBLES
template void KernelsSideBySide::form(int, const Eigen::VectorXd&, const RequestedDirections&,
                                      FourierModes&, math::EightDoubles*, math::EightDoubles*,
                                      math::EightDoubles*);
template void KernelsSideBySide::form_sides(math::EightDoubles*, math::EightDoubles*,
                                            math::EightDoubles*, math::EightDoubles*,
                                            math::EightDoubles*, math::EightDoubles*) const;
#endif

#endif

}  // namespace miebrdf::rte
