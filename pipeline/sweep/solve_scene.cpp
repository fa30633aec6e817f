// The values of one scene.
#include <fmt/format.h>
#include <miebrdf/error.h>

#include <algorithm>
#include <cmath>
#include <limits>

#include <miebrdf/value_derivatives.h>
#include "pipeline/solve/optics_memo.h"
#include "pipeline/sweep/layout.h"

namespace miebrdf::sweep {
namespace {

constexpr double kNone = std::numeric_limits<double>::quiet_NaN();

/// Copies the values of a variable to their place in a scene's record.
class Record {
  public:
    /// @param places  of the wavelengths that values are given of
    Record(const Layout& layout, const std::vector<std::size_t>& places, SceneResult& result)
        : layout_(layout), places_(places), result_(result) {}

    /// All values of a variable at one wavelength.
    void set(const std::string& name, std::size_t wavelength, const std::vector<double>& values) {
        copy(name, places_[wavelength] * values.size(), values);
    }
    /// One of a variable that has no wavelengths.
    void set_of_spectrum(const std::string& name, std::size_t index, double value) {
        copy(name, index, {value});
    }

    /// Adds what an evaluation says about itself.
    void add(const ResultReport& report) {
        result_.error_estimate = std::max(result_.error_estimate, report.error_estimate());
        if (report.converged()) return;
        result_.converged = false;
        result_.remark = "not converged: " + report.shortfall();
        std::replace(result_.remark.begin(), result_.remark.end(), '\n', ' ');
    }

  private:
    void copy(const std::string& name, std::size_t first, const std::vector<double>& values) {
        const Variable& variable = *layout_.find(name);
        std::copy(values.begin(), values.end(),
                  result_.values.begin() + std::ptrdiff_t(variable.offset + first));
    }

