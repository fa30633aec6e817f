// What the kinds of `miebrdf plot` share.
#pragma once

#include <CLI/CLI.hpp>
#include <string>

#include "pipeline/plot/picture.h"
#include "tools/miebrdf/command.h"

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
/// A scene's BRDF by several methods: profile.
void add_profile_plot(CLI::App& plot, Shell& shell);
/// Colour maps of a scene: hemisphere, slice.
void add_map_plots(CLI::App& plot, Shell& shell);

}  // namespace miebrdf::program
