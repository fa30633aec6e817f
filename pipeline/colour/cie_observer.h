// The CIE's eye and lamps: 1931 2-degree standard colorimetric observer, illuminants D65, E and A.
#pragma once

namespace miebrdf {

inline constexpr double kObserverShortest_nm = 360.0;
inline constexpr double kObserverLongest_nm = 830.0;

struct ColourMatching {
    double x, y, z;
};

/// The colour-matching functions of the CIE 1931 2-degree observer (ISO/CIE 11664-1).
///
/// Tabulated at 5 nm, cubic between (Lagrange through the four nearest rows, as CIE 15:2004,
/// section 7.2.1, recommends for interpolation of tables). Sums of the 5 nm rows from 380 to 780 nm
/// are the published 21.3715, 21.3713, 21.3715. Zero outside 360 to 830 nm.
ColourMatching colour_matching(double wavelength_nm);

enum class Illuminant {
    d65,  ///< daylight, S0 + M1 S1 + M2 S2 (CIE 15:2004, tables T.2; linear between 10 nm rows)
    e,    ///< equal energy
    a,    ///< tungsten, Planck at 2848 K with c2 = 1.435e-2 m K (ISO 11664-2, eq. 1)
};

/// Relative spectral power, 100 at 560 nm.
/// @throws std::invalid_argument  outside 360 to 830 nm
double relative_power(Illuminant illuminant, double wavelength_nm);

}  // namespace miebrdf