    const Layout& layout_;
    const std::vector<std::size_t>& places_;
    SceneResult& result_;
};

/// What is computed together: all of a scene, or what can be of one.
struct Part {
    const Sweep& sweep;
    const Layout& layout;
    std::vector<std::string> derivatives;
    bool is_whole;  ///< all wavelengths
};

void set_brdf(const BrdfValues& values, const std::string& name, Record& record) {
    for (std::size_t w = 0; w < values.slices.size(); ++w)
        record.set(name, w, values.slices[w].total);
}

void add_brdf(const Brdf& brdf, const Part& part, Record& record) {
    const BrdfParts parts{.subsurface = false, .surface = false, .total = true};
    const Directions directions = part.sweep.directions();
    const auto all = [&]() -> WithDerivatives<BrdfValues> {
        if (part.derivatives.empty()) return {brdf.evaluate(directions, parts), {}, {}};
        return brdf.derivatives(part.derivatives).evaluate(directions, parts);
    }();
    set_brdf(all.values, "brdf", record);
    for (std::size_t p = 0; p < all.derivatives.size(); ++p)
        set_brdf(all.derivatives[p], derivative_name("brdf", all.parameters[p]), record);
    record.add(all.values);
}

void add_hdrf(const Brdf& brdf, const Part& part, Record& record) {
    const Directions directions = part.sweep.directions();
    const double share = part.sweep.diffuse_fraction;
    const auto all = hdrf_derivatives(brdf, part.derivatives, directions, share, part.sweep.sky);
    for (std::size_t w = 0; w < all.values.hdrf.size(); ++w) {
        record.set("hdrf", w, all.values.hdrf[w]);
        for (std::size_t p = 0; p < all.derivatives.size(); ++p)
            record.set(derivative_name("hdrf", all.parameters[p]), w, all.derivatives[p].hdrf[w]);
    }
    record.add(all.values);
}

/// Elements that this scene does not have stay not-a-number.
void add_mueller(const Brdf& brdf, const Directions& directions, const Layout& layout,
                 Record& record) {
    const MuellerValues values = brdf.mueller(directions);
    const auto elements = static_cast<std::size_t>(values.components * values.components);
    for (std::size_t w = 0; w < values.mueller.size(); ++w) {
        for (std::size_t e = 0; e < elements; ++e) {
            const int row = int(e) / values.components, column = int(e) % values.components;
            const std::string name = mueller_name(row, column);
            if (layout.find(name) == nullptr) continue;
            std::vector<double> of_element;
            for (std::size_t i = e; i < values.mueller[w].size(); i += elements)
                of_element.push_back(values.mueller[w][i]);
            record.set(name, w, of_element);
        }
    }
    record.add(values);
}

void add_colours(const AlbedoValues& values, const Viewing& viewing, Record& record) {
    const Colorimeter colorimeter(
        [&] {
            std::vector<double> wavelength_nm;
            for (const WavelengthReport& report : values.wavelengths)
                wavelength_nm.push_back(report.wavelength_nm);
            return wavelength_nm;
        }(),
        viewing);
    for (std::size_t i = 0; i < std::max<std::size_t>(values.mu_in.size(), 1); ++i) {
        std::vector<double> spectrum = values.spherical_albedo;
        for (std::size_t w = 0; w < spectrum.size() && !values.mu_in.empty(); ++w)
            spectrum[w] = values.plane_albedo[w][i];
        const Colour colour = colorimeter(spectrum);
        record.set_of_spectrum("X", i, colour.xyz.x);
        record.set_of_spectrum("Y", i, colour.xyz.y);
        record.set_of_spectrum("Z", i, colour.xyz.z);
        record.set_of_spectrum("L_star", i, colour.lab.l);
        record.set_of_spectrum("a_star", i, colour.lab.a);
        record.set_of_spectrum("b_star", i, colour.lab.b);
    }
}

/// A scene without a film hides what lies below it.
void add_contrast_ratios(const Request& request, const Sweep& sweep, const Control& control,
                         Record& record) {
    const std::vector<double> mu_in = sweep.directions().mu_in;
    const std::size_t count = std::max<std::size_t>(mu_in.size(), 1);
    if (!request.scene.substrate) {
        for (std::size_t i = 0; i < count; ++i) record.set_of_spectrum("contrast_ratio", i, 1.0);
        return;
    }
    const Drawdown film = draw_down(request.scene, sweep.wavelength.numbers, mu_in,
                                    {.hiding_contrast_ratio = 0.0, .viewing = sweep.viewing},
                                    request.solver, control);
    for (std::size_t i = 0; i < count; ++i)
        record.set_of_spectrum("contrast_ratio", i, film.hiding[i].contrast_ratio);
    record.add(film.over_dark);
    record.add(film.over_light);
}

/// @param all    1; of derivatives 0
/// @param spell  the variable's name
template <typename Spell>
void set_albedos(const AlbedoValues& values, const Sweep& sweep, double all, const Spell& spell,
                 Record& record) {
    const auto set = [&](Output output, std::size_t w, const std::vector<double>& list) {
        if (sweep.wants(output)) record.set(spell(name_of(output)), w, list);
    };
    for (std::size_t w = 0; w < values.spherical_albedo.size(); ++w) {
        set(Output::plane_albedo, w, values.plane_albedo[w]);
        set(Output::spherical_albedo, w, {values.spherical_albedo[w]});
        std::vector<double> emissivity = values.plane_albedo[w];
        for (double& value : emissivity) value = all - value;
        set(Output::emissivity, w, emissivity);
        if (values.spherical_transmittance.empty()) continue;
        set(Output::plane_transmittance, w, values.plane_transmittance[w]);
        set(Output::spherical_transmittance, w, {values.spherical_transmittance[w]});
    }
}

void add_albedos(const Brdf& brdf, const Part& part, Record& record) {
    const Sweep& sweep = part.sweep;
    const std::vector<double> mu_in = sweep.directions().mu_in;
    const auto all = [&]() -> WithDerivatives<AlbedoValues> {
        if (part.derivatives.empty()) return {brdf.albedo(mu_in), {}, {}};
        return brdf.derivatives(part.derivatives).albedo(mu_in);
    }();
    set_albedos(
        all.values, sweep, 1.0, [](const std::string& name) { return name; }, record);
    for (std::size_t p = 0; p < all.derivatives.size(); ++p) {
        set_albedos(
            all.derivatives[p], sweep, 0.0,
            [&](const std::string& name) { return derivative_name(name, all.parameters[p]); },
            record);
    }
    if (sweep.wants(Output::colour) && part.is_whole)
        add_colours(all.values, sweep.viewing, record);
    record.add(all.values);
}

}  // namespace

void require_transmittance(const Sweep& sweep, const Request& request) {
    if (sweep.wants(Output::emissivity) && request.scene.substrate &&
        request.scene.substrate->kind == Substrate::Kind::none)
        throw UsageError(
            "a free film has no emissivity by its albedo alone: light passes it; give a base or "
            "another substrate");
    const bool is_wanted =
        sweep.wants(Output::plane_transmittance) || sweep.wants(Output::spherical_transmittance);
    if (!is_wanted) return;
    const Scene& scene = request.scene;
    if (!scene.substrate || scene.surface ||
        request.solver.coat_method != rte::CoatMethod::automatic) {
        throw UsageError(
            "this scene has no transmittance; a transmittance needs a substrate in place of the "
            "base, no rough surface, and the automatic coat method");
    }
}

SceneResult solve_scene(const Sweep& sweep, const Layout& layout, std::size_t scene,
                        const Control& control) {
    SceneResult result;
    result.values.assign(layout.record, kNone);
    result.converged = true;
    std::string why;
    std::vector<std::size_t> missing, without_derivatives;
    const auto miss = [&](std::size_t place, const char* reason, std::vector<std::size_t>& list) {
        if (why.empty()) why = reason;
        list.push_back(place);
    };
    try {
        const SceneLookUp found =
            look_up(sweep, scene, control.memo != nullptr ? &control.memo->names() : nullptr);
        for (const Refusal& refusal : found.refusals) {
            for (const std::size_t place : refusal.wavelengths)
                miss(place, refusal.reason.c_str(), missing);
        }
        const auto use = [&](const std::vector<std::size_t>& places,
                             const std::vector<std::string>& derivatives) {
            const Request& request = found.request;
            const Brdf brdf =
                solve(request.scene, wavelengths_at(sweep, places), request.solver, control);
            const Part part{sweep, layout, derivatives, places.size() == sweep.wavelength.size()};
            Record record(layout, places, result);
            if (sweep.wants(Output::brdf)) add_brdf(brdf, part, record);
            if (sweep.wants(Output::hdrf)) add_hdrf(brdf, part, record);
            if (sweep.wants(Output::mueller)) add_mueller(brdf, sweep.directions(), layout, record);
            if (sweep.wants_albedos()) add_albedos(brdf, part, record);
            if (sweep.wants(Output::contrast_ratio) && part.is_whole)
                add_contrast_ratios(request, sweep, control, record);
        };
        use_wavelengths(
            found.wavelengths,
            [&](const std::vector<std::size_t>& places) { use(places, sweep.derivatives); },
            [&](std::size_t place, const Error& error) {
                if (sweep.derivatives.empty()) return miss(place, error.what(), missing);
                use_wavelengths(
                    {place}, [&](const std::vector<std::size_t>& places) { use(places, {}); },
                    [&](std::size_t, const Error& alone) { miss(place, alone.what(), missing); });
                if (missing.empty() || missing.back() != place)
                    miss(place, error.what(), without_derivatives);
            });
    } catch (const Cancelled&) {
        throw;
    } catch (const std::exception& error) {  // of memory, say
        why = dynamic_cast<const std::bad_alloc*>(&error) != nullptr ? "not enough memory"
                                                                     : error.what();
        missing.resize(sweep.wavelength.size());
        std::fill(result.values.begin(), result.values.end(), kNone);
    }
    if (why.empty()) return result;
    result.converged = false;
    result.missing_wavelengths = missing.size() + without_derivatives.size();
    if (missing.size() == sweep.wavelength.size()) {
        result.remark = "failed: " + why;
        result.error_estimate = kNone;
        return result;
    }
    std::sort(missing.begin(), missing.end());
    result.remark =
        missing.empty()
            ? fmt::format("no derivatives at {}: {}",
                          describe_wavelengths(sweep, without_derivatives), why)
            : fmt::format("failed at {}: {}", describe_wavelengths(sweep, missing), why);
    return result;
}

}  // namespace miebrdf::sweep
