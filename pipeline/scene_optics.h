// The optics of a whole scene at its wavelengths: which Mie jobs there are, each done once.
#pragma once

#include <complex>
#include <optional>
#include <string>
#include <vector>

#include "pipeline/medium_optics.h"
#include "pipeline/request.h"
#include "pipeline/run_control.h"
#include "rte/layered_reflection.h"

namespace miebrdf {

/// A scene at one wavelength, ready for radiative transfer.
struct SceneOptics {
    rte::Stack stack;
    std::optional<std::complex<double>> surface_index;  ///< only with a surface
    double mie_error_estimate = 0.0;                    ///< largest of the media
    bool converged = true;
};

enum class PhaseDemand { none, at_directions };

/// What a request needs of the optics of its media.
OpticsDemand demand_of(const Request& request, PhaseDemand phase);

/// The media of a scene with their names looked up.
class SceneMedia {
  public:
    /// @throws InputError  for unknown names or an unreadable database
    /// @throws UsageError  for a surface on a medium without a refractive index
    explicit SceneMedia(const Request& request);

    /// One line for each different medium.
    std::vector<std::string> sources() const;

    /// Optics at every wavelength of the request. Equal jobs (same index, wavelength and sizes) are
    /// computed once; different ones run in parallel.
    std::vector<SceneOptics> optics(const OpticsDemand& demand, const RunControl& control) const;

  private:
    /// media_[0] is the base, then the coats.
    std::complex<double> surface_index_at(double wavelength_nm) const;

    const Request& request_;
    std::vector<ResolvedMedium> media_;
};

}  // namespace miebrdf
