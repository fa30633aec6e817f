// Models of the permittivity: oscillators of solids, which add up.
//
// Photon energy E in eV, time factor exp(-i omega t): absorption is Im eps > 0. With the letters of
// the parameter lists below, and the Lorentz shape
//     L(E) = A E0 C E / ((E^2 - E0^2)^2 + C^2 E^2):
//   drude         eps = -EP^2 / (E^2 + i G E)
//   lorentz       eps = S E0^2 / (E0^2 - E^2 - i G E)
//   tauc-lorentz  eps_2 = L(E) (E - EG)^2 / E^2 above EG, 0 below
//                 (G. E. Jellison & F. A. Modine, Appl. Phys. Lett. 69, 371 and 2137 (1996))
//   cody-lorentz  eps_2 = L(E) (E - EG)^2 / ((E - EG)^2 + EP^2) above EG, 0 below; with ET and EU,
//                 below ET the Urbach tail E_1 / E exp((E - ET) / EU), continuous at ET
//                 (A. S. Ferlauto et al., J. Appl. Phys. 92, 2424 (2002))
// eps_1 of the last two is the Kramers-Kronig integral of eps_2, in closed form.
#pragma once

#include <complex>
#include <span>
#include <string>
#include <string_view>
#include <vector>

namespace miebrdf::materials {

struct OscillatorParameter {
    const char* name;     ///< "E0"
    const char* meaning;  ///< "resonance, eV"
    bool may_be_zero;     ///< all are >= 0
};

struct OscillatorKind {
    const char* name;  ///< "tauc-lorentz"
    const char* title;
    const char* reference;  ///< publication
    std::vector<OscillatorParameter> parameters;
    std::size_t fewest_parameters;  ///< the others may be left out together
    /// Its addend to the permittivity. @param energy_ev  > 0
    std::complex<double> (*susceptibility)(std::span<const double> parameters, double energy_ev);
    /// Where it changes quickly, and over what width, in eV; width 0: nowhere.
    std::pair<double, double> (*feature)(std::span<const double> parameters);
};

/// All kinds, in the order in which help texts list them.
std::span<const OscillatorKind> oscillator_kinds();

/// Null when there is none of this name.
const OscillatorKind* find_oscillator_kind(std::string_view name);

/// "drude(EP,G)"
std::string form_of(const OscillatorKind& kind);

}  // namespace miebrdf::materials
