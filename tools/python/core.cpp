// The module miebrdf._core: version and exceptions here, everything else in a file for its area.
#include <miebrdf/database.h>
#include <miebrdf/error.h>
#include <miebrdf/formats.h>
#include <miebrdf/processor_path.h>
#include <miebrdf/version.h>

#include <exception>
#include <stdexcept>
#include <string>

#include "tools/python/bindings.h"

namespace miebrdf::python {
namespace {

/// Raises the class of miebrdf.errors of this name, with the same text and what the C++ exception
/// knows besides. The classes are written in Python: they inherit from ValueError and the like.
void raise(const char* name, const Error& error, py::dict facts = {}) {
    const py::object cls = py::module_::import("miebrdf.errors").attr(name);
    // As arguments of the package are called.
    std::string text = error.what();
    std::string field = error.field();
    for (const auto& [word, argument] :
         {std::pair<std::string, std::string>{"beckmann_alpha", "roughness"},
          {"wavelength_nm", "wavelengths_nm"}}) {
        if (field != word) continue;
        field = argument;
        if (text.starts_with(word)) text.replace(0, word.size(), argument);
        break;
    }
    const py::object instance = cls(text);
    instance.attr("field") = field;
    instance.attr("value") = error.value();
    instance.attr("allowed") = error.allowed();
    for (const auto& [key, fact] : facts) py::setattr(instance, key, fact);
    PyErr_SetObject(cls.ptr(), instance.ptr());
}

/// The most special classes come first.
void translate(std::exception_ptr thrown) {
    try {
        if (thrown) std::rethrow_exception(thrown);
    } catch (const materials::UnknownMaterial& error) {
        py::list candidates;
        for (const std::string& name : error.candidates) candidates.append(name);
        py::dict facts;
        facts["name"] = error.name;
        facts["candidates"] = candidates;
        raise("UnknownMaterial", error, facts);
    } catch (const materials::ImportError& error) {
        py::dict facts;
        facts["line"] = error.line();
        facts["reason"] = error.reason();
        raise("MaterialFileError", error, facts);
    } catch (const materials::DatabaseError& error) {
        raise("DatabaseError", error);
    } catch (const TooCoarse& error) {
        raise("TooCoarse", error);
    } catch (const UsageError& error) {
        raise("UsageError", error);
    } catch (const InputError& error) {
        raise("InputError", error);
    } catch (const Cancelled& error) {
        raise("Cancelled", error);
    } catch (const Error& error) {
        raise("Error", error);
    }
}

}  // namespace

void bind_errors(py::module_& module) {
    module.attr("version") = kVersion;
    module.attr("processor_path") = std::string(processor_path());
    py::register_exception_translator(translate);
}

}  // namespace miebrdf::python

PYBIND11_MODULE(_core, module) {
    using namespace miebrdf::python;
    module.doc() = "The C++ library behind the package miebrdf; private.";
    bind_errors(module);
    bind_materials(module);
    bind_mie(module);
    bind_scene(module);
    bind_brdf(module);
    bind_exports(module);
    bind_layers(module);
    bind_measured(module);
    bind_fits(module);
    bind_tables(module);
}
