// Scenes: <miebrdf/scene.h>. Values that can be compared, copied and pickled.
#include <miebrdf/error.h>
#include <miebrdf/scene.h>

#include <complex>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include <pybind11/complex.h>
#include <pybind11/stl.h>
#include "pipeline/cache/packed_numbers.h"
#include "tools/python/bindings.h"

namespace miebrdf {

// Fields of what is pickled, beside those of pipeline/cache/fields.h.

template <Is<ParticleSizes> T>
auto fields(T& value) {
    auto& [radius, variance, law, surface, exponent, file, radii, density] = value;
    return std::tie(radius, variance, law, surface, exponent, file, radii, density);
}

template <Is<Amount> T>
auto fields(T& value) {
    auto& [kind, number] = value;
    return std::tie(kind, number);
}

template <Is<Host> T>
auto fields(T& value) {
    auto& [name, index] = value;
    return std::tie(name, index);
}

template <Is<Coating> T>
auto fields(T& value) {
    auto& [material, thickness_um, share_of_radius] = value;
    return std::tie(material, thickness_um, share_of_radius);
}

template <Is<MatrixCoefficients> T>
auto fields(T& value) {
    return std::tie(value.a1, value.a2, value.a3, value.a4, value.b1, value.b2,
                    value.single_scattering_albedo);
}

template <Is<FileScattering> T>
auto fields(T& value) {
    auto& [wavelength_nm, radius_um, extinction, albedo, cross_sections, angles_deg, phase, ratios,
           is_parameter, averages, area_ratio] = value;
    return std::tie(wavelength_nm, radius_um, extinction, albedo, cross_sections, angles_deg, phase,
                    ratios, is_parameter, averages, area_ratio);
}

template <Is<Species> T>
auto fields(T& value) {
    auto& [kind, name, parameters, chi, wavelength_nm, matrices, index, scattering, sizes, coatings,
           shape, phase, density, amount] = value;
    return std::tie(kind, name, parameters, chi, wavelength_nm, matrices, index, scattering, sizes,
                    coatings, shape, phase, density, amount);
}

template <Is<Medium> T>
auto fields(T& value) {
    auto& [species, host] = value;
    return std::tie(species, host);
}

template <Is<Depth> T>
auto fields(T& value) {
    auto& [kind, number, wavelength_nm] = value;
    return std::tie(kind, number, wavelength_nm);
}

template <Is<Layer> T>
auto fields(T& value) {
    auto& [medium, depth] = value;
    return std::tie(medium, depth);
}

template <Is<Substrate> T>
auto fields(T& value) {
    auto& [kind, albedo, wavelength_nm, file, mirror] = value;
    return std::tie(kind, albedo, wavelength_nm, file, mirror);
}

}  // namespace miebrdf

