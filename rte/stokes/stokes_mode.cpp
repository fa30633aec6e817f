#include "rte/stokes/stokes_mode.h"

#include <algorithm>
#include <cmath>
#include <numbers>

#include "rte/math/wigner.h"

namespace miebrdf::rte {
namespace {

// R and T = (-1)^m (d^l_m2 +- d^l_m,-2) / 2, from column l = m on.
void fill_linear(int m, int degrees, const Eigen::VectorXd& mu, StokesTable& table) {
    Eigen::MatrixXd plus, minus;
    math::wigner_functions(m, 2, degrees, mu, plus);
    math::wigner_functions(m, -2, degrees, mu, minus);
    const double half = m % 2 == 0 ? 0.5 : -0.5;
    const Eigen::Index missing = std::max(0, 2 - m);
    table.R.resize(mu.size(), degrees - m);
    table.T.resize(mu.size(), degrees - m);
    table.R.setZero();
    table.T.setZero();
    if (plus.cols() == 0) return;
    table.R.rightCols(degrees - m - missing) = half * (plus + minus);
    table.T.rightCols(degrees - m - missing) = half * (plus - minus);
    if (m == 0) table.T.setZero();
}

// R and T as the nodes see them: at the zenith they vanish as fast as P does, or faster by whole
// powers of 1 - mu.
void fill_linear_at_nodes(int m, int degrees, const ZenithGrid& grid, StokesTables& tables) {
    if (points_suffice(grid, degrees)) {
        fill_linear(m, degrees, grid.mu, tables.nodes);
        return;
    }
    const NodeProjection& projection = tables.sampling.projections.find(grid, degrees);
    StokesTable samples;
    fill_linear(m, degrees, projection.fine.mu, samples);
    tables.nodes.R = projection.of_order(m) * samples.R;
    tables.nodes.T = projection.of_order(m) * samples.T;
}

// One column of a block's functions: along which of Pi_l's columns it lies.
struct Column {
    int degree = 0;
    double strength = 0.0;
    double along_I = 0.0, along_Q = 0.0, along_U = 0.0, along_V = 0.0;
};

bool contains(const StokesBlock& block, StokesComponent component) {
    return std::find(block.begin(), block.end(), component) != block.end();
}

// The strengths of a parity: those of I and Q go to the even columns for even l - m, U and V for
// odd.
struct Columns {
    std::vector<Column> even, odd;
};

Columns list_columns(int m, Eigen::Index degrees, const StokesBlock& block,
                     const MatrixStrengths& medium) {
    using enum StokesComponent;
    Columns columns;
    const bool has_I = contains(block, I), has_U = contains(block, U), has_V = contains(block, V);
    const auto known = std::min(degrees, Eigen::Index(medium.first.size()));
    for (int l = m; l < known; ++l) {
        const bool is_even = (l - m) % 2 == 0;
        auto& linear = is_even ? columns.even : columns.odd;
        auto& circular = is_even ? columns.odd : columns.even;
        const double c = medium.cosine[l], s = medium.sine[l];
        if (has_I)
            linear.push_back(
                {.degree = l, .strength = medium.first[l], .along_I = c, .along_Q = s});
        if (has_I && l >= 2)
            linear.push_back(
                {.degree = l, .strength = medium.second[l], .along_I = -s, .along_Q = c});
        if (has_U && has_V) {
            const double cc = medium.circular_cosine[l], ss = medium.circular_sine[l];
            circular.push_back(
                {.degree = l, .strength = medium.lower[l], .along_U = -ss, .along_V = cc});
            if (l >= 2)
                circular.push_back(
                    {.degree = l, .strength = medium.upper[l], .along_U = cc, .along_V = ss});
        } else if (has_U && l >= 2) {
            circular.push_back({.degree = l, .strength = medium.a3[l], .along_U = 1.0});
        } else if (has_V) {
            circular.push_back({.degree = l, .strength = medium.a4[l], .along_V = 1.0});
        }
    }
    return columns;
}

// Rows k, k + c, k + 2c, ... of a column: component k of a block of c.
auto component_rows(Eigen::MatrixXd& table, Eigen::Index column, int k, int rows_per_node) {
    return Eigen::Map<Eigen::VectorXd, 0, Eigen::InnerStride<>>(
        table.data() + column * table.rows() + k, table.rows() / rows_per_node,
        Eigen::InnerStride<>(rows_per_node));
}

// Rows of I and Q to those of light polarised along the axes.
void turn_to_axes(int rows_per_node, Eigen::MatrixXd& table) {
    constexpr double half = std::numbers::sqrt2 / 2.0;
    for (Eigen::Index column = 0; column < table.cols(); ++column) {
        for (Eigen::Index r = 0; r < table.rows(); r += rows_per_node) {
            const double I = table(r, column), Q = table(r + 1, column);
            table(r, column) = half * (I + Q);
            table(r + 1, column) = half * (I - Q);
        }
    }
}

// One component of the function that belongs to a column: a row of Pi_l times its direction.
void fill_component(const StokesTable& from, Eigen::Index at, StokesComponent component,
                    const Column& column,
                    Eigen::Map<Eigen::VectorXd, 0, Eigen::InnerStride<>> rows) {
    using enum StokesComponent;
    switch (component) {
        case I:
            rows = column.along_I * from.P.col(at);
            return;
        case Q:
            rows = column.along_Q * from.R.col(at) - column.along_U * from.T.col(at);
            return;
        case U:
            rows = column.along_U * from.R.col(at) - column.along_Q * from.T.col(at);
            return;
        case V:
            rows = column.along_V * from.P.col(at);
            return;
    }
}

}  // namespace

std::vector<StokesBlock> stokes_blocks(int fourier_order, int components, bool has_b2) {
    using enum StokesComponent;
    const bool has_V = components == 4;
    if (fourier_order == 0) {
        std::vector<StokesBlock> blocks{{I, Q}, {U}};
        if (has_V && has_b2) blocks[1] = {U, V};
        if (has_V && !has_b2) blocks.push_back({V});
        return blocks;
    }
    std::vector<StokesBlock> blocks{{I, Q, U}};
    if (has_V && has_b2) blocks[0].push_back(V);
    if (has_V && !has_b2) blocks.push_back({V});
    return blocks;
}

ZenithGrid repeated(const ZenithGrid& grid, int rows_per_node) {
    if (rows_per_node == 1) return grid;  // with its panels
    ZenithGrid result{Eigen::VectorXd(grid.size() * rows_per_node),
                      Eigen::VectorXd(grid.size() * rows_per_node)};
    for (Eigen::Index p = 0; p < result.size(); ++p) {
        result.mu[p] = grid.mu[p / rows_per_node];
        result.weights[p] = grid.weights[p / rows_per_node];
    }
    return result;
}

RequestedDirections repeated(const RequestedDirections& requested, int rows_per_node) {
    RequestedDirections result;
    result.mu.resize(requested.mu.size() * rows_per_node);
    for (Eigen::Index r = 0; r < result.mu.size(); ++r)
        result.mu[r] = requested.mu[r / rows_per_node];
    const auto repeat = [&](const std::vector<int>& which, std::vector<int>& list) {
        for (const int place : which)
            for (int k = 0; k < rows_per_node; ++k) list.push_back(place * rows_per_node + k);
    };
    repeat(requested.out, result.out);
    repeat(requested.in, result.in);
    for (const int beside : requested.beside)
        for (int k = 0; k < rows_per_node; ++k)
            result.beside.push_back(beside < 0 ? -1 : beside * rows_per_node + k);
    return result;
}

void make_stokes_tables(int fourier_order, int degrees, const ZenithGrid& grid,
                        const RequestedDirections& requested, StokesTables& tables) {
    tables.fourier_order = fourier_order;
    // Orthogonal in order 0 as there: energy is conserved by the same sums.
    make_fourier_mode(fourier_order, degrees, grid, requested, tables.sampling, tables.scalar);
    tables.nodes.P = tables.scalar.at_nodes;
    tables.requested.P = tables.scalar.at_requested;
    fill_linear_at_nodes(fourier_order, degrees, grid, tables);
    fill_linear(fourier_order, degrees, requested.mu, tables.requested);
}

StrengthChange block_change(int fourier_order, int degrees, const StokesBlock& block,
                            const MatrixStrengths& middle, const MatrixStrengths& plus,
                            const MatrixStrengths& minus) {
    const Columns columns = list_columns(fourier_order, degrees, block, middle);
    const std::size_t pairs = std::max({std::size_t(1), columns.even.size(), columns.odd.size()});
    StrengthChange change;
    change.own.setZero(Eigen::Index(2 * pairs));
    change.beside.setZero(Eigen::Index(2 * pairs));
    // [[a1, b1], [b1, a2]] between two columns.
    const auto linear = [](const MatrixStrengths& of, const Column& a, const Column& b) {
        const double c = of.cosine[a.degree], s = of.sine[a.degree];
        const auto along = [&](const Column& one) { return c * one.along_I + s * one.along_Q; };
        const auto across = [&](const Column& one) { return c * one.along_Q - s * one.along_I; };
        return of.first[a.degree] * along(a) * along(b) +
               of.second[a.degree] * across(a) * across(b);
    };
    const auto strength = [&](const MatrixStrengths& of, const Column& one) {
        if (one.along_U != 0.0) return of.a3[one.degree];
        if (one.along_V != 0.0) return of.a4[one.degree];
        return linear(of, one, one);
    };
    const auto is_linear = [](const Column& one) {
        return one.along_I != 0.0 || one.along_Q != 0.0;
    };
    for (const bool is_even : {true, false}) {
        const std::vector<Column>& list = is_even ? columns.even : columns.odd;
        for (std::size_t k = 0; k < list.size(); ++k) {
            const Eigen::Index column = Eigen::Index(2 * k) + (is_even ? 0 : 1);
            change.own[column] = strength(plus, list[k]) - strength(minus, list[k]);
            if (k + 1 == list.size() || list[k + 1].degree != list[k].degree) continue;
            if (!is_linear(list[k]) || !is_linear(list[k + 1])) continue;
            change.beside[column] =
                linear(plus, list[k], list[k + 1]) - linear(minus, list[k], list[k + 1]);
        }
    }
    return change;
}

void make_block_mode(const StokesTables& tables, const StokesBlock& block,
                     const MatrixStrengths& medium, const ZenithGrid& grid,
                     const RequestedDirections& requested, FourierMode& mode,
                     FourierMedium& fourier_medium) {
    const int m = tables.fourier_order;
    const int c = int(block.size());
    Columns columns = list_columns(m, m + tables.nodes.P.cols(), block, medium);
    const std::size_t pairs = std::max({std::size_t(1), columns.even.size(), columns.odd.size()});
    columns.even.resize(pairs);
    columns.odd.resize(pairs);
    mode.fourier_order = m;
    mode.rows_per_node = c;
    const bool has_intensity = block.front() == StokesComponent::I;
    const bool turns = tables.along_axes && has_intensity;
    const double share = turns ? std::numbers::sqrt2 / 2.0 : double(has_intensity);
    mode.unpolarised = {share, turns ? share : 0.0, 0.0, 0.0};
    const auto count = Eigen::Index(2 * pairs);
    mode.at_nodes.resize(grid.size(), count);
    mode.at_requested.resize(requested.mu.size(), count);
    fourier_medium.lowest_degree = m;
    fourier_medium.strengths.resize(count);
    fourier_medium.degrees.resize(std::size_t(count));
    for (Eigen::Index j = 0; j < count; ++j) {
        const Column& column = (j % 2 == 0 ? columns.even : columns.odd)[std::size_t(j / 2)];
        const int l = std::max(column.degree, m);  // of a column that fills up: any
        fourier_medium.strengths[j] = column.strength;
        fourier_medium.degrees[std::size_t(j)] = l;
        for (int k = 0; k < c; ++k) {
            const StokesComponent component = block[std::size_t(k)];
            fill_component(tables.nodes, l - m, component, column,
                           component_rows(mode.at_nodes, j, k, c));
            fill_component(tables.requested, l - m, component, column,
                           component_rows(mode.at_requested, j, k, c));
        }
    }
    if (turns) {
        turn_to_axes(c, mode.at_nodes);
        turn_to_axes(c, mode.at_requested);
    }
    mode.scaled_nodes.resize(mode.at_nodes.rows(), count);
    mode.scaled_nodes =
        (grid.weights.array() / grid.mu.array()).sqrt().matrix().asDiagonal() * mode.at_nodes;
}

}  // namespace miebrdf::rte
