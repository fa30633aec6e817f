#include "pipeline/sweep/layout.h"

#include <fmt/format.h>

#include <algorithm>

#include "pipeline/sweep/axis_values.h"

namespace miebrdf::sweep {
namespace {

class LayoutBuilder {
  public:
    void add(const std::string& name, const std::string& long_name, const std::string& unit,
             const std::vector<const Axis*>& axes) {
        Variable variable{name, long_name, unit, axes, layout_.record, 1};
        for (const Axis* axis : axes) variable.size *= axis->size();
        layout_.record += variable.size;
        layout_.variables.push_back(std::move(variable));
    }
    /// The same, and its derivatives.
    void add_with_derivatives(const std::string& name, const std::string& long_name,
                              const std::string& unit, const std::vector<const Axis*>& axes,
                              const Sweep& sweep) {
        add(name, long_name, unit, axes);
        for (const std::string& parameter : sweep.derivatives) {
            const Axis* axis = sweep.find_axis(parameter);
            add(derivative_name(name, parameter),
                fmt::format("derivative of {} by {}", name, parameter),
                quotient_of_units(unit, axis != nullptr ? axis->unit : unit_in(parameter)), axes);
        }
    }
    Layout finished() { return std::move(layout_); }

  private:
    Layout layout_;
};

void add_of_spectra(LayoutBuilder& builder, const Sweep& sweep, Output output) {
    const bool plane = sweep.incidence.size() > 0;
    const std::vector<const Axis*> axes =
        plane ? std::vector<const Axis*>{&sweep.incidence} : std::vector<const Axis*>{};
    const std::string of = std::string(" of the ") + (plane ? "plane" : "spherical") + " albedo, " +
                           describe(sweep.viewing);
    if (output == Output::contrast_ratio)
        return builder.add("contrast_ratio", "Y over black by Y over a white of 0.8," + of, "1",
                           axes);
    for (const char* name : {"X", "Y", "Z"})
        builder.add(name, std::string("tristimulus value ") + name + of, "1", axes);
    for (const char* name : {"L_star", "a_star", "b_star"})
        builder.add(name, std::string("CIE 1976 ") + name + of, "1", axes);
}

int components_of(const Sweep& sweep) { return request_of(sweep, 0).solver.stokes == 4 ? 4 : 3; }

/// Planes and signs: docs/polarisation.md.
std::string mueller_title(int row, int column) {
    return std::string("Mueller matrix of the BRDF, ") + "IQUV"[row] + " outgoing of " +
           "IQUV"[column] +
           " incident; Q = parallel minus perpendicular to the meridian plane of each ray";
}

}  // namespace

std::string mueller_name(int row, int column) {
    return "m" + std::to_string(row + 1) + std::to_string(column + 1);
}

std::string derivative_name(const std::string& variable, const std::string& parameter) {
    return variable + "_d_" + parameter;
}

const Variable* Layout::find(const std::string& name) const {
    for (const Variable& variable : variables) {
        if (variable.name == name) return &variable;
    }
    return nullptr;
}

Layout layout_of(const Sweep& sweep) {
    const Axis *w = &sweep.wavelength, *in = &sweep.incidence, *out = &sweep.reflection;
    LayoutBuilder builder;
    const auto add = [&](const std::string& name, const std::string& long_name,
                         const std::string& unit, const std::vector<const Axis*>& axes) {
        builder.add_with_derivatives(name, long_name, unit, axes, sweep);
    };
    for (const Output output : sweep.outputs) {
        switch (output) {
            case Output::brdf:
                add("brdf", "bidirectional reflectance distribution function", "sr-1",
                    {w, in, out, &sweep.azimuth});
                break;
            case Output::plane_albedo:
                add("plane_albedo", "plane albedo (directional-hemispherical reflectance)", "1",
                    {w, in});
                break;
            case Output::spherical_albedo:
                add("spherical_albedo", "spherical albedo (bihemispherical reflectance)", "1", {w});
                break;
            case Output::plane_transmittance:
                add("plane_transmittance", "net flux into the substrate", "1", {w, in});
                break;
            case Output::spherical_transmittance:
                add("spherical_transmittance", "net flux into the substrate, of uniform light", "1",
                    {w});
                break;
            case Output::colour:
            case Output::contrast_ratio:
                add_of_spectra(builder, sweep, output);
                break;
            case Output::hdrf:
                add("hdrf", "hemispherical-directional reflectance factor under sun and sky", "1",
                    {w, in, out, &sweep.azimuth});
                break;
            case Output::emissivity:
                add("emissivity", "emissivity towards the direction of mu_in", "1", {w, in});
                break;
            case Output::mueller: {
                const int components = components_of(sweep);
                for (int row = 0; row < components; ++row) {
                    for (int column = 0; column < components; ++column) {
                        builder.add(mueller_name(row, column), mueller_title(row, column), "sr-1",
                                    {w, in, out, &sweep.azimuth});
                    }
                }
            }
        }
    }
    return builder.finished();
}

std::vector<const Axis*> asked_axes(const Sweep& sweep) {
    std::vector<const Axis*> axes;
    for (const Axis* axis :
         {&sweep.wavelength, &sweep.incidence, &sweep.reflection, &sweep.azimuth}) {
        if (axis->size() > 0) axes.push_back(axis);
    }
    // A colour takes all wavelengths together.
    if (std::all_of(sweep.outputs.begin(), sweep.outputs.end(), [](Output output) {
            return output == Output::colour || output == Output::contrast_ratio;
        }))
        axes.erase(axes.begin());
    return axes;
}

}  // namespace miebrdf::sweep
