// Tables of sweeps: values between their nodes. The functions of a build without libnetcdf name the
// missing package.
#include <map>
#include <string>
#include <vector>

#include <pybind11/stl.h>
#include "pipeline/io/netcdf_file.h"
#include "pipeline/sweep/netcdf/netcdf_table.h"
#include "tools/python/bindings.h"

namespace miebrdf::python {
namespace {

py::dict axis_facts(const sweep::StoredAxis& axis) {
    py::dict facts;
    facts["name"] = axis.name;
    facts["unit"] = axis.unit;
    if (axis.texts.empty()) {
        facts["values"] = array_of(axis.numbers);
    } else {
        facts["values"] = axis.texts;
    }
    return facts;
}

py::list look_up_table(const std::string& file, const std::vector<std::string>& variables,
                       const std::map<std::string, std::string>& asked,
                       const std::string& interpolation) {
    std::vector<sweep::LookedUp> found;
    {
        const py::gil_scoped_release others;
        const auto table = sweep::open_netcdf_table(file);
        const sweep::Interpolation order = sweep::parse_interpolation(interpolation);
        const auto values = sweep::named_values(*table, asked);
        for (const std::string& name : sweep::named_variables(*table, variables))
            found.push_back(sweep::look_up(*table, name, values, order));
    }
    py::list list;
    for (sweep::LookedUp& one : found) {
        std::vector<py::ssize_t> shape;
        py::list axes;
        for (const sweep::StoredAxis& axis : one.listed) {
            shape.push_back(static_cast<py::ssize_t>(axis.size()));
            axes.append(axis_facts(axis));
        }
        py::dict facts;
        facts["name"] = one.variable;
        facts["unit"] = one.unit;
        facts["axes"] = axes;
        facts["values"] = array_of(std::move(one.values)).reshape(shape);
        facts["errors"] = array_of(std::move(one.errors)).reshape(shape);
        list.append(facts);
    }
    return list;
}

}  // namespace

void bind_tables(py::module_& module) {
    module.def("has_netcdf", &has_netcdf);
    module.def("look_up_table", &look_up_table, py::arg("file"), py::arg("variables"),
               py::arg("asked"), py::arg("interpolation"));
}

}  // namespace miebrdf::python