namespace miebrdf::python {
namespace {

py::object law_of(const ParticleSizes& sizes) {
    return sizes.distribution ? py::cast(mie::name_of(*sizes.distribution)) : py::none();
}

void set_law(ParticleSizes& sizes, const std::optional<std::string>& law) {
    sizes.distribution.reset();
    for (const auto kind :
         {mie::SizeDistributionKind::junge, mie::SizeDistributionKind::tabulated}) {
        if (law == mie::name_of(kind)) sizes.distribution = kind;
    }
    if (law && !sizes.distribution) sizes.distribution = mie::parse_size_distribution(*law);
}

/// Pickles a value as a row of numbers, by its list of fields.
template <typename T>
auto pickled() {
    return py::pickle([](const T& self) { return NumberPacker().add(self).take(); },
                      [](const std::vector<double>& numbers) {
                          T value;
                          NumberUnpacker(numbers).read(value);
                          return value;
                      });
}

/// Spheres of a refractive index of one's own.
Medium medium_of_table(const std::string& name, std::vector<double> wavelength_nm,
                       std::vector<std::complex<double>> index) {
    Species species;
    species.kind = Species::Kind::table;
    species.name = name;
    species.wavelength_nm = std::move(wavelength_nm);
    species.index = std::move(index);
    return species;
}

/// (name, radius in um, variance, law) of every species of particles; None: those of the scene.
py::list particles_of(const Medium& medium) {
    py::list particles;
    for (const Species& species : medium.species) {
        if (!needs_mie(species)) continue;
        particles.append(py::make_tuple(species.name, species.sizes.effective_radius_um,
                                        species.sizes.effective_variance, law_of(species.sizes)));
    }
    return particles;
}

void bind_media(py::module_& module) {
    py::class_<Medium>(module, "Medium",
                       "What a layer is made of; `miebrdf.medium` makes one. ``a + b`` is a "
                       "mixture.\n\nExamples\n--------\n>>> Medium(\"TiO2,volume=10%\") + "
                       "Medium(\"SiO2,volume=1%\")")
        .def(py::init([](const std::string& words) { return medium(words); }), py::arg("words"))
        .def_static("of_table", &medium_of_table, py::arg("name"), py::arg("wavelength_nm"),
                    py::arg("index"))
        .def("__str__", [](const Medium& self) { return describe(self); })
        .def("__repr__",
             [](const Medium& self) { return "<miebrdf.Medium " + describe(self) + ">"; })
        .def("__len__", [](const Medium& self) { return self.species.size(); })
        .def("__eq__",
             [](const Medium& self, const py::object& other) {
                 return py::isinstance<Medium>(other) && self == other.cast<const Medium&>();
             })
        .def_property_readonly("needs_mie", [](const Medium& self) { return needs_mie(self); })
        .def_property_readonly("particles", &particles_of)
        .def(
            "with_sizes",  // of the last species
            [](Medium self, std::optional<double> radius_um, std::optional<double> variance,
               const std::optional<std::string>& law, std::optional<double> density_g_cm3) {
                Species& last = self.species.back();
                if (radius_um) last.sizes.effective_radius_um = radius_um;
                if (variance) last.sizes.effective_variance = variance;
                if (law) set_law(last.sizes, law);
                if (density_g_cm3) last.density_g_cm3 = density_g_cm3;
                return self;
            },
            py::arg("radius_um"), py::arg("variance"), py::arg("law"), py::arg("density_g_cm3"))
        .def(
            "with_amount",
            [](Medium self, const std::string& kind, double value) {
                const auto known = kind == "volume" ? Amount::Kind::volume_fraction
                                   : kind == "mass" ? Amount::Kind::mass_fraction
                                                    : Amount::Kind::number_per_cm3;
                self.species.back().amount = Amount{known, value};
                return self;
            },
            py::arg("kind"), py::arg("value"))
        .def(
            "in_host",
            [](Medium self, const std::string& words) {
                self.host = host(words);
                return self;
            },
            py::arg("words"))
        .def("__add__",
             [](Medium self, const Medium& other) {
                 self.species.insert(self.species.end(), other.species.begin(),
                                     other.species.end());
                 if (self.host && other.host && *self.host != *other.host) {
                     throw UsageError("host", describe(*other.host),
                                      "one host for all species, here " + describe(*self.host));
                 }
                 if (!self.host) self.host = other.host;
                 return self;
             })
        .def(pickled<Medium>());

    py::class_<Depth>(module, "Depth",
                      "How deep a layer is: words as in `miebrdf.coat`, or an optical depth >= "
                      "0.\n\nExamples\n--------\n>>> Depth(\"40um\"), Depth(0.1), Depth.grey(0.1)")
        .def(py::init([](const std::string& words) { return depth(words); }), py::arg("words"))
        .def(py::init([](double optical_depth) { return Depth(optical_depth); }),
             py::arg("optical_depth"))
        .def_static("grey", &grey, py::arg("optical_depth"))
        .def_static(
            "thickness_um", [](double value) { return Depth(Depth::Kind::thickness_um, value); },
            py::arg("value"))
        .def("__str__", [](const Depth& self) { return describe(self); })
        .def("__repr__", [](const Depth& self) { return "<miebrdf.Depth " + describe(self) + ">"; })
        .def(pickled<Depth>());

    py::class_<Layer>(module, "Layer",
                      "A medium of some depth; `miebrdf.coat` makes "
                      "one.\n\nExamples\n--------\n>>> Layer(\"hg:0.9,0.4@0.1[grey]\").medium")
        .def(py::init([](const std::string& words) { return layer(words); }), py::arg("words"))
        .def(py::init([](const Medium& medium, const Depth& depth) {
                 return Layer{medium, depth};
             }),
             py::arg("medium"), py::arg("depth"))
        .def_readonly("medium", &Layer::medium)
        .def_readonly("depth", &Layer::depth)
        .def("__str__",
             [](const Layer& self) { return describe(self.medium) + "@" + describe(self.depth); })
        .def("__repr__",
             [](const Layer& self) {
                 return "<miebrdf.Layer " + describe(self.medium) + "@" + describe(self.depth) +
                        ">";
             })
        .def("__eq__",
             [](const Layer& self, const py::object& other) {
                 if (!py::isinstance<Layer>(other)) return false;
                 const auto& layer = other.cast<const Layer&>();
                 return self.medium == layer.medium && self.depth == layer.depth;
             })
        .def(pickled<Layer>());
}

void bind_ground(py::module_& module) {
    py::class_<Substrate>(module, "Substrate",
                          "What lies below the layers where there is no base: words as in "
                          "`miebrdf.Scene`, or `miebrdf.lambertian`.\n\nExamples\n--------\n>>> "
                          "Substrate(\"lambert:0.05\"), Substrate(\"mirror:Au\")")
        .def(py::init([](const std::string& words) { return substrate(words); }), py::arg("words"))
        .def(py::init([](std::vector<double> albedo, std::vector<double> wavelength_nm) {
                 Substrate ground;
                 ground.kind = Substrate::Kind::lambertian;
                 ground.albedo = std::move(albedo);
                 ground.wavelength_nm = std::move(wavelength_nm);
                 return ground;
             }),
             py::arg("albedo"), py::arg("wavelength_nm"))
        .def("__str__", [](const Substrate& self) { return describe(self); })
        .def("__repr__",
             [](const Substrate& self) { return "<miebrdf.Substrate " + describe(self) + ">"; })
        .def("__eq__",
             [](const Substrate& self, const py::object& other) {
                 return py::isinstance<Substrate>(other) && self == other.cast<const Substrate&>();
             })
        .def(pickled<Substrate>());

    py::enum_<rte::MicrofacetDistribution>(module, "MicrofacetDistribution")
        .value("beckmann", rte::MicrofacetDistribution::beckmann)
        .value("ggx", rte::MicrofacetDistribution::ggx);
    py::enum_<rte::Shadowing>(module, "Shadowing")
        .value("smith_correlated", rte::Shadowing::smith_correlated)
        .value("smith_separable", rte::Shadowing::smith_separable)
        .value("v_cavity", rte::Shadowing::v_cavity);
    py::enum_<rte::FresnelKind>(module, "Fresnel")
        .value("exact", rte::FresnelKind::exact)
        .value("schlick", rte::FresnelKind::schlick);
    py::enum_<rte::SurfaceCoupling>(module, "Coupling")
        .value("paper", rte::SurfaceCoupling::paper)
        .value("reciprocal", rte::SurfaceCoupling::reciprocal);
    py::enum_<Packing>(module, "Packing")
        .value("independent", Packing::independent)
        .value("percus_yevick", Packing::percus_yevick)
        .value("effective_host", Packing::effective_host)
        .value("percus_yevick_effective_host", Packing::percus_yevick_effective_host);
    py::class_<rte::SurfaceOptions>(module, "SurfaceOptions")
        .def(py::init([](double alpha, rte::MicrofacetDistribution distribution,
                         rte::Shadowing shadowing, rte::FresnelKind fresnel) {
                 return rte::SurfaceOptions{alpha, distribution, shadowing, fresnel, {}};
             }),
             py::arg("alpha"), py::arg("distribution"), py::arg("shadowing"), py::arg("fresnel"));
}

}  // namespace

void bind_scene(py::module_& module) {
    bind_media(module);
    bind_ground(module);
    module.def("media", [] {
        py::list forms;
        for (const MediumForm& form : medium_forms())
            forms.append(py::make_tuple(form.form, form.example, form.help));
        return forms;
    });
    py::class_<Scene>(module, "Scene")
        .def(py::init([](const std::optional<Medium>& base, const std::optional<Substrate>& ground,
                         std::vector<Layer> layers,
                         const std::optional<rte::SurfaceOptions>& surface) {
                 Scene scene;
                 if (base) scene.base = *base;
                 scene.substrate = ground;
                 scene.layers = std::move(layers);
                 scene.surface = surface;
                 return scene;
             }),
             py::arg("base"), py::arg("substrate"), py::arg("layers"), py::arg("surface"))
        .def(
            "set_particles",
            [](Scene& self, const mie::SizeDistribution& sizes, const std::string& host_words,
               double k_floor, double tolerance, std::optional<double> layer_density_kg_m3,
               Packing packing) {
                self.particles.sizes = sizes;
                self.particles.host = host(host_words);
                self.particles.k_floor = k_floor;
                self.particles.tolerance = tolerance;
                self.particles.layer_density_kg_m3 = layer_density_kg_m3;
                self.particles.packing = packing;
            },
            py::arg("sizes"), py::arg("host"), py::arg("k_floor"), py::arg("tolerance"),
            py::arg("layer_density_kg_m3"), py::arg("packing"))
        .def(
            "set_boundary",
            [](Scene& self, const std::string& words) { self.boundary = boundary(words); },
            py::arg("words"))
        .def_readwrite("coupling", &Scene::coupling)
        .def_readwrite("surface_index", &Scene::surface_index)
        .def_readwrite("database", &Scene::database)
        .def_readwrite("index", &Scene::index)
        .def("say", &say, py::arg("word"), py::arg("values"))
        .def_property_readonly("numbers",
                               [](const Scene& self) {
                                   py::dict numbers;
                                   for (const NamedNumber& one : named_numbers(self))
                                       numbers[py::str(one.name)] = one.value;
                                   return numbers;
                               })
        .def("validate", [](const Scene& self) { validate(self); })
        .def("__str__", [](const Scene& self) { return describe(self); });
}

}  // namespace miebrdf::python
