// A request solved at all its wavelengths, as the source of an export.
#pragma once

#include "pipeline/exports/wavelength_solution.h"

namespace miebrdf::exports {

class SolvedSource : public BrdfSource {
  public:
    /// Does all the work: optics, then radiative transfer, wavelengths in parallel.
    /// Request::directions plays no part.
    /// @throws UsageError  also for Component::surface without a surface; InputError, Cancelled
    SolvedSource(const Request& request, Component component, const std::string& command_line,
                 const RunControl& control);

    const std::vector<std::string>& channels() const override { return channels_; }
    const std::vector<double>& wavelength_nm() const override { return wavelength_nm_; }
    const Provenance& provenance() const override { return provenance_; }
    void evaluate(std::span<const Direction> directions, std::span<double> values) const override;

    bool converged() const { return converged_; }
    /// Relative, largest of all wavelengths and media, as `miebrdf brdf` reports it.
    double error_estimate() const { return error_estimate_; }

  private:
    std::vector<double> wavelength_nm_;
    std::vector<std::string> channels_;
    Provenance provenance_;
    std::vector<WavelengthSolution> solutions_;
    bool converged_ = true;
    double error_estimate_ = 0.0;
};

/// Reads "total", "subsurface" or "surface". @throws UsageError
Component parse_component(const std::string& name);
const char* name_of(Component component);

}  // namespace miebrdf::exports
