// Light scattered once in a stack of layers, at any directions, for all wavelengths at once.
#pragma once

#include <vector>

#include "pipeline/render/table_nodes.h"
#include "rte/first_order/first_order.h"

namespace miebrdf::render {

/// rte::single_scattering and rte::NarrowFeatures with functions of the scattering angle read from
/// tables: 1024 intervals that are 0.0004 degrees wide at 0 and 180, 0.03 half a degree away from
/// them, 0.32 in the middle. Glories, rainbows and forward peaks live here: what is scattered more
/// than once is smooth.
class FirstOrderTable {
  public:
    /// @param stacks  for each wavelength the media from the bottom up
    /// @param exact   the exact phase functions, else what the discrete equations use of them
    FirstOrderTable(const std::vector<std::vector<rte::ScaledMedium>>& stacks, bool exact);

    /// What a pair of directions shares over all wavelengths.
    struct Place {
        CubicTaps angle, log_q;
        float q;      ///< 1/mu_in + 1/mu_out
        float shape;  ///< 1 / (4 (mu_in + mu_out))
    };
    Place place(double mu_in, double mu_out, double cos_azimuth) const;

    /// R at the wavelengths of a lane.
    Lane reflection(const Place& place, std::size_t lane) const;

  private:
    void add_layers(const std::vector<std::vector<rte::ScaledMedium>>& stacks, bool exact);
    void add_narrow(const std::vector<std::vector<rte::ScaledMedium>>& stacks);
    Lane narrow(const Place& place, std::size_t lane) const;
    const float* row(const std::vector<float>& table, std::size_t index, std::size_t lane) const {
        return &table[index * stride_ + lane * kLaneWidth];
    }

    std::size_t stride_;  ///< wavelengths, filled up to whole lanes
    std::size_t layers_ = 0;
    std::size_t narrow_nodes_ = 0;  ///< in log q; 1 where it does not matter, 0 without any
    /// From the top down: [layer * stride + w], tau', infinite for a half-space.
    std::vector<float> depth_;
    /// [(layer * angles + a) * stride + w]: alpha / (1 - alpha f) P
    std::vector<float> phase_;
    /// [(a * nodes + node) * stride + w]: C of rte::NarrowFeatures
    std::vector<float> narrow_;
};

}  // namespace miebrdf::render
