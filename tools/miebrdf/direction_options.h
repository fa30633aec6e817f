// Directions as people give them: cosines, or degrees from the normal.
#pragma once

#include <CLI/CLI.hpp>

#include <string>
#include <vector>

#include <miebrdf/solver.h>

namespace miebrdf::program {

/// cos of an angle in degrees, to 15 digits: that of 60 is 0.5.
double cosine_of_degrees(double degrees);

/// Calls visit(mu_in, mu_out, azimuth_deg) for every direction, in the order of values.
template <typename Visit>
void for_each_direction(const rte::Directions& directions, const Visit& visit) {
    for (const double in : directions.mu_in) {
        for (const double out : directions.mu_out) {
            for (const double azimuth : directions.azimuth_deg) visit(in, out, azimuth);
        }
    }
}

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
