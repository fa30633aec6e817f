// The words of a scene (pipeline/scene/scene_words.h) as options, the same for every command; and
// those of commands that take media, but no whole scene.
#pragma once

#include <CLI/CLI.hpp>

#include <map>
#include <string>
#include <string_view>
#include <vector>

#include <miebrdf/brdf.h>

#include <miebrdf/scene.h>
#include "pipeline/scene/scene_words.h"
#include "pipeline/solve/single_scattering.h"
#include "tools/miebrdf/command.h"

namespace miebrdf::program {

/// Words with their values as they were said.
using SaidWords = std::map<std::string, std::vector<WordValue>>;

/// The request that they ask for; the rest is as by default, but for wavelengths: there are none.
/// @throws UsageError, InputError
Request request_of(const SaidWords& said);

/// The scene of a request, ready to be asked. @throws UsageError, InputError
Brdf solved(const Request& request, const Control& control);

/// A table of what Brdf::evaluate gives: where no coupling is asked for, the paper's.
TableOptions as_evaluated(const Brdf& brdf, BrdfPart part, const Shell& shell);

/// Names of words for commands that take media, but no whole scene.
std::vector<std::string> words_of_media();

/// The scene of a command: from its options, or from the scene file whose result it is. It may not
/// be moved once its options are added.
class SceneArguments {
  public:
    enum class Base { required, optional };
    /// Adds all words.
    void add_to(CLI::App& command, Shell& shell, Base base = Base::required,
                const std::string& default_wavelengths = "rgb");
    /// Adds some words; there is no base among them.
    void add_to(CLI::App& command, Shell& shell, const std::vector<std::string>& words,
                const std::string& default_wavelengths);

    /// Whether a word was said, by whatever value.
    bool given(std::string_view word = "base") const;
    /// The whole request. A database that no word names is that of MIEBRDF_DATABASE, if it is set.
    /// @throws UsageError, InputError
    Request parse() const;
    /// The words as they were typed.
    SaidWords typed() const;
    /// Gives a request that comes from elsewhere what it does not say: wavelengths and database.
    Request complete(Request request) const;

  private:
    void add(CLI::App& command, Shell& shell, const std::vector<std::string>& words);
    void note_default_sizes(const Scene& scene) const;
    friend class MediaArguments;

    bool needs_base_ = false;
    std::string default_wavelengths_;
    const SceneFileResult* result_ = nullptr;
    const Shell* shell_ = nullptr;
    std::map<std::string, std::vector<std::string>> values_;  ///< of words that have values
    std::map<std::string, bool> flags_;
};

/// "power-law, effective radius 50 um, effective variance 0.2, in a host of index 1": what Mie
/// theory takes one medium for. Empty for media that do not go through it.
std::string describe_particles(const Medium& medium, const ParticleOptions& particles);
/// As above, for all layers of a scene: one text where their sizes agree, otherwise "base TiO2:
/// power-law, ...; coat 1 Au: ...; in a host of index 1".
std::string describe_particles(const Scene& scene);

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
