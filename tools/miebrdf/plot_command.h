// The kinds of `miebrdf plot` share these options; some of them take a scene.
#pragma once

#include <CLI/CLI.hpp>

#include <memory>
#include <string>

#include <miebrdf/brdf.h>
#include "pipeline/plot/picture.h"
#include "tools/miebrdf/command.h"
#include "tools/miebrdf/reflection_options.h"
#include "tools/miebrdf/scene_options.h"

namespace miebrdf::program {

/// Title and size of a chart, and where it goes.
class PlotArguments {
  public:
    void add_to(CLI::App& command);
    /// Refuses a file that could not be written as a picture, before any work is done.
    void check(const Shell& shell) const;
    /// @param otherwise  the title when none was given
    plot::Caption caption(const Shell& shell, const std::string& otherwise) const;
    /// To -o FILE as SVG or PNG by its ending, else as SVG to standard output.
    void save(const plot::Picture& picture, const Shell& shell) const;

  private:
    std::string title_;
    double scale_ = 2.0;
};

/// Kinds that take media: nk, optics, phase.
void add_medium_plots(CLI::App& plot, Shell& shell);
/// Curves of a scene: lobe, spectrum.
void add_scene_plots(CLI::App& plot, Shell& shell);
/// Draws what a scene does to the polarisation of light: polarisation.
void add_polarisation_plot(CLI::App& plot, Shell& shell);
/// A scene's BRDF by several methods: profile.
void add_profile_plot(CLI::App& plot, Shell& shell);
/// Against the angle between source and viewer: phase-angle.
void add_phase_angle_plot(CLI::App& plot, Shell& shell);
/// Columns of tables: columns.
void add_columns_plot(CLI::App& plot, Shell& shell);
/// Colour maps of a scene: hemisphere, slice.
void add_map_plots(CLI::App& plot, Shell& shell);

struct ScenePlotArguments {
    SceneArguments scene;
    std::string incidence;  ///< degrees
    std::string components = "total";
    std::vector<std::string> compare;
    std::string vary;
    std::string cosines;  ///< of incidence, in place of degrees
    bool logarithmic = false;
    bool cosine = false;
    int decades = 3;
    std::vector<std::string> points;  ///< files of measurements
    PlotArguments plot;
};

using ScenePlot = std::shared_ptr<ScenePlotArguments>;

/// A subcommand with the options of the scene and of the chart.
CLI::App* add_scene_kind(CLI::App& plot, Shell& shell, const std::string& kind,
                         const std::string& title, const ScenePlot& arguments,
                         const std::string& default_wavelengths = "rgb");
/// The default of kinds that show one wavelength.
inline constexpr char kOneWavelength[] = "550";
void add_incidence_option(CLI::App& command, const std::string& incidence,
                          const ScenePlot& arguments);
void add_component_options(CLI::App& command, const ScenePlot& arguments);

double cosine_of(double degrees);
std::vector<double> cosines_of(const std::vector<double>& degrees);
/// --incidence. @throws UsageError
std::vector<double> incidences(const ScenePlotArguments& arguments);

/// Angles of reflection in degrees, from 0 to `largest`: a list, and 2 * count + 1 around each
/// incidence, `step` apart, where lobes and glories are narrow.
std::vector<double> reflection_angles(const std::string& list,
                                      const std::vector<double>& incidence_deg, double step,
                                      int count, double largest);

/// LOW,HIGH, ascending, and positive for a logarithmic scale. @throws UsageError
std::pair<double, double> parse_range(const std::string& text, bool logarithmic);

/// The one wavelength of kinds that show a single one. @throws UsageError
double only_wavelength_nm(const Request& request, const std::string& kind);

}  // namespace miebrdf::program
