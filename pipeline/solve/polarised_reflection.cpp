#include "pipeline/solve/polarised_reflection.h"

#include <algorithm>
#include <cmath>

namespace miebrdf {
namespace {

using rte::Directions;
using rte::SolverReport;

/// Cosines from `first` on, at most `count`.
std::vector<double> some_of(const std::vector<double>& cosines, std::size_t first,
                            std::size_t count) {
    const auto begin = cosines.begin() + std::ptrdiff_t(first);
    return {begin, begin + std::ptrdiff_t(std::min(count, cosines.size() - first))};
}

/// The worse of two, written `!(<=)` so that what is not a number is worst.
bool is_worse(const SolverReport& one, const SolverReport& other) {
    return !(one.error_estimate <= other.error_estimate);
}

void add_block_report(SolverReport& all, const SolverReport& one, double share, bool is_first) {
    const double within = all.share_within_tolerance;
    const bool converged = all.converged && one.converged;
    const SolverReport before = all;
    if (is_first || is_worse(one, before)) all = one;
    if (is_first) {
        all.share_within_tolerance *= share;
        return;
    }
    all.streams = std::max(before.streams, one.streams);
    all.moments = std::max(before.moments, one.moments);
    all.fourier_orders = std::max(before.fourier_orders, one.fourier_orders);
    all.iterations = std::max(before.iterations, one.iterations);
    all.share_within_tolerance = within + share * one.share_within_tolerance;
    all.converged = converged;
}

void append_values(std::vector<double>& list, const std::vector<double>& more) {
    list.insert(list.end(), more.begin(), more.end());
}

}  // namespace

std::vector<double> unpolarised_part(const std::vector<double>& matrices, std::size_t elements) {
    std::vector<double> values;
    values.reserve(matrices.size() / elements);
    for (std::size_t i = 0; i < matrices.size(); i += elements) values.push_back(matrices[i]);
    return values;
}

UnpolarisedReflection reflect_unpolarised(const rte::Stack& stack, const Directions& directions,
                                          int components, const rte::SolverOptions& options,
                                          std::size_t most_directions) {
    const auto elements = static_cast<std::size_t>(components * components);
    const std::size_t ins = directions.mu_in.size(), outs = directions.mu_out.size();
    const std::size_t azimuths = std::max<std::size_t>(1, directions.azimuth_deg.size());
    const std::size_t outs_a_block =
        std::clamp<std::size_t>(most_directions / azimuths, 1, std::max<std::size_t>(1, outs));
    const std::size_t ins_a_block =
        std::max<std::size_t>(1, most_directions / (azimuths * outs_a_block));
    UnpolarisedReflection all;
    all.reflection.resize(ins * outs * directions.azimuth_deg.size());
    bool is_first = true;
    for (std::size_t in = 0; is_first || in < ins; in += ins_a_block) {
        for (std::size_t out = 0; out == 0 || out < outs; out += outs_a_block) {
            const Directions block{some_of(directions.mu_in, in, ins_a_block),
                                   some_of(directions.mu_out, out, outs_a_block),
                                   directions.azimuth_deg};
            const rte::MuellerTable table =
                rte::reflect_polarised(stack, block, components, options);
            const std::size_t line = block.mu_out.size() * directions.azimuth_deg.size();
            for (std::size_t i = 0; i < block.mu_in.size(); ++i) {
                double* to =
                    all.reflection.data() + ((in + i) * outs + out) * directions.azimuth_deg.size();
                for (std::size_t v = 0; v < line; ++v)
                    to[v] = table.reflection[(i * line + v) * elements];
            }
            const double whole = double(ins) * double(outs);
            const double share =
                whole > 0.0 ? double(block.mu_in.size() * block.mu_out.size()) / whole : 1.0;
            add_block_report(all.report, table.report, share, is_first);
            is_first = false;
            if (out > 0) continue;  // what goes with an incidence alone
            append_values(all.plane_albedo, table.plane_albedo);
            append_values(all.polarised_plane_albedo, table.polarised_plane_albedo);
            append_values(all.mirror_reflectance,
                          unpolarised_part(table.mirror_reflection, elements));
        }
    }
    return all;
}

}  // namespace miebrdf
