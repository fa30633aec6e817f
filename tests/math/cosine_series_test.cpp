#include "rte/math/cosine_series.h"

#include <cmath>
#include <limits>
#include <random>
#include <vector>

#include "tests/support/catch.h"

using namespace miebrdf;

TEST_CASE("a cosine series has the value of its terms", "[math][cosine_series]") {
    const std::size_t orders = GENERATE(8u, 16u, 24u, 136u);
    std::mt19937 generator(1);
    std::uniform_real_distribution<double> any(-1.0, 1.0);
    std::vector<double> a(orders);
    for (double& coefficient : a) coefficient = any(generator);
    // Both ends and the middle too, where neighbouring terms cancel.
    for (const double azimuth : {0.0, 1e-3, 0.5, std::acos(0.0), 2.0, 3.1, std::acos(-1.0)}) {
        double sum = 0.0, size = 0.0;
        for (std::size_t m = 0; m < orders; ++m) {
            sum += a[m] * std::cos(double(m) * azimuth);
            size += std::abs(a[m]);
        }
        CAPTURE(orders, azimuth);
        // Rounding of cos(azimuth) moves the angle by as much over its sine, times the order;
        // Clenshaw's recurrence is no better near the ends.
        const double rounding = std::numeric_limits<double>::epsilon() * double(orders * orders);
        CHECK(std::abs(math::cosine_sum(a, std::cos(azimuth)) - sum) <= rounding * size);
    }
}

TEST_CASE("neighbouring series of a table are added up by their weights", "[math][cosine_series]") {
    constexpr std::size_t n = math::SeriesTable::kNeighbours, columns = n + 2;
    const std::size_t orders = GENERATE(8u, 16u, 40u), wanted = GENERATE(8u, 16u, 40u);
    if (wanted > orders) return;
    std::mt19937 generator(2);
    std::uniform_real_distribution<float> any(-1.0F, 1.0F);
    std::vector<float> table(n * columns * orders);
    for (float& value : table) value = any(generator);
    math::SeriesTable::Weights rows, along;
    for (std::size_t i = 0; i < n; ++i) {
        rows[i] = any(generator);
        along[i] = any(generator);
    }
    std::vector<double> found(wanted);
    math::SeriesTable{table.data() + orders, columns * orders, orders}.add_up(rows, along, found);
    for (std::size_t m = 0; m < wanted; ++m) {
        double sum = 0.0;
        for (std::size_t i = 0; i < n; ++i) {
            for (std::size_t j = 0; j < n; ++j)
                sum += double(rows[i]) * along[j] * table[(i * columns + 1 + j) * orders + m];
        }
        CAPTURE(orders, wanted, m);
        // 36 terms below 1 in single precision.
        CHECK(std::abs(found[m] - sum) <= 36 * std::numeric_limits<float>::epsilon());
    }
}
