#include "pipeline/solve/sampled_line.h"

namespace miebrdf {

CubicStencil cubic_at(std::span<const double> line, double x) {
    CubicStencil s;
    s.count = std::min<std::size_t>(4, line.size());
    const auto above = std::size_t(std::upper_bound(line.begin(), line.end(), x) - line.begin());
    double least = INFINITY;
    for (std::size_t back = 1; back < std::max<std::size_t>(s.count, 2); ++back) {
        const std::size_t first = std::min(above > back ? above - back : 0, line.size() - s.count);
        const double span = line[first + s.count - 1] - line[first];
        // Of windows as wide as each other that in whose middle x lies.
        const double off = std::abs(line[first] + line[first + s.count - 1] - 2.0 * x);
        if (span + 1e-3 * off < least) {
            least = span + 1e-3 * off;
            s.first = first;
        }
    }
    for (std::size_t i = 0; i < s.count; ++i) {
        double product = 1.0, sum = 0.0;
        for (std::size_t j = 0; j < s.count; ++j) {
            if (j == i) continue;
            const double distance = line[s.first + i] - line[s.first + j];
            double others = 1.0 / distance;
            for (std::size_t k = 0; k < s.count; ++k) {
                if (k != i && k != j)
                    others *= (x - line[s.first + k]) / (line[s.first + i] - line[s.first + k]);
            }
            product *= (x - line[s.first + j]) / distance;
            sum += others;
        }
        s.weight[i] = product;
        s.slope[i] = sum;
    }
    return s;
}

}  // namespace miebrdf
