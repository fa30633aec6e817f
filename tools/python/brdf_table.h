// A BrdfTable and a DirectionSampler, asked for arrays of directions.
#pragma once

#include <miebrdf/brdf.h>
#include <miebrdf/sampling.h>

#include <utility>
#include <vector>

#include "tools/python/bindings.h"
#include "tools/python/long_call.h"

namespace miebrdf::python {

/// Numbers in any layout: they are read where they are, whatever their strides.
using NumberArray = py::array_t<double>;

class SolvedTable {
  public:
    explicit SolvedTable(BrdfTable table) : table_(std::move(table)) {}

    /// @param mu_in, mu_out, azimuth_deg  arrays of one shape; strides of 0 where they are
    /// broadcast
    /// @param out  C-contiguous, of shape (wavelengths, *shape): the values are written there
    /// @throws UsageError  for directions out of range, naming the first
    void evaluate(const NumberArray& mu_in, const NumberArray& mu_out,
                  const NumberArray& azimuth_deg, NumberArray out,
                  const CallOptions& options) const;

    DirectionSampler sampler(std::vector<double> weights, const CallOptions& options) const;

    const BrdfTable& table() const { return table_; }

  private:
    BrdfTable table_;
};

void bind_sampler(py::module_& module);

}  // namespace miebrdf::python
