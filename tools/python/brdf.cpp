// Solved scenes: <miebrdf/brdf.h>, <miebrdf/sampling.h>, <miebrdf/plan.h>.
#include <miebrdf/brdf.h>
#include <miebrdf/colour.h>
#include <miebrdf/plan.h>
#include <miebrdf/sampling.h>
#include <miebrdf/value_derivatives.h>

#include <algorithm>
#include <string>
#include <utility>
#include <vector>

#include <pybind11/stl.h>
#include "tools/python/bindings.h"
#include "tools/python/brdf_table.h"
#include "tools/python/long_call.h"

namespace miebrdf::python {
namespace {

using Numbers = std::vector<double>;

py::dict facts_of(const WavelengthReport& report) {
    py::dict facts;
    facts["wavelength_nm"] = report.wavelength_nm;
    facts["converged"] = report.converged;
    facts["error_estimate"] = report.error_estimate;
    facts["mie_error_estimate"] = report.mie_error_estimate;
    facts["phase_noise"] = report.phase_noise.largest;
    facts["optical_depths"] = report.optical_depths;
    facts["stokes"] = report.stokes;
    facts["polarisation_left_out"] = report.polarisation_left_out;
    facts["streams"] = report.solver.streams;
    facts["moments"] = report.solver.moments;
    facts["fourier_orders"] = report.solver.fourier_orders;
    facts["iterations"] = report.solver.iterations;
    facts["share_within_tolerance"] = report.solver.share_within_tolerance;
    facts["method"] = report.solver.method;
    return facts;
}

py::dict facts_of(const ResultReport& report) {
    py::list wavelengths;
    for (const WavelengthReport& each : report.wavelengths) wavelengths.append(facts_of(each));
    py::dict facts;
    facts["tolerance"] = report.tolerance;
    facts["converged"] = report.converged();
    facts["error_estimate"] = report.error_estimate();
    facts["sources"] = report.sources;
    facts["notes"] = report.notes;
    facts["polarisation"] = report.polarisation();
    facts["shortfall"] = report.shortfall();
    facts["summary"] = report.summary();
    facts["wavelengths"] = wavelengths;
    return facts;
}

py::dict columns_of(const AlbedoValues& values, std::size_t cosines) {
    const auto table = [&](const std::vector<Numbers>& rows) -> py::object {
        if (rows.empty()) return py::none();
        Numbers all;
        for (const Numbers& row : rows) all.insert(all.end(), row.begin(), row.end());
        return array_of(std::move(all),
                        {static_cast<py::ssize_t>(rows.size()), static_cast<py::ssize_t>(cosines)});
    };
    py::dict columns;
    columns["plane_albedo"] = table(values.plane_albedo);
    columns["spherical_albedo"] = array_of(values.spherical_albedo);
    columns["plane_transmittance"] = table(values.plane_transmittance);
    columns["spherical_transmittance"] = values.spherical_transmittance.empty()
                                             ? py::object(py::none())
                                             : array_of(values.spherical_transmittance);
    columns["unscattered_transmittance"] = table(values.unscattered_transmittance);
    columns["mirror_reflectance"] = table(values.mirror_reflectance);
    return columns;
}

/// A scene at some wavelengths. Each call has threads, progress and cancellation of its own; what
/// single scattering they find is kept in the memo.
class SolvedScene {
  public:
    SolvedScene(Scene scene, Numbers wavelength_nm, SolverOptions solver)
        : scene_(std::move(scene)),
          wavelength_nm_(std::move(wavelength_nm)),
          solver_(solver),
          memo_(make_optics_memo()) {
        const py::gil_scoped_release unlocked;
        (void)brdf({.threads = 1});  // refuses what is wrong before anything is computed
    }

