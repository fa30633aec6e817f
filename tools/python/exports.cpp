// Files and colours: <miebrdf/formats.h>, <miebrdf/colour.h>.
#include <miebrdf/colour.h>
#include <miebrdf/error.h>
#include <miebrdf/formats.h>
#include <miebrdf/value_derivatives.h>
#include <miebrdf/version.h>

#include <algorithm>
#include <filesystem>
#include <map>
#include <optional>
#include <span>
#include <string>
#include <utility>
#include <vector>

#include <pybind11/stl.h>
#include <pybind11/stl/filesystem.h>
#include "tools/python/bindings.h"
#include "tools/python/brdf_table.h"
#include "tools/python/long_call.h"

namespace miebrdf::python {
namespace {

using Numbers = std::vector<double>;

py::list formats() {
    py::list list;
    for (const Format& format : all_formats()) {
        py::dict facts;
        facts["name"] = format.name;
        facts["readers"] = format.readers;
        facts["holds"] = format.holds;
        facts["endings"] = format.endings;
        facts["brdf"] =
            format.content == FormatContent::table || format.content == FormatContent::sampled;
        facts["options"] = options_of(format);
        facts["whole_matrix"] = format.whole_matrix;
        list.append(facts);
    }
    return list;
}

py::list exported(const BrdfSource& source, const std::filesystem::path& path,
                  const std::string& format, const ExportOptions& export_options,
                  const CallOptions& options) {
    LongCall call(options);
    const auto files =
        call.run([&] { return export_brdf(source, format, path, export_options, call.control()); });
    py::list list;
    for (const ExportedFile& file : files) {
        py::dict facts, deviations;
        facts["path"] = file.path;
        facts["bytes"] = file.bytes;
        if (file.deviation) {
            for (const RegionDeviation& region : file.deviation->regions)
                deviations[region.name] = region.rms;
        }
        facts["rms_deviation"] = deviations;
        list.append(facts);
    }
    return list;
}

/// A BRDF that is a function in Python, asked from the library's threads one at a time.
class FunctionSource : public BrdfSource {
  public:
    FunctionSource(py::function function, Numbers wavelength_nm, Provenance provenance)
        : function_(std::move(function)),
          wavelength_nm_(std::move(wavelength_nm)),
          channels_(channel_names(wavelength_nm_)),
          provenance_(std::move(provenance)) {}

    const std::vector<std::string>& channels() const override { return channels_; }
    const Numbers& wavelength_nm() const override { return wavelength_nm_; }
    const Provenance& provenance() const override { return provenance_; }

    void evaluate(std::span<const Direction> asked, std::span<double> values) const override {
        std::vector<Direction> storage;
        const auto directions = require_valid(asked, values.size(), channels_.size(), storage);
        const py::gil_scoped_acquire lock;
        NumberArray mu_in(py::ssize_t(directions.size())), mu_out(mu_in.size()),
            azimuth_deg(mu_in.size());
        for (std::size_t d = 0; d < directions.size(); ++d) {
            mu_in.mutable_data()[d] = directions[d].mu_in;
            mu_out.mutable_data()[d] = directions[d].mu_out;
            azimuth_deg.mutable_data()[d] = directions[d].azimuth_deg;
        }
        const auto result = function_(mu_in, mu_out, azimuth_deg).cast<NumberArray>();
        std::copy_n(result.data(), directions.size() * channels_.size(), values.data());
    }

