// A formula of one's own: an expression of the wavelength or the photon energy.
#pragma once

#include <memory>
#include <string>

namespace miebrdf::materials {

/// Text like "1.5 + 0.0042/um^2" with the variables um and nm (wavelength in vacuum) and eV (photon
/// energy), read by muParser: + - * / ^, comparisons, a ? b : c, sqrt, exp, ln, log10, sin, ... and
/// the constants _pi and _e. May be evaluated from several threads.
class Expression {
  public:
    /// @throws UsageError  for what is no expression, with muParser's reason and place; in builds
    ///         without muParser, always
    explicit Expression(const std::string& text);

    /// May be infinite or no number.
    double at(double wavelength_nm) const;

  private:
    struct Parser;
    std::shared_ptr<Parser> parser_;
};

}  // namespace miebrdf::materials
