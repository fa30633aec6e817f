// Charts over wavelength, and the phase function over the scattering angle.
#pragma once

#include <string>
#include <vector>

#include "pipeline/plot/chart.h"
#include "pipeline/plot/picture.h"

namespace miebrdf::plot {

/// One quantity against wavelength.
struct Spectrum {
    std::string label;
    std::vector<double> wavelength_nm, value;
    std::optional<LinearSrgb> swatch = {};  ///< the colour of it, shown in the legend
    std::optional<double> shade = {};       ///< of the members of a family (panel.h)
    Mark mark = Mark::line;
    std::optional<int> colour = {};  ///< as of a curve; empty: next in order
};

/// Albedos, or a BRDF in a few directions.
/// @param value_label  with its unit, e.g. "albedo" or "BRDF [1/sr]"
Picture draw_spectrum(const std::vector<Spectrum>& spectra, const std::string& value_label,
                      const Caption& caption, Scale scale = Scale::linear);

struct IndexCurve {
    std::string label;
    std::vector<double> wavelength_nm, n, k;
};

/// n above, k below on a logarithmic scale; a k of 0 everywhere is said in the legend, not drawn.
Picture draw_nk(std::vector<IndexCurve> materials, const Caption& caption);

struct OpticsCurve {
    std::string label;
    std::vector<double> wavelength_nm, single_scattering_albedo, asymmetry, q_ext;
    std::optional<double> shade = {};
};

/// Albedo, asymmetry and extinction efficiency under each other. q_ext may be empty.
Picture draw_optics(const std::vector<OpticsCurve>& media, const Caption& caption);

struct PhaseCurve {
    std::string label;
    std::vector<double> angle_deg, phase;  ///< angles in [0, 180]
    std::optional<double> shade = {};
};

/// Against the scattering angle, on a logarithmic scale.
Picture draw_phase(const std::vector<PhaseCurve>& curves, const Caption& caption);

/// Around the particle: light comes from the left, the radius is the logarithm of P.
/// @param decades  below the power of ten above the largest value, 1 to 12, smaller values lying in
///        the centre; 0: as many as the smallest value needs
Picture draw_phase_polar(const std::vector<PhaseCurve>& curves, const Caption& caption,
                         int decades = 0);

}  // namespace miebrdf::plot
