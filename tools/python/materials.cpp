// Optical constants: <miebrdf/index.h> and <miebrdf/database.h>.
#include <miebrdf/database.h>
#include <miebrdf/index.h>

#include <filesystem>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include <pybind11/complex.h>
#include <pybind11/stl.h>
#include <pybind11/stl/filesystem.h>
#include "tools/python/bindings.h"

namespace miebrdf::python {
namespace {

using namespace materials;

py::dict facts_of(const MaterialInfo& info) {
    py::dict facts;
    facts["name"] = info.name;
    facts["title"] = info.title;
    facts["formula"] = info.formula;
    facts["source"] = info.source;
    facts["reference"] = info.reference;
    facts["note"] = info.note;
    facts["aliases"] = info.aliases;
    facts["shortest_nm"] = info.shortest_nm;
    facts["longest_nm"] = info.longest_nm;
    facts["rows"] = info.rows;
    facts["k_known"] = info.k_known;
    facts["default_dataset"] = info.default_dataset;
    facts["datasets"] = info.datasets;
    facts["density_g_cm3"] = info.density_g_cm3;
    facts["density_source"] = info.density_source;
    return facts;
}

py::dict facts_of(const DatasetInfo& info) {
    py::dict facts;
    facts["material"] = info.material;
    facts["label"] = info.label;
    facts["layer"] = info.layer;
    facts["source"] = info.source;
    facts["key"] = info.key;
    facts["reference"] = info.reference;
    facts["doi"] = info.doi;
    facts["licence"] = info.licence;
    facts["ray"] = info.ray;
    facts["composition"] = info.composition;
    facts["note"] = info.note;
    facts["imported"] = info.imported;
    facts["temperature_k"] = info.temperature_k;
    facts["density_g_cm3"] = info.density_g_cm3;
    facts["corrections"] = info.corrections;
    facts["n_known"] = info.n_known;
    facts["k_known"] = info.k_known;
    facts["rows"] = info.rows;
    facts["unit"] = name_of(info.unit);
    facts["shortest_nm"] = info.shortest_nm;
    facts["longest_nm"] = info.longest_nm;
    return facts;
}

template <typename Info>
py::list list_of(const std::vector<Info>& all) {
    py::list list;
    for (const Info& info : all) list.append(facts_of(info));
    return list;
}

/// n + ik at each wavelength.
py::array_t<std::complex<double>> values_at(const RefractiveIndex& index,
                                            const std::vector<double>& wavelength_nm) {
    std::vector<std::complex<double>> values;
    values.reserve(wavelength_nm.size());
    {
        const py::gil_scoped_release unlocked;
        for (const double wavelength : wavelength_nm) values.push_back(index.at(wavelength));
    }
    return array_of(std::move(values));
}

py::tuple table_of(const RefractiveIndex& index) {
    IndexTable table = index.table();
    return py::make_tuple(array_of(std::move(table.wavelength_nm)), array_of(std::move(table.n)),
                          table.k_known ? py::object(array_of(std::move(table.k))) : py::none());
}

/// Stores a table of a user's own. @returns "added", "unchanged" or "replaced"
std::string add(const std::filesystem::path& database, const std::string& name,
                const std::string& label, const std::vector<double>& wavelength_nm,
                const std::vector<double>& n, const std::optional<std::vector<double>>& k,
                const py::dict& facts, bool replace) {
    Dataset dataset;
    dataset.material = name;
    dataset.label = label;
    dataset.n = make_table(Unit::nanometre, wavelength_nm, n);
    if (k) dataset.k = make_table(Unit::nanometre, wavelength_nm, *k);
    const auto text = [&](const char* key) {
        return facts.contains(key) ? facts[key].cast<std::string>() : std::string();
    };
    dataset.title = text("title");
    dataset.formula = text("formula");
    dataset.source = text("source");
    dataset.reference = text("reference");
    dataset.note = text("note");
    if (facts.contains("density_g_cm3"))
        dataset.density_g_cm3 = facts["density_g_cm3"].cast<std::optional<double>>();
    const py::gil_scoped_release unlocked;
    DatabaseWriter writer(database);
    switch (writer.add({&dataset, 1}, {.replace = replace}).front()) {
        case AddOutcome::added:
            return "added";
        case AddOutcome::unchanged:
            return "unchanged";
        case AddOutcome::replaced:
            return "replaced";
    }
    return "";
}

py::list import_all(const std::filesystem::path& database,
                    const std::vector<std::filesystem::path>& files, const std::string& format,
                    const std::string& material, const std::string& label, bool replace) {
    std::vector<ImportItem> items;
    {
        const py::gil_scoped_release unlocked;
        items = import_files(
            database, files,
            {.format = format, .material = material, .label = label, .replace = replace});
    }
    py::list list;
    for (const ImportItem& item : items) {
        py::dict facts;
        facts["file"] = item.file;
        facts["dataset"] = item.dataset;
        facts["accepted"] = item.outcome.has_value();
        facts["reason"] = item.reason;
        facts["corrections"] = item.corrections;
        list.append(facts);
    }
    return list;
}

}  // namespace

void bind_materials(py::module_& module) {
    py::enum_<Interpolation>(module, "Interpolation")
        .value("pchip", Interpolation::pchip)
        .value("linear", Interpolation::linear_in_wavelength)
        .value("linear_energy", Interpolation::linear_in_energy);
    py::class_<IndexOptions>(module, "IndexOptions")
        .def(py::init([](Interpolation interpolation, bool clamp, bool missing_k_is_zero) {
                 return IndexOptions{interpolation,
                                     clamp ? Extrapolation::clamp : Extrapolation::refuse,
                                     missing_k_is_zero};
             }),
             py::arg("interpolation") = Interpolation::pchip, py::arg("clamp") = false,
             py::arg("missing_k_is_zero") = false);

    py::class_<RefractiveIndex>(module, "RefractiveIndex")
        .def("at", &values_at, py::arg("wavelength_nm"))
        .def("table", &table_of)
        .def_property_readonly("shortest_nm", &RefractiveIndex::shortest_nm)
        .def_property_readonly("longest_nm", &RefractiveIndex::longest_nm)
        .def_property_readonly("k_known", &RefractiveIndex::k_known);
    module.def("common_word", [](const std::string& text) -> py::object {
        const auto word = common_word(text);
        if (!word) return py::none();
        return py::dict(py::arg("word") = word->word, py::arg("materials") = word->materials,
                        py::arg("meaning") = word->meaning);
    });
    const auto unlocked = py::call_guard<py::gil_scoped_release>();
    py::class_<Database>(module, "Database")
        .def_static("embedded", &Database::embedded, unlocked)
        .def_static("layered", &Database::layered, py::arg("user_file"), unlocked)
        .def("list", [](const Database& self) { return list_of(self.list()); })
        .def(
            "search",
            [](const Database& self, const std::string& text,
               const std::optional<std::pair<double, double>>& covers, bool needs_k) {
                SearchFilter filter{.text = text, .needs_k = needs_k};
                if (covers) {
                    filter.covers_from_nm = covers->first;
                    filter.covers_to_nm = covers->second;
                }
                return list_of(self.search(filter));
            },
            py::arg("text"), py::arg("covers"), py::arg("needs_k"))
        .def(
            "info",
            [](const Database& self, const std::string& name) { return facts_of(self.info(name)); },
            py::arg("name"))
        .def(
            "datasets",
            [](const Database& self, const std::string& name) {
                return list_of(self.datasets(name));
            },
            py::arg("name"))
        .def(
            "dataset_info",
            [](const Database& self, const std::string& name) {
                return facts_of(self.dataset_info(name));
            },
            py::arg("name"))
        .def("refractive_index", &Database::refractive_index, py::arg("name"),
             py::arg("options") = IndexOptions{}, unlocked);

    module.def("default_user_database", &default_user_database);
    module.def("add_material", &add, py::arg("database"), py::arg("name"), py::arg("label"),
               py::arg("wavelength_nm"), py::arg("n"), py::arg("k"), py::arg("facts"),
               py::arg("replace"));
    module.def("import_files", &import_all, py::arg("database"), py::arg("files"),
               py::arg("format"), py::arg("material"), py::arg("label"), py::arg("replace"));
    module.def(
        "remove_material",
        [](const std::filesystem::path& database, const std::string& name) {
            return DatabaseWriter(database).remove_material(name);
        },
        py::arg("database"), py::arg("name"), unlocked);
}

}  // namespace miebrdf::python
