// What the kinds of `miebrdf plot` that take a scene share.
#pragma once

#include <memory>

#include "pipeline/solve/brdf.h"
#include "tools/miebrdf/plot_command.h"
#include "tools/miebrdf/scene_options.h"

namespace miebrdf::program {

struct ScenePlotArguments {
    SceneArguments scene;
    std::string incidence;  ///< degrees
    std::string components = "total";
    std::vector<std::string> compare;
    bool logarithmic = false;
    bool cosine = false;
    int decades = 3;
    PlotArguments plot;
};

using ScenePlot = std::shared_ptr<ScenePlotArguments>;

/// A subcommand with the scene's options and the common ones.
CLI::App* add_scene_kind(CLI::App& plot, Shell& shell, const std::string& kind,
                         const std::string& title, const ScenePlot& arguments,
                         const std::string& default_wavelengths = "rgb");
/// Of kinds that show one.
inline constexpr char kOneWavelength[] = "550";
void add_incidence_option(CLI::App& command, const std::string& incidence,
                          const ScenePlot& arguments);
void add_component_options(CLI::App& command, const ScenePlot& arguments);

double cosine_of(double degrees);
std::vector<double> cosines_of(const std::vector<double>& degrees);
/// --incidence. @throws UsageError
std::vector<double> incidences(const ScenePlotArguments& arguments);

/// @throws UsageError  for an unknown name, and for a surface that is not there
const std::vector<double>& component_of(const SpectralSlice& slice, const std::string& name);

/// "paint (tau = 0.1) on base"
std::string title_of(const Scene& scene);
/// The same for scenes that differ in their bases.
std::string title_of(const std::vector<Scene>& scenes);

/// LOW,HIGH, ascending, and positive for a logarithmic scale. @throws UsageError
std::pair<double, double> parse_range(const std::string& text, bool logarithmic);

/// The one wavelength of kinds that show a single one. @throws UsageError
double only_wavelength_nm(const Request& request, const std::string& kind);

}  // namespace miebrdf::program
