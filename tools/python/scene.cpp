// Scenes: <miebrdf/scene.h>. Values that can be compared, copied and pickled.
#include <miebrdf/error.h>
#include <miebrdf/scene.h>

#include <array>
#include <complex>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include <pybind11/complex.h>
#include <pybind11/stl.h>
#include "tools/python/bindings.h"

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

py::tuple sizes_state(const ParticleSizes& s) {
    return py::make_tuple(s.specific_surface_m2_per_kg, s.exponent, s.file, s.radii_um,
                          s.number_density);
}

void set_sizes(ParticleSizes& s, const py::tuple& state) {
    s.specific_surface_m2_per_kg = state[0].cast<std::optional<double>>();
    s.exponent = state[1].cast<std::optional<double>>();
    s.file = state[2].cast<std::string>();
    s.radii_um = state[3].cast<std::vector<double>>();
    s.number_density = state[4].cast<std::vector<double>>();
}

py::tuple scattering_state(const FileScattering& t) {
    return py::make_tuple(t.wavelength_nm, t.radius_um, t.extinction, t.albedo,
                          t.has_cross_sections, t.angles_deg, t.phase, t.ratios,
                          t.radius_is_parameter, t.has_averages, t.area_ratio);
}

void set_scattering(FileScattering& t, const py::tuple& state) {
    using Lists = std::vector<std::vector<double>>;
    const auto list = [&](std::size_t i) { return state[i].cast<std::vector<double>>(); };
    const auto flag = [&](std::size_t i) { return state[i].cast<bool>(); };
    t = {list(0),
         list(1),
         list(2),
         list(3),
         flag(4),
         list(5),
         state[6].cast<Lists>(),
         state[7].cast<Lists>(),
         flag(8),
         flag(9),
         list(10)};
}

py::tuple shape_state(const Species& s) {
    const GrainShape& shape = s.shape;
    std::optional<int> phase;
    if (s.phase) phase = static_cast<int>(*s.phase);
    return py::make_tuple(static_cast<int>(shape.kind), shape.aspect, shape.asymmetry,
                          shape.absorption, phase, shape.by_t_matrix);
}

void set_shape(Species& s, const py::tuple& state) {
    s.shape = {static_cast<GrainShape::Kind>(state[0].cast<int>()),
               state[1].cast<std::optional<double>>(), state[2].cast<std::optional<double>>(),
               state[3].cast<std::optional<double>>(), state[5].cast<bool>()};
    if (!state[4].is_none()) s.phase = static_cast<PhaseForm>(state[4].cast<int>());
}

py::tuple state_of(const Species& s) {
    py::object amount = py::none();
    if (s.amount) amount = py::make_tuple(static_cast<int>(s.amount->kind), s.amount->value);
    py::list matrices;
    for (const MatrixCoefficients& m : s.matrices) {
        matrices.append(
            py::make_tuple(m.single_scattering_albedo, m.a1, m.a2, m.a3, m.a4, m.b1, m.b2));
    }
    py::list coatings;
    for (const Coating& c : s.coatings)
        coatings.append(
            py::make_tuple(c.material.name, c.material.index, c.thickness_um, c.share_of_radius));
    return py::make_tuple(static_cast<int>(s.kind), s.name, s.parameters, s.chi, s.wavelength_nm,
                          s.index, s.sizes.effective_radius_um, s.sizes.effective_variance,
                          law_of(s.sizes), s.density_g_cm3, amount, matrices, coatings,
                          sizes_state(s.sizes), shape_state(s), scattering_state(s.scattering),
                          s.layer_density_kg_m3);
}

