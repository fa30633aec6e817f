// The binding files share this. Each of them binds one area of the public C++ API as the private
// module miebrdf._core; the package's Python files make it convenient (miebrdf/*.py).
#pragma once

#include <pybind11/pybind11.h>

#include <utility>
#include <vector>

#include <pybind11/numpy.h>

namespace miebrdf::python {

namespace py = pybind11;

void bind_errors(py::module_& module);
void bind_materials(py::module_& module);
void bind_mie(py::module_& module);
void bind_scene(py::module_& module);
void bind_brdf(py::module_& module);
void bind_exports(py::module_& module);
void bind_layers(py::module_& module);
void bind_measured(py::module_& module);
void bind_fits(py::module_& module);
void bind_tables(py::module_& module);

/// A NumPy array on the memory of a vector, which lives as long as the array: nothing is copied.
template <typename Value>
py::array_t<Value> array_of(std::vector<Value> values, std::vector<py::ssize_t> shape = {}) {
    auto* const held = new std::vector<Value>(std::move(values));
    const py::capsule owner(held,
                            [](void* memory) { delete static_cast<std::vector<Value>*>(memory); });
    if (shape.empty()) shape = {static_cast<py::ssize_t>(held->size())};
    return py::array_t<Value>(std::move(shape), held->data(), owner);
}

}  // namespace miebrdf::python
