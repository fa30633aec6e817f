// Measurements: <miebrdf/measured.h>.
#include <miebrdf/measured.h>

#include <array>
#include <map>
#include <optional>
#include <string>
#include <vector>

#include <pybind11/stl.h>
#include "tools/python/bindings.h"

namespace miebrdf::python {
namespace {

py::dict read(const std::string& path, const std::string& format, const std::string& column,
              const std::string& quantity, std::optional<bool> percent,
              const std::map<std::string, double>& numbers, const std::string& azimuth_zero,
              const std::string& wavelengths) {
    const auto number = [&](const char* name) -> std::optional<double> {
        const auto found = numbers.find(name);
        return found == numbers.end() ? std::nullopt : std::optional(found->second);
    };
    Measurements list;
    {
        const py::gil_scoped_release unlocked;
        list = read_measured(path, {.format = format,
                                    .column = column,
                                    .quantity = quantity,
                                    .percent = percent,
                                    .wavelength_nm = number("wavelength_nm"),
                                    .mu_in = number("mu_in"),
                                    .mu_out = number("mu_out"),
                                    .azimuth_deg = number("azimuth_deg"),
                                    .sigma = number("sigma"),
                                    .relative_sigma = number("relative_sigma"),
                                    .azimuth_zero = azimuth_zero,
                                    .wavelengths = wavelengths});
    }
    py::dict facts;
    facts["file"] = list.file;
    facts["format"] = list.format;
    facts["samples"] = list.samples;
    facts["facts"] = list.facts;
    facts["doubts"] = list.doubts;
    const auto column_of = [&](double MeasuredValue::*member) {
        std::vector<double> all;
        for (const MeasuredValue& v : list.values) all.push_back(v.*member);
        return array_of(std::move(all));
    };
    facts["wavelength_nm"] = column_of(&MeasuredValue::wavelength_nm);
    facts["mu_in"] = column_of(&MeasuredValue::mu_in);
    facts["mu_out"] = column_of(&MeasuredValue::mu_out);
    facts["azimuth_deg"] = column_of(&MeasuredValue::azimuth_deg);
    facts["value"] = column_of(&MeasuredValue::value);
    facts["sigma"] = column_of(&MeasuredValue::sigma);
    std::vector<std::string> quantities, geometries, samples;
    for (const MeasuredValue& v : list.values) {
        quantities.push_back(word_of(v.quantity));
        geometries.push_back(word_of(v.geometry));
        samples.push_back(list.samples[v.sample]);
    }
    facts["quantity"] = quantities;
    facts["geometry"] = geometries;
    facts["sample"] = samples;
    return facts;
}

/// @param light  the members of SlabLight, in their order, at each wavelength and incidence
std::vector<double> read_sphere(const std::map<std::string, double>& sphere,
                                const std::map<std::string, double>& other, bool transmitted,
                                const std::array<std::vector<double>, 6>& light) {
    SphereMeasurement spheres{.spheres = other.empty() ? 1 : 2};
    for (const auto& [word, value] : sphere) set_sphere_word(spheres, word, value);
    for (const auto& [word, value] : other) set_sphere_word(spheres, word, value, true);
    if (spheres.lost_light) throw UsageError("lost_light: the sample is traced in fits alone");
    validate(spheres);
    std::vector<double> readings;
    for (std::size_t i = 0; i < light[0].size(); ++i)
        readings.push_back(sphere_reading(
            spheres, transmitted,
            {light[0][i], light[1][i], light[2][i], light[3][i], light[4][i], light[5][i]}));
    return readings;
}

}  // namespace

void bind_measured(py::module_& module) {
    module.def("sphere_reading", &read_sphere, py::arg("sphere"), py::arg("other"),
               py::arg("transmitted"), py::arg("light"));
    module.def("read_measured", &read, py::arg("path"), py::arg("format"), py::arg("column"),
               py::arg("quantity"), py::arg("percent"), py::arg("numbers"), py::arg("azimuth_zero"),
               py::arg("wavelengths"));
}

}  // namespace miebrdf::python
