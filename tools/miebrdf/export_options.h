// The options of `export`: what each format takes is in the list of formats (miebrdf/formats.h).
#pragma once

#include <map>
#include <string>
#include <vector>

#include <miebrdf/formats.h>
#include <miebrdf/measured.h>
#include "tools/miebrdf/direction_options.h"
#include "tools/miebrdf/scene_options.h"

namespace miebrdf::program {

class ExportArguments {
  public:
    /// Adds all of them but the common ones.
    void add_to(CLI::App& command, Shell& shell);
    /// Whether the format is there and takes every option that was typed.
    /// @throws UsageError  naming those that it does take
    void check_format() const;

    const Format& format() const { return find_format(format_); }
    const std::string& component() const { return component_; }
    /// Whether --coupling is as exports have it, not as somebody said.
    bool coupling_by_default() const { return !scene_.given("coupling"); }
    /// Whether every direction of the file is one that was asked for.
    bool lists_all_directions() const {
        return mu_in_.given() && mu_out_.given() && !azimuth_.empty();
    }
    /// Whether a file of measurements (--from) stands in place of a scene.
    bool from_measurements() const { return !from_.empty(); }
    /// @throws UsageError  for words of a scene beside it, and formats that hold no BRDF
    Measurements measurements() const;
    /// Wavelengths ascending: the order of every format.
    /// @throws UsageError, InputError
    Request scene() const;
    /// @throws UsageError
    ExportOptions file() const;

  private:
    void add_file_options(CLI::App& command);

    /// Whether an option was given, as --name.
    bool given(const std::string& option) const;

    const CLI::App* command_ = nullptr;
    SceneArguments scene_;
    std::string format_;
    std::string component_ = "total";
    DirectionArgument mu_in_{DirectionArgument::Side::in};
    DirectionArgument mu_out_{DirectionArgument::Side::out};
    std::string azimuth_, from_, column_, azimuth_zero_;
    ExportOptions options_;
};

/// Says in the help of a command that --coupling defaults to reciprocal there.
void default_to_reciprocal(CLI::App& command);

/// The request of a scene as files want it: wavelengths ascending, coupling reciprocal where no
/// word says another one. @throws UsageError, InputError
Request exported_request(const SceneArguments& scene);

/// The uppermost medium of a scene whose mean free path is known at all wavelengths, its asymmetry
/// that of the middle one.
std::optional<SubsurfaceMedium> subsurface_of(const Brdf& brdf);

/// "-78 % at mu_in 0.5, mu_out 0.5, azimuth 180": a region's worst value.
std::string worst_of(const RegionDeviation& region);

/// Options (with their dashes) that a format has no use for: those of other formats, and for
/// spectra and single-scattering tables parts of the scene's.
/// @throws UsageError  for an unknown format, with the nearest names
std::vector<std::string> ignored_options_of(const std::string& format);

}  // namespace miebrdf::program
