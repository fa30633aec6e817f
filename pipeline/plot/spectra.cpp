#include "pipeline/plot/spectra.h"

#include <algorithm>

namespace miebrdf::plot {
namespace {

AxisOptions wavelength_axis() { return {"vacuum wavelength [nm]", Scale::linear}; }

bool any_positive(const std::vector<double>& values) {
    return std::any_of(values.begin(), values.end(), [](double v) { return v > 0; });
}

}  // namespace

Picture draw_spectrum(const std::vector<Spectrum>& spectra, const std::string& value_label,
                      const Caption& caption, Scale scale) {
    Panel panel{wavelength_axis(), {value_label, scale}, {}, 260.0};
    for (const Spectrum& s : spectra) {
        panel.curves.push_back(
            {s.label, s.wavelength_nm, s.value, s.mark, s.colour, s.swatch, s.shade});
    }
    return draw_chart({panel}, caption);
}

Picture draw_nk(std::vector<IndexCurve> materials, const Caption& caption) {
    Panel n{wavelength_axis(), {"n", Scale::linear}, {}, 170.0};
    Panel k{wavelength_axis(), {"k", Scale::logarithmic}, {}, 170.0};
    int colour = 0;
    for (IndexCurve& material : materials) {
        const bool absorbs = any_positive(material.k);
        if (!absorbs) material.label += " (k = 0)";
        n.curves.push_back(
            {material.label, material.wavelength_nm, material.n, Mark::line, colour, {}});
        if (absorbs)
            k.curves.push_back(
                {material.label, material.wavelength_nm, material.k, Mark::line, colour, {}});
        ++colour;
    }
    // The panels share their wavelengths, also where only some of the materials absorb.
    for (const Curve& curve : n.curves) {
        for (const double nm : curve.x) {
            k.x.lowest = std::min(k.x.lowest.value_or(nm), nm);
            k.x.highest = std::max(k.x.highest.value_or(nm), nm);
        }
    }
    return k.curves.empty() ? draw_chart({n}, caption) : draw_chart({n, k}, caption);
}

Picture draw_optics(const std::vector<OpticsCurve>& media, const Caption& caption) {
    Panel albedo{wavelength_axis(), {"single-scatt. albedo", Scale::linear}, {}, 150.0};
    Panel asymmetry{wavelength_axis(), {"asymmetry g", Scale::linear}, {}, 150.0};
    Panel extinction{wavelength_axis(), {"Q_ext", Scale::linear}, {}, 150.0};
    int colour = 0;
    for (const OpticsCurve& m : media) {
        albedo.curves.push_back({m.label,
                                 m.wavelength_nm,
                                 m.single_scattering_albedo,
                                 Mark::line,
                                 colour,
                                 {},
                                 m.shade});
        asymmetry.curves.push_back(
            {m.label, m.wavelength_nm, m.asymmetry, Mark::line, colour, {}, m.shade});
        if (!m.q_ext.empty()) {
            extinction.curves.push_back(
                {m.label, m.wavelength_nm, m.q_ext, Mark::line, colour, {}, m.shade});
        }
        ++colour;
    }
    std::vector<Panel> panels{albedo, asymmetry};
    if (!extinction.curves.empty()) panels.push_back(extinction);
    return draw_chart(panels, caption);
}

Picture draw_phase(const std::vector<PhaseCurve>& curves, const Caption& caption) {
    Panel panel{{"scattering angle [\u00b0]", Scale::linear, 0.0, 180.0, 30.0},
                {"phase function (mean 1)", Scale::logarithmic},
                {},
                260.0};
    for (const PhaseCurve& curve : curves) {
        panel.curves.push_back(
            {curve.label, curve.angle_deg, curve.phase, Mark::line, {}, {}, curve.shade});
    }
    return draw_chart({panel}, caption);
}

}  // namespace miebrdf::plot
