#include "pipeline/formats/rgl/half_vector_table.h"

#include <array>

namespace miebrdf {
namespace {

using std::numbers::pi;
/// Lower than the stencil of a lit node reaches.
constexpr double kLowest = -0.5;
/// Points a side in each cell, to find the part of it that is lit.
constexpr std::size_t kPoints = 4;

double polar_angle(double x) { return x * x * pi / 2; }
double azimuth(double y) { return (2.0 * y - 1.0) * pi; }

/// d(outgoing solid angle) / dx dy = 2 pi^2 x sin(theta) * 4 (in . half).
double solid_angle(double x, double sin_theta, double in_half) {
    return std::max(2.0 * pi * pi * x * sin_theta, 1e-6) * 4.0 * std::max(in_half, 0.0);
}

}  // namespace

HalfVectorTable::HalfVectorTable(std::size_t n, const Eigen::Vector3d& in)
    : n_(n), in_(in), cosine_(n * n), share_(n * n, 0.0) {
    for (std::size_t node = 0; node < size(); ++node) {
        cosine_[node] = outgoing(node).z();
        if (cosine_[node] > kLowest) needed_.push_back(node);
    }
    weigh_cells();
}

Eigen::Vector3d HalfVectorTable::half_vector(std::size_t node) const {
    return spherical(polar_angle(unit(node % n_)), azimuth(unit(node / n_)));
}

double HalfVectorTable::jacobian(std::size_t node) const {
    const Eigen::Vector3d half = half_vector(node);
    return solid_angle(unit(node % n_), std::hypot(half.x(), half.y()), in_.dot(half));
}

void HalfVectorTable::weigh_cells() {
    struct Point {
        std::size_t cell;
        double coordinate, to_next, sine, cosine;
    };
    std::vector<Point> columns, rows;
    for (std::size_t i = 0; i < (n_ - 1) * kPoints; ++i) {
        const double at = (double(i) + 0.5) / double(kPoints);
        const double to_next = at - std::floor(at), u = at / double(n_ - 1);
        const double theta = polar_angle(u), phi = azimuth(u);
        columns.push_back({i / kPoints, u, to_next, std::sin(theta), std::cos(theta)});
        rows.push_back({i / kPoints, u, to_next, std::sin(phi), std::cos(phi)});
    }
    const double area = 1.0 / double(rows.size() * columns.size());
    for (const Point& row : rows) {
        for (const Point& column : columns) {
            const double in_half = in_.x() * column.sine * row.cosine + in_.z() * column.cosine;
            if (!(2.0 * in_half * column.cosine > in_.z())) continue;  // below the horizon
            const double light = area * solid_angle(column.coordinate, column.sine, in_half);
            double* corner = &share_[row.cell * n_ + column.cell];
            corner[0] += light * (1.0 - row.to_next) * (1.0 - column.to_next);
            corner[1] += light * (1.0 - row.to_next) * column.to_next;
            corner[n_] += light * row.to_next * (1.0 - column.to_next);
            corner[n_ + 1] += light * row.to_next * column.to_next;
        }
    }
}

void HalfVectorTable::fit(std::span<double> values) const {
    limit_continuation(values);
    keep_cell_means(values);
    settle_horizon(values);
}

/// Continued below the horizon is the light at the mirrored direction, which may be in the lobe of
/// a surface where the lit neighbours are far outside it. A curve that goes through zero at the
/// horizon is no larger there than at lit nodes as near.
void HalfVectorTable::limit_continuation(std::span<double> values) const {
    constexpr std::size_t kNear = 2;  // nodes
    for (const std::size_t node : needed_) {
        if (lit(node)) continue;
        const std::size_t x = node % n_, y = node / n_;
        const std::size_t left = x > kNear ? x - kNear : 0, right = std::min(x + kNear, n_ - 1);
        double largest = 0.0;
        for (std::size_t step = 0; step <= 2 * kNear; ++step) {
            // The first and the last row are the same half vectors: n - 1 steps around.
            const std::size_t row = (y + step + n_ - 1 - kNear) % (n_ - 1);
            for (std::size_t column = left; column <= right; ++column)
                if (lit(row * n_ + column)) largest = std::max(largest, values[row * n_ + column]);
        }
        values[node] = std::max(values[node], -largest);
    }
}

/// Between nodes, a straight line is above a curve that bends up: by h^2 f'' / 12 on average. Nodes
/// lowered by as much have the right mean over each cell, and 0.4 of the error (rms).
void HalfVectorTable::keep_cell_means(std::span<double> values) const {
    const std::vector<double> f(values.begin(), values.end());
    const auto bend = [&](std::size_t before, std::size_t node, std::size_t after) {
        const bool known = cosine_[before] > kLowest && cosine_[after] > kLowest;
        return known ? f[before] - 2.0 * f[node] + f[after] : 0.0;
    };
    for (const std::size_t node : needed_) {
        const std::size_t x = node % n_, y = node / n_;
        if (x == 0 || x + 1 == n_) continue;
        // The first and the last row are the same half vectors: phi = -180 and 180 degrees.
        const std::size_t above = (y + 1 == n_ ? 1 : y + 1) * n_ + x;
        const std::size_t below = (y == 0 ? n_ - 2 : y - 1) * n_ + x;
        values[node] -= (bend(node - 1, node, node + 1) + bend(below, node, above)) / 12.0;
    }
}

/// Nodes below the horizon get 0, because Mitsuba 3 returns, and pbrt-v4 reports as an error, what
/// is negative. Zero in place of the continuation adds light just above the horizon; lit neighbours
/// give it back, each in proportion to the light that it stands for.
void HalfVectorTable::settle_horizon(std::span<double> values) const {
    std::vector<double> surplus(size(), 0.0);  // relative, of the light of a lit node
    const auto light = [&](std::size_t node) {
        return lit(node) ? std::max(values[node], 0.0) * share_[node] : 0.0;
    };
    for (const std::size_t node : needed_) {
        if (lit(node) || !(share_[node] > 0.0)) continue;
        const std::size_t x = node % n_, y = node / n_;
        const std::size_t left = x > 0 ? x - 1 : 0, right = std::min(x + 1, n_ - 1);
        const std::size_t first = y > 0 ? y - 1 : 0, last = std::min(y + 1, n_ - 1);
        double total = 0.0;
        for (std::size_t r = first; r <= last; ++r)
            for (std::size_t c = left; c <= right; ++c) total += light(r * n_ + c);
        if (!(total > 0.0)) continue;
        const double added = -values[node] * share_[node] / total;
        for (std::size_t r = first; r <= last; ++r)
            for (std::size_t c = left; c <= right; ++c) surplus[r * n_ + c] += added;
    }
    for (std::size_t node = 0; node < size(); ++node) {
        values[node] =
            lit(node) ? std::max(values[node], 0.0) * std::max(1.0 - surplus[node], 0.0) : 0.0;
    }
}

}  // namespace miebrdf
