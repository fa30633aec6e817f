// Directions as people give them: cosines, or degrees from the normal.
#pragma once

#include <CLI/CLI.hpp>

#include <string>
#include <vector>

namespace miebrdf::program {

/// cos of an angle in degrees, to 15 digits: that of 60 is 0.5.
double cosine_of_degrees(double degrees);

/// --mu-in with --theta-in (--sun-zenith), or --mu-out with --theta-out (--view-zenith).
class DirectionArgument {
  public:
    enum class Side { in, out };

    explicit DirectionArgument(Side side) : side_(side) {}
    /// @param help  of the cosines: "cosines of the angles of incidence, in (0, 1]"
    void add_to(CLI::App& group, const std::string& help, const std::string& default_text = "");

    bool given() const { return !cosines_.empty() || !degrees_.empty(); }
    /// Cosines in (0, 1], in the order given.
    /// @param otherwise  a list of cosines where nothing was given; empty: something must be
    /// @throws UsageError  for both, none, and numbers out of range
    std::vector<double> parse(const std::string& otherwise = "") const;

  private:
    const char* mu_name() const { return side_ == Side::in ? "mu_in" : "mu_out"; }

    Side side_;
    std::string cosines_, degrees_;
};

}  // namespace miebrdf::program
