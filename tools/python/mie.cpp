// Single scattering: <miebrdf/sphere.h>, <miebrdf/sizes.h>, <miebrdf/ensemble.h>.
#include <miebrdf/ensemble.h>
#include <miebrdf/sphere.h>

#include <algorithm>
#include <complex>
#include <cstddef>
#include <span>
#include <string>
#include <utility>
#include <vector>

#include <pybind11/complex.h>
#include <pybind11/stl.h>
#include "pipeline/solve/parallel.h"
#include "tools/python/bindings.h"
#include "tools/python/long_call.h"

namespace miebrdf::python {
namespace {

using namespace mie;
using Complexes = std::vector<std::complex<double>>;
using Numbers = std::vector<double>;

/// Partial waves times angles between two looks at Ctrl-C: some milliseconds.
constexpr std::size_t kWavesPerJob = 1'000'000;

/// Efficiencies of each pair (index, size parameter), all pairs of one quantity together.
py::dict spheres(const Complexes& index, const Numbers& size_parameter,
                 const CallOptions& options) {
    LongCall call(options);
    const auto all = call.run([&] {
        std::vector<SphereOptics> spheres;
        spheres.reserve(index.size());
        for (std::size_t i = 0; i < index.size(); ++i) {
            if (call.control().is_cancelled()) break;
            spheres.push_back(scatter_by_sphere(index[i], size_parameter[i]));
        }
        return spheres;
    });
    const auto column = [&](auto member) {
        std::vector<std::remove_cvref_t<decltype(all[0].*member)>> values;
        values.reserve(all.size());
        for (const SphereOptics& sphere : all) values.push_back(sphere.*member);
        return values;
    };
    py::dict columns;
    columns["q_ext"] = array_of(column(&SphereOptics::q_ext));
    columns["q_sca"] = array_of(column(&SphereOptics::q_sca));
    columns["q_abs"] = array_of(column(&SphereOptics::q_abs));
    columns["q_back"] = array_of(column(&SphereOptics::q_back));
    columns["asymmetry"] = array_of(column(&SphereOptics::asymmetry));
    columns["accuracy"] = array_of(column(&SphereOptics::accuracy));
    py::array_t<bool> reached(static_cast<py::ssize_t>(all.size()));
    for (std::size_t i = 0; i < all.size(); ++i)
        reached.mutable_at(static_cast<py::ssize_t>(i)) = all[i].reached;
    columns["reached"] = reached;
    return columns;
}

py::tuple amplitudes(std::complex<double> index, double size_parameter, const Numbers& angles_deg,
                     const CallOptions& options) {
    LongCall call(options);
    auto all = call.run([&] {
        Coefficients waves;
        run_parallel("Mie theory", 1, call.control(),
                     [&](std::size_t) { waves = mie_coefficients(index, size_parameter); });
        const std::span<const double> angles(angles_deg);
        const std::size_t count = angles.size();
        const std::size_t of_job = std::max<std::size_t>(1, kWavesPerJob / waves.a.size());
        Amplitudes both{Complexes(count), Complexes(count)};
        run_parallel("angles", (count + of_job - 1) / of_job, call.control(), [&](std::size_t job) {
            const std::size_t first = job * of_job, here = std::min(of_job, count - first);
            const Amplitudes some = scattering_amplitudes(waves, angles.subspan(first, here));
            std::ranges::copy(some.s1, both.s1.begin() + std::ptrdiff_t(first));
            std::ranges::copy(some.s2, both.s2.begin() + std::ptrdiff_t(first));
        });
        return both;
    });
    return py::make_tuple(array_of(std::move(all.s1)), array_of(std::move(all.s2)));
}

py::tuple coefficients(std::complex<double> index, double size_parameter) {
    Coefficients waves;
    {
        const py::gil_scoped_release unlocked;
        waves = mie_coefficients(index, size_parameter);
    }
    return py::make_tuple(array_of(std::move(waves.a)), array_of(std::move(waves.b)));
}

/// `radii_um` not empty: a table, and the law has no meaning.
SizeDistribution size_distribution(const std::string& law, double radius_um, double variance,
                                   Numbers radii_um, Numbers number_density) {
    SizeDistribution sizes;
    sizes.effective_radius_um = radius_um;
    sizes.effective_variance = variance;
    sizes.kind = radii_um.empty() ? parse_size_distribution(law) : SizeDistributionKind::tabulated;
    sizes.radii_um = std::move(radii_um);
    sizes.number_density = std::move(number_density);
    return sizes;
}

/// At each wavelength; rows of `chi` are filled up with zeros.
py::dict ensemble(const Complexes& index, const Numbers& wavelength_nm,
                  const SizeDistribution& sizes, double host_index, int highest_moment,
                  const Numbers& angles_deg, double tolerance, double phase_tolerance,
                  const CallOptions& options) {
    LongCall call(options);
    const auto all = call.run([&] {
        std::vector<EnsembleOptics> spectra(wavelength_nm.size());
        const Executor pieces = pieces_of_job(call.control());
        run_parallel("Mie theory", spectra.size(), call.control(), [&](std::size_t w) {
            spectra[w] = average_over_sizes({.sizes = sizes,
                                             .refractive_index = index[w],
                                             .host_index = host_index,
                                             .wavelength_nm = wavelength_nm[w],
                                             .highest_moment = highest_moment,
                                             .angles_deg = angles_deg,
                                             .tolerance = tolerance,
                                             .phase_tolerance = phase_tolerance},
                                            pieces);
        });
        return spectra;
    });
    const auto rows = static_cast<py::ssize_t>(all.size());
    const auto column = [&](auto member) {
        Numbers values;
        for (const EnsembleOptics& optics : all) values.push_back(optics.*member);
        return array_of(std::move(values));
    };
    const auto table = [&](auto member, std::size_t width) {
        Numbers values(all.size() * width, 0.0);
        for (std::size_t w = 0; w < all.size(); ++w) {
            const Numbers& row = all[w].*member;
            std::copy_n(row.begin(), std::min(width, row.size()),
                        values.begin() + static_cast<std::ptrdiff_t>(w * width));
        }
        return array_of(std::move(values), {rows, static_cast<py::ssize_t>(width)});
    };
    py::dict columns;
    columns["single_scattering_albedo"] = column(&EnsembleOptics::single_scattering_albedo);
    columns["one_minus_albedo"] = column(&EnsembleOptics::one_minus_albedo);
    columns["q_ext"] = column(&EnsembleOptics::q_ext);
    columns["q_sca"] = column(&EnsembleOptics::q_sca);
    columns["q_abs"] = column(&EnsembleOptics::q_abs);
    columns["asymmetry"] = column(&EnsembleOptics::asymmetry);
    columns["error_estimate"] = column(&EnsembleOptics::error_estimate);
    columns["chi"] = table(&EnsembleOptics::chi, static_cast<std::size_t>(highest_moment + 1));
    columns["phase"] = table(&EnsembleOptics::phase, angles_deg.size());
    columns["phase_error"] = table(&EnsembleOptics::phase_error, angles_deg.size());
    py::array_t<bool> converged(rows);
    for (std::size_t w = 0; w < all.size(); ++w)
        converged.mutable_at(static_cast<py::ssize_t>(w)) = all[w].converged;
    columns["converged"] = converged;
    return columns;
}

}  // namespace

void bind_mie(py::module_& module) {
    py::class_<CallOptions>(module, "CallOptions")
        .def(py::init([](int threads, py::object progress, bool cache) {
                 return CallOptions{threads, std::move(progress), cache};
             }),
             py::arg("threads") = 0, py::arg("progress") = py::none(), py::arg("cache") = false);
    module.def("set_forked", &set_forked);

    module.def("spheres", &spheres, py::arg("index"), py::arg("size_parameter"),
               py::arg("options"));
    module.def("amplitudes", &amplitudes, py::arg("index"), py::arg("size_parameter"),
               py::arg("angles_deg"), py::arg("options"));
    module.def("coefficients", &coefficients, py::arg("index"), py::arg("size_parameter"));

    py::class_<SizeDistribution>(module, "SizeDistribution")
        .def(py::init(&size_distribution), py::arg("law") = "power-law",
             py::arg("radius_um") = 50.0, py::arg("variance") = 0.2,
             py::arg("radii_um") = Numbers{}, py::arg("number_density") = Numbers{})
        .def("radius_range", [](const SizeDistribution& self) {
            const RadiusRange range = radius_range(self);
            return py::make_tuple(range.smallest_um, range.largest_um);
        });
    module.def("size_distributions", [] {
        py::dict forms;
        for (const SizeDistributionForm& form : size_distribution_forms())
            forms[py::str(form.name)] = form.help;
        return forms;
    });
    module.def("ensemble", &ensemble, py::arg("index"), py::arg("wavelength_nm"), py::arg("sizes"),
               py::arg("host_index"), py::arg("highest_moment"), py::arg("angles_deg"),
               py::arg("tolerance"), py::arg("phase_tolerance"), py::arg("options"));
}

}  // namespace miebrdf::python
