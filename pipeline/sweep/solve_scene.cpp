// The values of one scene.
#include <fmt/format.h>
#include <miebrdf/error.h>

#include <algorithm>
#include <cmath>
#include <limits>

#include "pipeline/sweep/layout.h"

namespace miebrdf::sweep {
namespace {

constexpr double kNone = std::numeric_limits<double>::quiet_NaN();

/// Copies the values of a variable to their place in a scene's record.
class Record {
  public:
    Record(const Layout& layout, SceneResult& result) : layout_(layout), result_(result) {
        result_.values.assign(layout.record, kNone);
        result_.converged = true;
    }

    void set(const std::string& name, std::size_t first, const std::vector<double>& values) {
        const Variable& variable = *layout_.find(name);
        std::copy(values.begin(), values.end(),
                  result_.values.begin() + std::ptrdiff_t(variable.offset + first));
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
    const Layout& layout_;
    SceneResult& result_;
};

void set_brdf(const BrdfValues& values, const std::string& name, Record& record) {
    for (std::size_t w = 0; w < values.slices.size(); ++w)
        record.set(name, w * values.slices[w].total.size(), values.slices[w].total);
}

void add_brdf(const Brdf& brdf, const Sweep& sweep, Record& record) {
    const BrdfParts parts{.subsurface = false, .surface = false, .total = true};
    const auto all = [&]() -> WithDerivatives<BrdfValues> {
        if (sweep.derivatives.empty()) return {brdf.evaluate(sweep.directions(), parts), {}, {}};
        return brdf.derivatives(sweep.derivatives).evaluate(sweep.directions(), parts);
    }();
    set_brdf(all.values, "brdf", record);
    for (std::size_t p = 0; p < all.derivatives.size(); ++p)
        set_brdf(all.derivatives[p], derivative_name("brdf", all.parameters[p]), record);
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
            record.set(name, w * of_element.size(), of_element);
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
        record.set("X", i, {colour.xyz.x});
        record.set("Y", i, {colour.xyz.y});
        record.set("Z", i, {colour.xyz.z});
        record.set("L_star", i, {colour.lab.l});
        record.set("a_star", i, {colour.lab.a});
        record.set("b_star", i, {colour.lab.b});
    }
}

/// @param spell  the variable's name
template <typename Spell>
void set_albedos(const AlbedoValues& values, const Sweep& sweep, const Spell& spell,
                 Record& record) {
    const std::size_t in = values.mu_in.size();
    const auto set = [&](Output output, std::size_t first, const std::vector<double>& list) {
        if (sweep.wants(output)) record.set(spell(name_of(output)), first, list);
    };
    for (std::size_t w = 0; w < values.spherical_albedo.size(); ++w) {
        set(Output::plane_albedo, w * in, values.plane_albedo[w]);
        set(Output::spherical_albedo, w, {values.spherical_albedo[w]});
        if (values.spherical_transmittance.empty()) continue;
        set(Output::plane_transmittance, w * in, values.plane_transmittance[w]);
        set(Output::spherical_transmittance, w, {values.spherical_transmittance[w]});
    }
}

void add_albedos(const Sweep& sweep, const Brdf& brdf, Record& record) {
    const std::vector<double> mu_in = sweep.directions().mu_in;
    const auto all = [&]() -> WithDerivatives<AlbedoValues> {
        if (sweep.derivatives.empty()) return {brdf.albedo(mu_in), {}, {}};
        return brdf.derivatives(sweep.derivatives).albedo(mu_in);
    }();
    set_albedos(
        all.values, sweep, [](const std::string& name) { return name; }, record);
    for (std::size_t p = 0; p < all.derivatives.size(); ++p) {
        set_albedos(
            all.derivatives[p], sweep,
            [&](const std::string& name) { return derivative_name(name, all.parameters[p]); },
            record);
    }
    if (sweep.wants(Output::colour)) add_colours(all.values, sweep.viewing, record);
    record.add(all.values);
}

}  // namespace

void require_transmittance(const Sweep& sweep, const Request& request) {
    const bool is_wanted =
        sweep.wants(Output::plane_transmittance) || sweep.wants(Output::spherical_transmittance);
    if (!is_wanted) return;
    const Scene& scene = request.scene;
    if (!scene.substrate || scene.surface ||
        request.solver.coat_method != rte::CoatMethod::automatic) {
        throw UsageError(
            "there is no transmittance of this scene; it needs a substrate in place of "
            "the base, no rough surface, and the automatic coat method");
    }
}

SceneResult solve_scene(const Sweep& sweep, const Layout& layout, std::size_t scene,
                        const Control& control) {
    SceneResult result;
    Record record(layout, result);
    try {
        const Request request = request_of(sweep, scene);
        require_transmittance(sweep, request);
        const Brdf brdf = solve(request.scene, sweep.wavelength.numbers, request.solver, control);
        if (sweep.wants(Output::brdf)) add_brdf(brdf, sweep, record);
        if (sweep.wants(Output::mueller)) add_mueller(brdf, sweep.directions(), layout, record);
        if (sweep.wants_albedos()) add_albedos(sweep, brdf, record);
        return result;
    } catch (const Cancelled&) {
        throw;
    } catch (const std::bad_alloc&) {
        result.remark = "failed: not enough memory";
    } catch (const std::exception& error) {
        result.remark = fmt::format("failed: {}", error.what());
    }
    std::fill(result.values.begin(), result.values.end(), kNone);
    result.error_estimate = kNone;
    result.converged = false;
    return result;
}

}  // namespace miebrdf::sweep