  private:
    py::function function_;
    Numbers wavelength_nm_;
    std::vector<std::string> channels_;
    Provenance provenance_;
};

/// @returns  of shape (directions, channels)
py::array_t<double> evaluate_file(const BrdfFile& file, const NumberArray& mu_in,
                                  const NumberArray& mu_out, const NumberArray& azimuth_deg) {
    const auto count = static_cast<std::size_t>(mu_in.size());
    const std::size_t channels = file.channels().size();
    Numbers values(count * channels);
    {
        const py::gil_scoped_release unlocked;
        for (std::size_t d = 0; d < count; ++d) {
            file.evaluate({mu_in.data()[d], mu_out.data()[d], azimuth_deg.data()[d]},
                          std::span(values).subspan(d * channels, channels));
        }
    }
    return array_of(std::move(values),
                    {static_cast<py::ssize_t>(count), static_cast<py::ssize_t>(channels)});
}

py::dict check(const std::string& path) {
    FileCheck result;
    {
        const py::gil_scoped_release unlocked;
        result = check_file(path);
    }
    py::dict facts;
    facts["reciprocity_rms"] = result.reciprocity_rms;
    facts["largest_albedo"] = result.largest_albedo;
    facts["largest_albedo_error"] = result.largest_albedo_error;
    facts["largest_albedo_mu"] = result.largest_albedo_mu;
    facts["largest_albedo_channel"] = result.largest_albedo_channel;
    facts["least_value"] = result.least_value;
    facts["missing"] = result.missing;
    facts["directions"] = result.directions;
    facts["sampled_albedo_error"] = result.sampled_albedo_error;
    return facts;
}

/// For each row of reflectances: XYZ, Lab, linear sRGB, LCh, the colour's error estimate and linear
/// ACEScg, as the program's --colour and swatches compute them.
/// @param reflectance  rows of one number for each wavelength
/// @param viewed       as for `viewing`
py::array_t<double> colours(const Numbers& wavelength_nm, const NumberArray& reflectance,
                            const std::string& viewed) {
    const Colorimeter colorimeter(wavelength_nm, viewing(viewed));
    const auto rows = reflectance.unchecked<2>();
    NumberArray result({rows.shape(0), py::ssize_t{16}});
    auto target = result.mutable_unchecked<2>();
    Numbers row(static_cast<std::size_t>(rows.shape(1)));
    for (py::ssize_t r = 0; r < rows.shape(0); ++r) {
        for (std::size_t w = 0; w < row.size(); ++w) row[w] = rows(r, static_cast<py::ssize_t>(w));
        const auto [xyz, lab, lch, rgb, error] = colorimeter(row);
        py::ssize_t column = 0;
        for (const double value : {xyz.x, xyz.y, xyz.z, lab.l, lab.a, lab.b, rgb.red, rgb.green,
                                   rgb.blue, lch.l, lch.c, lch.h_deg, error})
            target(r, column++) = value;
        for (const double value : to_acescg(xyz, colorimeter.viewing()))
            target(r, column++) = value;
    }
    return result;
}

/// For each row of reflectances and their slopes the derivatives that the program's --colour gives:
/// XYZ, Lab, encoded sRGB, C and h.
py::array_t<double> colour_derivatives(const Numbers& wavelength_nm, const NumberArray& reflectance,
                                       const NumberArray& slope, const std::string& viewed) {
    const Colorimeter colorimeter(wavelength_nm, viewing(viewed));
    const auto rows = reflectance.unchecked<2>(), slopes = slope.unchecked<2>();
    NumberArray result({rows.shape(0), py::ssize_t{11}});
    auto target = result.mutable_unchecked<2>();
    Numbers row(static_cast<std::size_t>(rows.shape(1))), change(row);
    for (py::ssize_t r = 0; r < rows.shape(0); ++r) {
        for (std::size_t w = 0; w < row.size(); ++w) {
            row[w] = rows(r, static_cast<py::ssize_t>(w));
            change[w] = slopes(r, static_cast<py::ssize_t>(w));
        }
        const auto [xyz, lab, lch, linear, rgb] = derivative_of_colour(colorimeter, row, change);
        py::ssize_t column = 0;
        for (const double value : {xyz.x, xyz.y, xyz.z, lab.l, lab.a, lab.b, rgb.red, rgb.green,
                                   rgb.blue, lch.c, lch.h_deg})
            target(r, column++) = value;
    }
    return result;
}

/// A formula for the difference of two colours, of arrays that broadcast.
template <double (*difference)(const Lab&, const Lab&)>
double of_lab(double l1, double a1, double b1, double l2, double a2, double b2) {
    return difference({l1, a1, b1}, {l2, a2, b2});
}

}  // namespace

void bind_exports(py::module_& module) {
    py::class_<rte::Directions>(module, "Directions")
        .def(
            py::init([](Numbers mu_in, Numbers mu_out, Numbers azimuth_deg) {
                return rte::Directions{std::move(mu_in), std::move(mu_out), std::move(azimuth_deg)};
            }),
            py::arg("mu_in") = Numbers{}, py::arg("mu_out") = Numbers{},
            py::arg("azimuth_deg") = Numbers{});
    module.def("formats", &formats);
    const auto how = [](int resolution, const rte::Directions& directions, const std::string& rgb,
                        double largest_error, bool accept_error,
                        const std::map<std::string, int>& extra) {
        return ExportOptions{resolution, directions, rgb, largest_error, accept_error, extra};
    };
    module.def(
        "export_table",
        [how](const SolvedTable& table, const std::filesystem::path& path,
              const std::string& format, int resolution, const rte::Directions& directions,
              const std::string& rgb, double largest_error, bool accept_error,
              const std::map<std::string, int>& extra, const CallOptions& options) {
            return exported(table.table(), path, format,
                            how(resolution, directions, rgb, largest_error, accept_error, extra),
                            options);
        },
        py::arg("table"), py::arg("path"), py::arg("format"), py::arg("resolution"),
        py::arg("directions"), py::arg("rgb"), py::arg("largest_error"), py::arg("accept_error"),
        py::arg("extra"), py::arg("options"));
    module.def(
        "export_function",
        [how](py::function function, Numbers wavelength_nm, const std::string& title,
              const std::string& command, const std::filesystem::path& path,
              const std::string& format, int resolution, const rte::Directions& directions,
              const std::string& rgb, double largest_error, bool accept_error,
              const std::map<std::string, int>& extra, const CallOptions& options) {
            const FunctionSource source(
                std::move(function), std::move(wavelength_nm),
                {.version = "miebrdf " MIEBRDF_VERSION, .command_line = command, .title = title});
            return exported(source, path, format,
                            how(resolution, directions, rgb, largest_error, accept_error, extra),
                            options);
        },
        py::arg("function"), py::arg("wavelength_nm"), py::arg("title"), py::arg("command"),
        py::arg("path"), py::arg("format"), py::arg("resolution"), py::arg("directions"),
        py::arg("rgb"), py::arg("largest_error"), py::arg("accept_error"), py::arg("extra"),
        py::arg("options"));
    py::class_<BrdfFile>(module, "BrdfFile")
        .def(py::init([](const std::string& path) { return open_brdf_file(path); }),
             py::arg("path"), py::call_guard<py::gil_scoped_release>())
        .def_property_readonly("format", &BrdfFile::format)
        .def_property_readonly("description", &BrdfFile::description)
        .def_property_readonly("channels", &BrdfFile::channels)
        .def_property_readonly("wavelengths_nm", &BrdfFile::wavelength_nm)
        .def("evaluate", &evaluate_file, py::arg("mu_in"), py::arg("mu_out"),
             py::arg("azimuth_deg"));
    module.def("check", &check, py::arg("path"));

    module.def("colours", &colours, py::arg("wavelength_nm"), py::arg("reflectance"),
               py::arg("viewed"));
    module.def("colour_derivatives", &colour_derivatives, py::arg("wavelength_nm"),
               py::arg("reflectance"), py::arg("slope"), py::arg("viewed"));
    module.def("delta_e_76", py::vectorize(&of_lab<delta_e_76>));
    module.def("delta_e_2000", py::vectorize(&of_lab<delta_e_2000>));
    module.def("covers_the_visible", &covers_the_visible, py::arg("wavelength_nm"));
}

}  // namespace miebrdf::python