    /// @returns  (array of one wavelength's values after the other, report); the shape is
    ///           (wavelengths, mu_in, mu_out, azimuth_deg)
    py::tuple evaluate(const Numbers& mu_in, const Numbers& mu_out, const Numbers& azimuth_deg,
                       const std::string& part_name, const CallOptions& options) const {
        const BrdfPart part = parse_brdf_part(part_name);
        LongCall call(options);
        BrdfValues values = call.run([&] {
            const BrdfParts parts{part == BrdfPart::subsurface, part == BrdfPart::surface,
                                  part == BrdfPart::total};
            return brdf(call.control()).evaluate({mu_in, mu_out, azimuth_deg}, parts);
        });
        const auto length = [](const auto& list) { return static_cast<py::ssize_t>(list.size()); };
        const std::vector<py::ssize_t> shape = {length(wavelength_nm_), length(mu_in),
                                                length(mu_out), length(azimuth_deg)};
        const py::dict facts = facts_of(values);
        const auto of_part = [part](BrdfValues::Slice& slice) -> Numbers& {
            return part == BrdfPart::total        ? slice.total
                   : part == BrdfPart::subsurface ? slice.subsurface
                                                  : slice.surface;
        };
        // The library's own memory; more wavelengths are brought together, each freed at once.
        Numbers all = std::move(of_part(values.slices.front()));
        all.reserve(all.size() * values.slices.size());
        for (std::size_t w = 1; w < values.slices.size(); ++w) {
            const Numbers one = std::move(of_part(values.slices[w]));
            all.insert(all.end(), one.begin(), one.end());
        }
        return py::make_tuple(array_of(std::move(all), shape), facts);
    }

    /// @returns  as evaluate, the shape with (row, column) behind
    py::tuple mueller(const Numbers& mu_in, const Numbers& mu_out, const Numbers& azimuth_deg,
                      const CallOptions& options) const {
        LongCall call(options);
        const MuellerValues values = call.run([&] {
            return brdf(call.control()).mueller({mu_in, mu_out, azimuth_deg});
        });
        const auto length = [](const auto& list) { return static_cast<py::ssize_t>(list.size()); };
        const auto components = static_cast<py::ssize_t>(values.components);
        Numbers all;
        for (const Numbers& one : values.mueller) all.insert(all.end(), one.begin(), one.end());
        return py::make_tuple(
            array_of(std::move(all), {length(wavelength_nm_), length(mu_in), length(mu_out),
                                      length(azimuth_deg), components, components}),
            facts_of(values));
    }

    py::tuple albedo(const Numbers& mu_in, const CallOptions& options) const {
        LongCall call(options);
        const AlbedoValues values = call.run([&] { return brdf(call.control()).albedo(mu_in); });
        return py::make_tuple(columns_of(values, mu_in.size()), facts_of(values));
    }

    /// @returns  (gloss units at 20, 60 and 85 degrees, report)
    py::tuple gloss(const std::string& viewed, const CallOptions& options) const {
        LongCall call(options);
        const GlossValues values =
            call.run([&] { return miebrdf::gloss(brdf(call.control()), viewing(viewed)); });
        Numbers units;
        for (const Gloss& at : values.angles) units.push_back(at.units);
        return py::make_tuple(array_of(std::move(units)), facts_of(values));
    }

    /// @returns  (array, report) as evaluate, of the derivatives by the first parameter, the
    ///           second, ...: the first axis is (parameters x wavelengths)
    py::tuple evaluate_derivatives(const std::vector<std::string>& parameters, const Numbers& mu_in,
                                   const Numbers& mu_out, const Numbers& azimuth_deg,
                                   const std::string& part_name, const CallOptions& options) const {
        const BrdfPart part = parse_brdf_part(part_name);
        LongCall call(options);
        const auto all = call.run([&] {
            const BrdfParts parts{part == BrdfPart::subsurface, part == BrdfPart::surface,
                                  part == BrdfPart::total};
            return brdf(call.control())
                .derivatives(parameters)
                .evaluate({mu_in, mu_out, azimuth_deg}, parts);
        });
        Numbers values;
        for (const BrdfValues& derivative : all.derivatives) {
            for (const BrdfValues::Slice& slice : derivative.slices)
                values.insert(values.end(), slice.of(part).begin(), slice.of(part).end());
        }
        return derivatives_of(std::move(values), all);
    }

