// The options of commands that take media, but no whole scene, and the single scattering of these.
#pragma once

#include <CLI/CLI.hpp>
#include <string>
#include <vector>

#include "pipeline/solve/single_scattering.h"
#include "tools/miebrdf/scene_options.h"

namespace miebrdf::program {

/// Media and wavelengths, looked up.
struct MediaSpectra {
    ResolvedScene scene;  ///< its media are those asked for, in their order
    OpticsDemand demand;
    std::string particles;  ///< of the first medium, in words; empty: no Mie theory
    std::vector<std::vector<MediumOptics>> optics = {};  ///< [wavelength][medium], once computed

    void compute(const Control& control);
    bool converged() const;
};

class MediaArguments {
  public:
    /// Adds the words of a scene that say something of media.
    void add_to(CLI::App& command, Shell& shell, const std::string& default_wavelengths);
    /// Looks media up; `demand` has the tolerance that holds when --mie-tolerance says none.
    /// @param media  as typed, at least one
    /// @throws UsageError, InputError
    MediaSpectra look_up(const std::vector<std::string>& media, OpticsDemand demand) const;

  private:
    SceneArguments scene_;
};

}  // namespace miebrdf::program
