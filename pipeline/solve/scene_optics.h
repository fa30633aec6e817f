// The optics of a whole scene at its wavelengths: which Mie jobs there are, each done once.
#pragma once

#include <complex>
#include <optional>
#include <string>
#include <vector>

#include "pipeline/scene/request.h"
#include "pipeline/solve/medium_optics.h"
#include "pipeline/solve/run_control.h"
#include "rte/stack/layered_reflection.h"

namespace miebrdf {

/// A scene at one wavelength, ready for radiative transfer.
struct SceneOptics {
    rte::Stack stack;
    double mie_error_estimate = 0.0;  ///< largest of the media
    bool converged = true;
};

enum class PhaseDemand { moments_only, whole };

/// What a request needs of the optics of its media.
OpticsDemand demand_of(const Request& request, PhaseDemand phase);

/// Everything that the optics of one medium at one wavelength depend on: scenes that share the
/// medium share the entry.
std::string optics_hash(const ResolvedMedium& medium, double wavelength_nm,
                        const ParticleOptions& particles, const OpticsDemand& demand);

/// The media of a scene with their names looked up.
class SceneMedia {
  public:
    /// @throws InputError  for unknown names or an unreadable database
    /// @throws UsageError  for a surface on a medium without a refractive index
    explicit SceneMedia(const Request& request);

    /// The scene as it is computed: without coats of no depth.
    const Scene& scene() const { return scene_; }
    /// Base (0) and coats (1, ...) of scene(), looked up.
    const std::vector<ResolvedMedium>& media() const { return media_; }

    /// The layers from a coat of scene() upwards, with that coat as the half-space, and those
    /// below.
    SceneMedia from_coat(std::size_t coat) const;
    SceneMedia below_coat(std::size_t coat) const;

    /// One line for each different medium.
    std::vector<std::string> sources() const;

    /// n + ik of the surface: the request's own, or that of the top medium.
    std::complex<double> surface_index_at(double wavelength_nm) const;

    /// Adds what the layers at a wavelength depend on.
    void add_to(JobKey& key, double wavelength_nm) const;

    /// Optics at each of the wavelengths. Equal jobs (same index, wavelength and sizes) are
    /// computed once; different ones run in parallel.
    std::vector<SceneOptics> optics(const std::vector<double>& wavelength_nm,
                                    const OpticsDemand& demand, const RunControl& control) const;

  private:
    Scene scene_;
    /// media_[0] is the base, then the coats.
    std::vector<ResolvedMedium> media_;
    /// Of the topmost layer as listed, even if it has no depth; empty where no index is needed.
    std::optional<ResolvedMedium> surface_medium_;
};

}  // namespace miebrdf