    /// @returns  the same of the reflectance factor under a sky; without parameters its values
    py::tuple hdrf(const std::vector<std::string>& parameters, const Numbers& mu_in,
                   const Numbers& mu_out, const Numbers& azimuth_deg, double diffuse_fraction,
                   const std::string& sky_name, const CallOptions& options) const {
        const Sky sky = miebrdf::sky(sky_name);
        LongCall call(options);
        const auto all = call.run([&] {
            return hdrf_derivatives(brdf(call.control()), parameters, {mu_in, mu_out, azimuth_deg},
                                    diffuse_fraction, sky);
        });
        Numbers values;
        const auto add = [&](const HdrfValues& one) {
            for (const Numbers& at : one.hdrf) values.insert(values.end(), at.begin(), at.end());
        };
        if (parameters.empty()) add(all.values);
        for (const HdrfValues& derivative : all.derivatives) add(derivative);
        return derivatives_of(std::move(values), all);
    }

    /// @returns  (columns of albedo for each parameter, report of the values)
    py::tuple albedo_derivatives(const std::vector<std::string>& parameters, const Numbers& mu_in,
                                 const CallOptions& options) const {
        LongCall call(options);
        const auto all =
            call.run([&] { return brdf(call.control()).derivatives(parameters).albedo(mu_in); });
        py::list columns;
        for (const AlbedoValues& derivative : all.derivatives)
            columns.append(columns_of(derivative, mu_in.size()));
        return py::make_tuple(columns, facts_of(all.values));
    }

    py::list layers(const CallOptions& options) const {
        LongCall call(options);
        const auto all = call.run([&] { return brdf(call.control()).layers(); });
        py::list list;
        for (const LayerOptics& layer : all) {
            py::dict facts;
            facts["wavelength_nm"] = wavelength_nm_[layer.wavelength];
            facts["layer"] = layer.layer;
            facts["optical_depth"] = layer.optical_depth;
            facts["single_scattering_albedo"] = layer.single_scattering_albedo;
            facts["asymmetry"] = layer.asymmetry;
            facts["scattering_per_um"] = layer.scattering_per_um;
            facts["absorption_per_um"] = layer.absorption_per_um;
            facts["reduced_scattering_per_um"] = layer.reduced_scattering_per_um;
            facts["k_km"] = layer.k_km;
            facts["s_km"] = layer.s_km;
            facts["mass_extinction_m2_per_kg"] = layer.mass_extinction_m2_per_kg;
            list.append(facts);
        }
        return list;
    }

    /// @param command  for what an export says of its origin; empty: the table of evaluate
    SolvedTable table(const std::string& part, const CallOptions& options, bool whole_matrix,
                      const std::string& command) const {
        LongCall call(options);
        return SolvedTable(call.run([&] {
            const Brdf solved = brdf(call.control());
            TableOptions wanted{.part = parse_brdf_part(part), .whole_matrix = whole_matrix};
            wanted.command_line = command;
            if (command.empty())
                wanted.coupling = solved.scene().coupling.value_or(rte::SurfaceCoupling::paper);
            return solved.table(wanted);
        }));
    }

    py::tuple plan(const Numbers& mu_in, const Numbers& mu_out, const Numbers& azimuth_deg) const {
        Plan plan;
        {
            const py::gil_scoped_release unlocked;
            plan = plan_evaluate(brdf({}), {mu_in, mu_out, azimuth_deg});
        }
        py::list steps, omissions;
        for (const PlannedStep& step : plan.steps)
            steps.append(py::make_tuple(step.stage, step.what, step.jobs, step.seconds));
        for (const Omission& omission : plan.omissions)
            omissions.append(py::make_tuple(omission.rule, omission.reason, omission.saved_s));
        return py::make_tuple(steps, omissions);
    }

    const Numbers& wavelength_nm() const { return wavelength_nm_; }

  private:
    template <typename Values>
    py::tuple derivatives_of(Numbers numbers, const WithDerivatives<Values>& all) const {
        const auto length = [](const auto& list) { return static_cast<py::ssize_t>(list.size()); };
        const auto& [mu_in, mu_out, azimuth_deg] = all.values.directions;
        return py::make_tuple(
            array_of(std::move(numbers),
                     {std::max(length(all.parameters), py::ssize_t{1}) * length(wavelength_nm_),
                      length(mu_in), length(mu_out), length(azimuth_deg)}),
            facts_of(all.values));
    }

    Brdf brdf(Control control) const {
        control.memo = memo_;
        return solve(scene_, wavelength_nm_, solver_, control);
    }

