// The options that describe a scene, the same for every command that takes one.
#pragma once

#include <CLI/CLI.hpp>
#include <string>
#include <vector>

#include "pipeline/scene/request.h"
#include "tools/miebrdf/command.h"

namespace miebrdf::program {

/// Texts of the Mie options, shared with commands that take a MEDIUM without a scene.
class ParticleArguments {
  public:
    void add_to(CLI::App& command);
    /// @throws UsageError
    ParticleOptions parse() const;

  private:
    std::string distribution_ = "power-law";
    ParticleOptions options_;
};

/// A wavelength list and the database to look materials up in.
class MaterialArguments {
  public:
    void add_to(CLI::App& command, const std::string& default_wavelengths);
    std::vector<double> wavelengths_nm() const;
    /// --database, else the environment variable MIEBRDF_DATABASE, else empty (embedded).
    std::string database() const;

  private:
    std::string wavelengths_;
    std::string database_;
};

/// Base, coats, surface and solver options.
class SceneArguments {
  public:
    enum class Base { required, optional };
    void add_to(CLI::App& command, Base base = Base::required,
                const std::string& default_wavelengths = "rgb");
    /// Whether --base was typed.
    bool given() const { return !base_.empty(); }
    /// The request without directions and threads.
    /// @throws UsageError, InputError
    Request parse() const;

  private:
    void add_surface_options(CLI::App& command);
    void add_solver_options(CLI::App& command);
    void parse_surface(Scene& scene) const;

    std::string base_;
    std::vector<std::string> coats_;
    double roughness_ = 0.0;
    const CLI::Option* roughness_option_ = nullptr;  ///< of the command it was added to
    std::string coupling_ = "paper";
    std::string surface_index_;
    std::string grid_ = "auto";
    std::string half_space_method_ = "auto";
    std::string coat_method_ = "auto";
    rte::SolverOptions solver_;
    bool no_delta_m_ = false;
    bool no_correction_ = false;
    ParticleArguments particles_;
    MaterialArguments materials_;
};

/// "power-law, effective radius 50 um, effective variance 0.2, in a host of index 1"
std::string describe_particles(const ParticleOptions& particles);
/// The same for all layers that go through Mie theory: one text where their sizes agree, otherwise
/// "base TiO2: power-law, ...; coat 1 Au: ...; in a host of index 1". Empty where no layer does.
std::string describe_particles(const Scene& scene);

/// Reads the name of a --coat-method. @throws UsageError
rte::CoatMethod parse_coat_method(const std::string& name);

/// Reads `N,K` or `N`.
std::complex<double> parse_index(const std::string& text, const std::string& what);

}  // namespace miebrdf::program
