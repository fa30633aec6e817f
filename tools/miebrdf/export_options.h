// The options of `export`, and which of them each format takes.
#pragma once

#include <string>
#include <vector>

#include "pipeline/formats/brdf_export.h"
#include "tools/miebrdf/scene_options.h"

namespace miebrdf::program {

class ExportArguments {
  public:
    /// Adds all of them but the common ones.
    void add_to(CLI::App& command, Shell& shell);
    /// Whether the format is there and takes every option that was typed.
    /// @throws UsageError  naming those that it does take
    void check_format() const;

    const std::string& format() const { return options_.format; }
    const std::string& component() const { return component_; }
    /// Wavelengths ascending: the order of every format.
    /// @throws UsageError, InputError
    Request scene() const;
    /// @throws UsageError
    exports::ExportOptions file(const std::vector<double>& wavelength_nm) const;

  private:
    void add_file_options(CLI::App& command);

    /// Whether an option was given, as --name.
    bool given(const std::string& option) const;

    const CLI::App* command_ = nullptr;
    SceneArguments scene_;
    std::string component_ = "total";
    std::string mu_in_, mu_out_, azimuth_;
    std::string rgb_ = "auto";
    bool merl_centres_ = false;
    exports::ExportOptions options_;
};

}  // namespace miebrdf::program