    Scene scene_;
    Numbers wavelength_nm_;
    SolverOptions solver_;
    std::shared_ptr<OpticsMemo> memo_;
};

void bind_solver_options(py::module_& module) {
    py::enum_<rte::GridKind>(module, "Grid")
        .value("auto", rte::GridKind::automatic)
        .value("gauss", rte::GridKind::gauss)
        .value("mapped_gauss", rte::GridKind::mapped_gauss)
        .value("paper", rte::GridKind::paper);
    py::enum_<rte::HalfSpaceMethod>(module, "HalfSpaceMethod")
        .value("auto", rte::HalfSpaceMethod::automatic)
        .value("fixed_point", rte::HalfSpaceMethod::fixed_point)
        .value("doubling", rte::HalfSpaceMethod::doubling);
    py::enum_<rte::CoatMethod>(module, "CoatMethod")
        .value("auto", rte::CoatMethod::automatic)
        .value("first_order", rte::CoatMethod::first_order)
        .value("first_order_patched", rte::CoatMethod::first_order_patched)
        .value("exponential", rte::CoatMethod::exponential);
    py::class_<SolverOptions>(module, "SolverOptions")
        .def(py::init<>())
        .def_readwrite("tolerance", &SolverOptions::tolerance)
        .def_readwrite("grid", &SolverOptions::grid)
        .def_readwrite("streams", &SolverOptions::streams)
        .def_readwrite("stokes", &SolverOptions::stokes)
        .def_readwrite("half_space_method", &SolverOptions::half_space_method)
        .def_readwrite("coat_method", &SolverOptions::coat_method)
        .def_readwrite("coat_substeps", &SolverOptions::coat_substeps)
        .def_readwrite("delta_m", &SolverOptions::delta_m)
        .def_readwrite("single_scattering_correction",
                       &SolverOptions::single_scattering_correction);
}

}  // namespace

void bind_brdf(py::module_& module) {
    bind_solver_options(module);
    py::class_<SolvedScene>(module, "SolvedScene")
        .def(py::init<Scene, Numbers, SolverOptions>(), py::arg("scene"), py::arg("wavelength_nm"),
             py::arg("solver"))
        .def("evaluate", &SolvedScene::evaluate, py::arg("mu_in"), py::arg("mu_out"),
             py::arg("azimuth_deg"), py::arg("part"), py::arg("options"))
        .def("mueller", &SolvedScene::mueller, py::arg("mu_in"), py::arg("mu_out"),
             py::arg("azimuth_deg"), py::arg("options"))
        .def("albedo", &SolvedScene::albedo, py::arg("mu_in"), py::arg("options"))
        .def("gloss", &SolvedScene::gloss, py::arg("viewed"), py::arg("options"))
        .def("evaluate_derivatives", &SolvedScene::evaluate_derivatives, py::arg("parameters"),
             py::arg("mu_in"), py::arg("mu_out"), py::arg("azimuth_deg"), py::arg("part"),
             py::arg("options"))
        .def("hdrf", &SolvedScene::hdrf, py::arg("parameters"), py::arg("mu_in"), py::arg("mu_out"),
             py::arg("azimuth_deg"), py::arg("diffuse_fraction"), py::arg("sky"),
             py::arg("options"))
        .def("albedo_derivatives", &SolvedScene::albedo_derivatives, py::arg("parameters"),
             py::arg("mu_in"), py::arg("options"))
        .def("layers", &SolvedScene::layers, py::arg("options"))
        .def("table", &SolvedScene::table, py::arg("part"), py::arg("options"),
             py::arg("whole_matrix") = false, py::arg("command") = "")
        .def("plan", &SolvedScene::plan, py::arg("mu_in"), py::arg("mu_out"),
             py::arg("azimuth_deg"));
    py::class_<SolvedTable>(module, "SolvedTable")
        .def("evaluate", &SolvedTable::evaluate, py::arg("mu_in"), py::arg("mu_out"),
             py::arg("azimuth_deg"), py::arg("out"), py::arg("options"))
        .def("sampler", &SolvedTable::sampler, py::arg("weights"), py::arg("options"))
        .def_property_readonly(
            "report", [](const SolvedTable& self) { return facts_of(self.table().report()); })
        .def_property_readonly(
            "version", [](const SolvedTable& self) { return self.table().provenance().version; });
    bind_sampler(module);
}

}  // namespace miebrdf::python
