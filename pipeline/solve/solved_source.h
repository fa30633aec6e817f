// A request solved at all its wavelengths, as the source of an export.
#pragma once

#include "pipeline/solve/sharp_part.h"

namespace miebrdf::exports {

/// How well the request was solved, over all wavelengths.
struct SolverAccuracy {
    double tolerance = 0.0;
    double error_estimate = 0.0;          ///< relative, largest: transfer and single scattering
    double mie_error_estimate = 0.0;      ///< the part of single scattering in it
    double wavelength_nm = 0.0;           ///< where the estimate is largest
    Direction direction;                  ///< where that of the transfer is largest, there
    double share_within_tolerance = 1.0;  ///< of the directions compared, mean over wavelengths
    bool converged = true;
};

/// One sentence for people: the estimate, and when the tolerance is missed, where and how widely.
std::string describe(const SolverAccuracy& accuracy);

class SolvedSource : public BrdfSource {
  public:
    /// Does all the work: optics, then radiative transfer, wavelengths in parallel.
    /// Request::directions plays no part.
    /// @throws UsageError  also for Component::surface without a surface; InputError, Cancelled
    SolvedSource(const Request& request, Component component, const std::string& command_line,
                 const RunControl& control);
    SolvedSource(const SolvedSource&) = delete;  // its parts refer to each other
    SolvedSource& operator=(const SolvedSource&) = delete;

    const std::vector<std::string>& channels() const override { return channels_; }
    const std::vector<double>& wavelength_nm() const override { return wavelength_nm_; }
    const Provenance& provenance() const override { return provenance_; }
    void evaluate(std::span<const Direction> directions, std::span<double> values) const override;
    std::unique_ptr<ChannelMix> mix(const ColourWeights& weights) const override;

    const SolverAccuracy& accuracy() const { return accuracy_; }

  private:
    void tabulate_sharp_parts(const rte::SolverOptions& solver, const RunControl& control);
    void judge(const WavelengthSolution& solution, const SceneOptics& optics, double wavelength_nm);

    std::vector<double> wavelength_nm_;
    std::vector<std::string> channels_;
    Provenance provenance_;
    std::vector<WavelengthSolution> solutions_;
    std::vector<SharpPart> sharp_;  ///< of the solutions in their order, some at a time
    SolverAccuracy accuracy_;
};

/// Reads "total", "subsurface" or "surface". @throws UsageError
Component parse_component(const std::string& name);
const char* name_of(Component component);

}  // namespace miebrdf::exports
