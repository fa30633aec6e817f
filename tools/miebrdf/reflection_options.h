// The options of `brdf` and `albedo`; `plan` reads the same ones.
#pragma once

#include <CLI/CLI.hpp>
#include <optional>
#include <string>
#include <vector>

#include <miebrdf/brdf.h>
#include <miebrdf/colour.h>
#include "tools/miebrdf/scene_options.h"

namespace miebrdf::program {

/// What `brdf` was asked.
struct BrdfQuestion {
    Request request;
    Directions directions;
    std::vector<BrdfPart> columns;  ///< in the order typed
    BrdfParts parts;                ///< the same as a set
    bool as_reflection = false;     ///< pi times the BRDF
};

class BrdfArguments {
  public:
    void add_to(CLI::App& command, Shell& shell);
    /// @throws UsageError, InputError
    BrdfQuestion parse() const;

  private:
    SceneArguments scene_;
    std::string mu_in_;
    std::string mu_out_;
    std::string azimuth_ = "0";
    std::string components_ = "total";
    std::string quantity_ = "brdf";
};

/// What `albedo` was asked.
struct AlbedoQuestion {
    Request request;
    std::vector<double> mu_in;
    std::optional<Illuminant> illuminant;  ///< of the colours that take the place of spectra
};

class AlbedoArguments {
  public:
    void add_to(CLI::App& command, Shell& shell);
    /// @throws UsageError, InputError
    AlbedoQuestion parse() const;

  private:
    SceneArguments scene_;
    std::string mu_in_ = "0.1:1:0.1";
    std::string colour_;
};

}  // namespace miebrdf::program
