// The options of `brdf` and `albedo`; `plan` reads the same ones.
#pragma once

#include <CLI/CLI.hpp>
#include <optional>
#include <string>
#include <vector>

#include <miebrdf/colour.h>
#include "tools/miebrdf/scene_options.h"

namespace miebrdf::program {

class BrdfArguments {
  public:
    void add_to(CLI::App& command);
    /// The whole request, with only the parts that --component names.
    /// @throws UsageError, InputError
    Request parse() const;
    /// total, subsurface, surface in the order typed.
    std::vector<std::string> components() const;
    const std::string& quantity() const { return quantity_; }

  private:
    SceneArguments scene_;
    std::string mu_in_;
    std::string mu_out_;
    std::string azimuth_ = "0";
    std::string components_ = "total";
    std::string quantity_ = "brdf";
};

class AlbedoArguments {
  public:
    void add_to(CLI::App& command);
    /// @throws UsageError, InputError
    Request parse() const;
    /// The illuminant of the colours that take the place of spectra; empty: spectra.
    std::optional<Illuminant> illuminant() const;

  private:
    SceneArguments scene_;
    std::string mu_in_ = "0.1:1:0.1";
    std::string colour_;
};

}  // namespace miebrdf::program
