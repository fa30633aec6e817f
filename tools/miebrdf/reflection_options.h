// The options of `brdf` and `albedo`; `plan` reads the same ones.
#pragma once

#include <CLI/CLI.hpp>
#include <optional>
#include <string>
#include <vector>

#include <miebrdf/brdf.h>
#include <miebrdf/colour.h>
#include "tools/miebrdf/direction_options.h"
#include "tools/miebrdf/scene_options.h"

namespace miebrdf::program {

/// Names of components, separated by commas, each once, in the order typed.
/// @throws UsageError  for an unknown name, and for the surface of a scene without one
std::vector<BrdfPart> parse_components(const std::string& text, const Scene& scene);

/// Sorts the wavelengths and refuses those that no colour can be told from: fewer than eight, or
/// not from 430 nm or less to 650 nm or more. @throws UsageError
void prepare_for_colour(std::vector<double>& wavelength_nm);

/// --over: a dark and a light ground, each a substrate or "white". @throws UsageError, InputError
std::vector<Substrate> parse_grounds(const std::string& text);

/// `--colour` and `--reference`.
class ColourArguments {
  public:
    void add_to(CLI::App& command);
    /// Empty: no colours are wanted. Where they are, sorts the wavelengths and refuses those that
    /// no colour can be told from. @throws UsageError
    std::optional<Viewing> parse(std::vector<double>& wavelength_nm) const;
    const std::string& reference() const { return reference_; }

  private:
    std::string viewing_;
    std::string reference_;
};

/// The request of `brdf`.
struct BrdfQuestion {
    Request request;
    Directions directions;
    std::vector<BrdfPart> columns;  ///< in the order typed
    BrdfParts parts;                ///< the same as a set
    bool as_reflection = false;     ///< pi times the BRDF
    /// The sky's share, for the reflectance factor (HDRF) that takes the BRDF's place.
    std::optional<double> diffuse_fraction;
    Sky sky;                               ///< of that share
    std::optional<Viewing> viewing;        ///< of the colours that take the place of spectra
    std::string reference;                 ///< file to compare colours with; empty: none
    std::vector<std::string> derivatives;  ///< numbers of the scene; empty: none
};

class BrdfArguments {
  public:
    void add_to(CLI::App& command, Shell& shell);
    /// @throws UsageError, InputError
    BrdfQuestion parse() const;

  private:
    SceneArguments scene_;
    DirectionArgument mu_in_{DirectionArgument::Side::in};
    DirectionArgument mu_out_{DirectionArgument::Side::out};
    std::string azimuth_ = "0";
    std::string components_ = "total";
    std::string quantity_ = "brdf";
    std::string diffuse_fraction_;
    std::string sky_ = "uniform";
    std::string derivatives_;
    ColourArguments colour_;
};

/// The request of `albedo`.
struct AlbedoQuestion {
    Request request;
    std::vector<double> mu_in;
    std::optional<double> diffuse_fraction;  ///< of the light from the sky
    std::optional<Viewing> viewing;          ///< of the colours that take the place of spectra
    std::string reference;                   ///< file to compare colours with; empty: none
    bool gloss = false;                      ///< in place of spectra
    std::vector<Substrate> over;           ///< a dark and a light ground; empty: as the scene says
    std::vector<std::string> derivatives;  ///< numbers of the scene; empty: none
};

class AlbedoArguments {
  public:
    void add_to(CLI::App& command, Shell& shell);
    /// @throws UsageError, InputError
    AlbedoQuestion parse() const;

  private:
    SceneArguments scene_;
    DirectionArgument mu_in_{DirectionArgument::Side::in};
    std::string diffuse_fraction_;
    std::string over_;
    std::string derivatives_;
    bool gloss_ = false;
    ColourArguments colour_;
};

}  // namespace miebrdf::program
