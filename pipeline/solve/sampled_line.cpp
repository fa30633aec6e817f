#include "pipeline/solve/sampled_line.h"

namespace miebrdf {
namespace {

CubicStencil stencil_of(std::span<const double> line, std::size_t first, std::size_t count,
                        double x) {
    CubicStencil s{first, count};
    for (std::size_t i = 0; i < count; ++i) {
        double product = 1.0, sum = 0.0;
        for (std::size_t j = 0; j < count; ++j) {
            if (j == i) continue;
            const double distance = line[first + i] - line[first + j];
            double others = 1.0 / distance;
            for (std::size_t k = 0; k < count; ++k) {
                if (k != i && k != j)
                    others *= (x - line[first + k]) / (line[first + i] - line[first + k]);
            }
            product *= (x - line[first + j]) / distance;
            sum += others;
        }
        s.weight[i] = product;
        s.slope[i] = sum;
    }
    return s;
}

}  // namespace

CubicStencil cubic_at(std::span<const double> line, double x) {
    const std::size_t count = std::min<std::size_t>(4, line.size());
    const auto above = std::size_t(std::upper_bound(line.begin(), line.end(), x) - line.begin());
    CubicStencil best;
    double least = INFINITY;
    for (std::size_t back = 1; back < std::max<std::size_t>(count, 2); ++back) {
        const CubicStencil one = stencil_of(
            line, std::min(above > back ? above - back : 0, line.size() - count), count, x);
        double sum = 0.0;
        for (const double weight : one.weight) sum += std::abs(weight);
        if (!(sum < least)) continue;
        least = sum;
        best = one;
    }
    return best;
}

}  // namespace miebrdf