Species species_of(const py::tuple& state) {
    Species s;
    s.kind = static_cast<Species::Kind>(state[0].cast<int>());
    s.name = state[1].cast<std::string>();
    s.parameters = state[2].cast<std::vector<double>>();
    s.chi = state[3].cast<std::vector<double>>();
    s.wavelength_nm = state[4].cast<std::vector<double>>();
    s.index = state[5].cast<std::vector<std::complex<double>>>();
    s.sizes.effective_radius_um = state[6].cast<std::optional<double>>();
    s.sizes.effective_variance = state[7].cast<std::optional<double>>();
    set_law(s.sizes, state[8].cast<std::optional<std::string>>());
    s.density_g_cm3 = state[9].cast<std::optional<double>>();
    if (!state[10].is_none()) {
        const auto amount = state[10].cast<std::pair<int, double>>();
        s.amount = Amount{static_cast<Amount::Kind>(amount.first), amount.second};
    }
    for (const py::handle of_wavelength : state[11]) {
        const auto numbers = of_wavelength.cast<py::tuple>();
        const auto list = [&](std::size_t i) { return numbers[i].cast<std::vector<double>>(); };
        s.matrices.push_back(
            {{list(2), list(3), list(4), list(5), list(6)}, numbers[0].cast<double>(), list(1)});
    }
    for (const py::handle handle : state[12]) {
        const auto coating = handle.cast<py::tuple>();
        s.coatings.push_back(
            {{coating[0].cast<std::string>(), coating[1].cast<std::complex<double>>()},
             coating[2].cast<double>(),
             coating[3].cast<double>()});
    }
    set_sizes(s.sizes, state[13].cast<py::tuple>());
    set_shape(s, state[14].cast<py::tuple>());
    set_scattering(s.scattering, state[15].cast<py::tuple>());
    s.layer_density_kg_m3 = state[16].cast<std::optional<double>>();
    return s;
}

py::tuple state_of(const Medium& medium) {
    py::list species;
    for (const Species& s : medium.species) species.append(state_of(s));
    py::object host = py::none();
    if (medium.host) host = py::make_tuple(medium.host->name, medium.host->index);
    return py::make_tuple(species, host);
}

Medium medium_of(const py::tuple& state) {
    Medium medium;
    for (const py::handle species : state[0].cast<py::list>())
        medium.species.push_back(species_of(species.cast<py::tuple>()));
    if (!state[1].is_none()) {
        const auto host = state[1].cast<std::pair<std::string, std::complex<double>>>();
        medium.host = Host{host.first, host.second};
    }
    return medium;
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
               const std::optional<std::string>& law, std::optional<double> density_g_cm3,
               std::optional<double> layer_density_kg_m3) {
                Species& last = self.species.back();
                if (radius_um) last.sizes.effective_radius_um = radius_um;
                if (variance) last.sizes.effective_variance = variance;
                if (law) set_law(last.sizes, law);
                if (density_g_cm3) last.density_g_cm3 = density_g_cm3;
                if (layer_density_kg_m3) last.layer_density_kg_m3 = layer_density_kg_m3;
                return self;
            },
            py::arg("radius_um"), py::arg("variance"), py::arg("law"), py::arg("density_g_cm3"),
            py::arg("layer_density_kg_m3"))
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
        .def(py::pickle([](const Medium& self) { return state_of(self); }, &medium_of));

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
        .def(py::pickle(
            [](const Depth& self) {
                return py::make_tuple(static_cast<int>(self.kind), self.value, self.wavelength_nm);
            },
            [](const py::tuple& state) {
                return Depth(static_cast<Depth::Kind>(state[0].cast<int>()),
                             state[1].cast<double>(), state[2].cast<double>());
            }));

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
        .def(py::pickle([](const Layer& self) { return py::make_tuple(self.medium, self.depth); },
                        [](const py::tuple& state) {
                            return Layer{state[0].cast<Medium>(), state[1].cast<Depth>()};
                        }));
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
        .def(py::pickle(
            [](const Substrate& self) {
                return py::make_tuple(static_cast<int>(self.kind), self.albedo, self.wavelength_nm,
                                      self.file, self.mirror.name, self.mirror.index,
                                      static_cast<int>(self.brdf.kind), self.brdf.values);
            },
            [](const py::tuple& state) {
                return Substrate{
                    static_cast<Substrate::Kind>(state[0].cast<int>()),
                    state[1].cast<std::vector<double>>(),
                    state[2].cast<std::vector<double>>(),
                    state[3].cast<std::string>(),
                    {state[4].cast<std::string>(), state[5].cast<std::complex<double>>()},
                    {static_cast<rte::GroundBrdf::Kind>(state[6].cast<int>()),
                     state[7].cast<std::array<double, 6>>()}};
            }));

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
