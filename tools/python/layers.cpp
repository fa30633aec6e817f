// Many layers of analytic media: <miebrdf/layer_albedos.h>.
#include <miebrdf/layer_albedos.h>

#include <span>
#include <utility>

#include "tools/python/bindings.h"
#include "tools/python/long_call.h"

namespace miebrdf::python {
namespace {

/// float64 without gaps: its memory is read where it is.
using Values = py::array_t<double, py::array::c_style | py::array::forcecast>;

std::span<const double> values_of(const Values& values) {
    return {values.data(), static_cast<std::size_t>(values.size())};
}

py::dict solve_layers(const Values& single_scattering_albedo, const Values& asymmetry,
                      const Values& optical_depth, const Values& host_index,
                      const Values& ground_albedo, const Values& mu_in,
                      const rte::SolverOptions& solver, const CallOptions& options) {
    const LayerBatch batch{values_of(single_scattering_albedo),
                           values_of(asymmetry),
                           values_of(optical_depth),
                           values_of(host_index),
                           values_of(ground_albedo),
                           values_of(mu_in)};
    LongCall call(options);
    LayerAlbedos all = call.run([&] { return layer_albedos(batch, solver, call.control()); });
    py::dict columns;
    columns["plane_albedo"] = array_of(std::move(all.plane_albedo));
    columns["spherical_albedo"] = array_of(std::move(all.spherical_albedo));
    columns["plane_transmittance"] = array_of(std::move(all.plane_transmittance));
    columns["error_estimate"] = array_of(std::move(all.error_estimate));
    columns["converged"] = array_of(std::move(all.converged));
    return columns;
}

using BatchFunction = std::vector<double> (*)(std::span<const double>, std::span<const double>,
                                              std::span<const double>, const rte::SolverOptions&,
                                              const Control&);

template <BatchFunction function>
py::array solve_subsurface(const Values& values, const Values& asymmetry, const Values& host_index,
                           const rte::SolverOptions& solver, const CallOptions& options) {
    LongCall call(options);
    return array_of(call.run([&] {
        return function(values_of(values), values_of(asymmetry), values_of(host_index), solver,
                        call.control());
    }));
}

}  // namespace

void bind_layers(py::module_& module) {
    module.def("layer_albedos", &solve_layers, py::arg("single_scattering_albedo"),
               py::arg("asymmetry"), py::arg("optical_depth"), py::arg("host_index"),
               py::arg("ground_albedo"), py::arg("mu_in"), py::arg("solver"), py::arg("options"));
    const auto subsurface = [&](const char* name, auto function, const char* values) {
        module.def(name, function, py::arg(values), py::arg("asymmetry"), py::arg("host_index"),
                   py::arg("solver"), py::arg("options"));
    };
    subsurface("subsurface_colour", &solve_subsurface<subsurface_colour>,
               "single_scattering_albedo");
    subsurface("subsurface_albedo", &solve_subsurface<subsurface_albedo>, "colour");
}

}  // namespace miebrdf::python
