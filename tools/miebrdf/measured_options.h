// Options for files of measurements, and charts of what they hold.
#pragma once

#include <CLI/CLI.hpp>

#include <string>
#include <vector>

#include <miebrdf/measured.h>
#include "pipeline/plot/panel.h"
#include "pipeline/plot/picture.h"
#include "tools/miebrdf/direction_options.h"

namespace miebrdf::program {

/// Options for what a file of measurements does not say itself.
class MeasuredArguments {
  public:
    void add_to(CLI::App& command);
    /// @throws UsageError, InputError  as read_measured()
    Measurements read(const std::string& path) const;

  private:
    MeasuredOptions options_;
    std::string wavelengths_;
    bool percent_ = false, shares_ = false;
    DirectionArgument mu_in_{DirectionArgument::Side::in};
    DirectionArgument mu_out_{DirectionArgument::Side::out};
};

/// Spectra as curves, one for each sample and kind.
std::vector<plot::Curve> measured_curves(const Measurements& list, plot::Mark mark);

/// Spectra against wavelength; lists of directions against the angle of reflection, positive on
/// the mirror side. @throws InputError  when neither has anything to show
plot::Picture draw_measured(const Measurements& list, const plot::Caption& caption);

}  // namespace miebrdf::program
