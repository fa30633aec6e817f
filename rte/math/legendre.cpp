#include "rte/math/legendre.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <utility>
#include <vector>

#include <miebrdf/error.h>

namespace miebrdf::math {
namespace {

double power(double x, int exponent) {
    double result = 1.0;
    for (; exponent > 0; exponent /= 2, x *= x) {
        if (exponent % 2 == 1) result *= x;
    }
    return result;
}

// Y_m^m = prod_{i<=m} sqrt((2i-1)/(2i)) (1-mu^2)^{m/2}; the product stays above 0.01 for any m in
// use, and the power may underflow to zero, which is then its value.
template <typename Column>
void fill_first(int m, const Eigen::Ref<const Eigen::VectorXd>& mu, Column column) {
    double product = 1.0;
    for (int i = 1; i <= m; ++i) product *= (2.0 * i - 1.0) / (2.0 * i);
    product = std::sqrt(product);
    for (Eigen::Index p = 0; p < mu.size(); ++p) {
        const double sine_squared = (1.0 - mu[p]) * (1.0 + mu[p]);
        const double sine = m % 2 == 1 ? std::sqrt(sine_squared) : 1.0;
        column[p] = product * sine * power(sine_squared, m / 2);
    }
}

}  // namespace

void legendre_functions(int order, int degrees, const Eigen::Ref<const Eigen::VectorXd>& mu,
                        Eigen::MatrixXd& table) {
    if (!(order >= 0 && degrees > order)) {
        throw UsageError("order", fmt::format("{} of {} degrees", order, degrees),
                         "0 or more, and below the number of degrees");
    }
    const int m = order;
    table.resize(mu.size(), degrees - m);
    fill_first(m, mu, table.col(0));
    if (degrees == m + 1) return;
    double root = std::sqrt(2.0 * m + 1.0);  // sqrt((l+1)^2 - m^2)
    table.col(1) = root * mu.cwiseProduct(table.col(0));
    for (int l = m + 1; l + 1 < degrees; ++l) {
        const double lower = root;
        root = std::sqrt((l + 1.0 - m) * (l + 1.0 + m));
        const double next = 1.0 / root, here = (2.0 * l + 1.0) * next, previous = lower * next;
        const auto column = l - m;
        table.col(column + 1) =
            here * mu.cwiseProduct(table.col(column)) - previous * table.col(column - 1);
    }
}

double legendre_series(std::span<const double> chi, double x) {
    // b_l = beta_l + (2l+1)/(l+1) x b_{l+1} - (l+1)/(l+2) b_{l+2}; the sum is b_0.
    double b_next = 0.0;
    double b_after = 0.0;
    for (std::size_t i = chi.size(); i-- > 0;) {
        const double l = static_cast<double>(i);
        const double b =
            (2.0 * l + 1.0) * (chi[i] + x * b_next / (l + 1.0)) - (l + 1.0) / (l + 2.0) * b_after;
        b_after = b_next;
        b_next = b;
    }
    return b_next;
}

namespace {

#if defined(__AVX512F__)
constexpr int kArgumentsInRegister = 8,
              kMostFunctions = 12;  // two registers of arguments for each function
#elif defined(__AVX__)
constexpr int kArgumentsInRegister = 4, kMostFunctions = 5;
#else
constexpr int kArgumentsInRegister = 2, kMostFunctions = 5;
#endif
typedef double Arguments __attribute__((vector_size(kArgumentsInRegister * sizeof(double))));
constexpr int kArguments = 2 * kArgumentsInRegister;  // at a time

struct Recurrence {
    double forward, back;  // P_{l+1} = forward x P_l - back P_{l-1}
};

// Some neighbouring functions.
// sums: [function * kArguments + argument]
template <int functions>
void sum_some(const Eigen::MatrixXd& weights, Eigen::Index first,
              std::span<const Recurrence> recurrence, const double* x, double* sums) {
    Arguments argument[2], here[2], before[2] = {}, sum[functions][2] = {};
    for (int i = 0; i < kArguments; ++i)
        argument[i / kArgumentsInRegister][i % kArgumentsInRegister] = x[i];
    here[0] = here[1] = Arguments{} + 1.0;
    const double* weight = weights.data() + first;
    for (const auto& [forward, back] : recurrence) {
        for (int j = 0; j < functions; ++j) {
            sum[j][0] += weight[j] * here[0];
            sum[j][1] += weight[j] * here[1];
        }
        for (int half = 0; half < 2; ++half) {
            const Arguments next = (forward * argument[half]) * here[half] - back * before[half];
            before[half] = here[half];
            here[half] = next;
        }
        weight += weights.rows();
    }
    for (int j = 0; j < functions; ++j)
        for (int i = 0; i < kArguments; ++i)
            *sums++ = sum[j][i / kArgumentsInRegister][i % kArgumentsInRegister];
}

using SumSome = void (*)(const Eigen::MatrixXd&, Eigen::Index, std::span<const Recurrence>,
                         const double*, double*);

// Neighbouring functions, and how many degrees they have.
struct FunctionGroup {
    Eigen::Index first, count, degrees;
};

// As many in each as registers hold, but equally many: few take nearly as long as several. Those of
// far fewer degrees than the ones before them are apart.
std::vector<FunctionGroup> grouped(const Eigen::MatrixXd& weights) {
    std::vector<Eigen::Index> degrees(std::size_t(weights.rows()), weights.cols());
    for (Eigen::Index j = 0; j < weights.rows(); ++j) {
        Eigen::Index& of_function = degrees[std::size_t(j)];
        while (of_function > 0 && weights(j, of_function - 1) == 0.0) --of_function;
    }
    std::vector<FunctionGroup> groups;
    for (Eigen::Index first = 0, end; first < weights.rows(); first = end) {
        Eigen::Index most = degrees[std::size_t(first)], least = most;
        for (end = first + 1; end < weights.rows(); ++end) {
            const Eigen::Index here = degrees[std::size_t(end)];
            if (2 * std::min(least, here) < std::max(most, here)) break;
            most = std::max(most, here);
            least = std::min(least, here);
        }
        const Eigen::Index count = (end - first + kMostFunctions - 1) / kMostFunctions;
        for (Eigen::Index group = 0; group < count; ++group) {
            const Eigen::Index from = group * (end - first) / count;
            groups.push_back({first + from, (group + 1) * (end - first) / count - from, most});
        }
    }
    return groups;
}

template <std::size_t... counts>
constexpr std::array<SumSome, sizeof...(counts)> each_count(std::index_sequence<counts...>) {
    return {sum_some<int(counts) + 1>...};
}

}  // namespace

Eigen::MatrixXd legendre_sums(const Eigen::MatrixXd& weights, const Eigen::VectorXd& x) {
    static constexpr auto sum_of = each_count(std::make_index_sequence<kMostFunctions>());
    std::vector<Recurrence> recurrence(std::size_t(weights.cols()));
    for (std::size_t l = 0; l < recurrence.size(); ++l) {
        const double degree = double(l);
        recurrence[l] = {(2.0 * degree + 1.0) / (degree + 1.0), degree / (degree + 1.0)};
    }
    const std::vector<FunctionGroup> groups = grouped(weights);
    Eigen::MatrixXd result(x.size(), weights.rows());
    std::array<double, kArguments> some_x;
    std::array<double, std::size_t(kArguments) * kMostFunctions> sums;
    for (Eigen::Index begin = 0; begin < x.size(); begin += kArguments) {
        const Eigen::Index count = std::min<Eigen::Index>(kArguments, x.size() - begin);
        some_x.fill(0.0);
        std::copy_n(x.data() + begin, count, some_x.data());
        for (const auto& [first, size, degrees] : groups) {
            sum_of[std::size_t(size - 1)](weights, first,
                                          std::span(recurrence).first(std::size_t(degrees)),
                                          some_x.data(), sums.data());
            for (Eigen::Index j = 0; j < size; ++j)
                std::copy_n(&sums[std::size_t(j) * kArguments], count, &result(begin, first + j));
        }
    }
    return result;
}

}  // namespace miebrdf::math
