#include "pipeline/scene/medium_kinds.h"

#include <fmt/format.h>
#include <miebrdf/error.h>

#include <memory>
#include <stdexcept>
#include <utility>

#include "pipeline/scene/moments_file.h"
#include "pipeline/scene/scattering_file.h"
#include "pipeline/scene/scene_parts.h"
#include "pipeline/scene/turbid_medium.h"

namespace miebrdf {
namespace {

std::shared_ptr<const GivenMedium> by_formula(std::function<rte::Optics(double)> optics,
                                              int orders = 0) {
    return std::make_shared<FormulaMedium>(std::move(optics), orders);
}

const MediumParameter kAlbedo = {"single-scattering albedo", "[0, 1]",
                                 [](double a) { return a >= 0.0 && a <= 1.0; }};

MediumKind material() {
    return {.kind = Species::Kind::material,
            .name = "material",
            .form = "NAME",
            .example = "TiO2",
            .help = "spheres of a material of the database, by name or source:KEY",
            .read = [](const std::string& values, Species& species) { species.name = values; },
            .check =
                [](const Species& m) {
                    if (m.name.empty()) throw std::invalid_argument("a material needs a name");
                }};
}

const std::vector<MediumParameter> kIndex = {
    {"n", "n > 0, up to 1e6", [](double n) { return n > 0.0 && n <= kLargestIndex; }},
    {.name = "k",
     .allowed = "k >= 0, up to 1e6",
     .is_allowed = [](double k) { return k >= 0.0 && k <= kLargestIndex; },
     .by_default = 0.0}};

/// A layer of a host without particles (Amount 0); medium() gives it its host.
MediumKind slide() {
    return {.kind = Species::Kind::slide,
            .name = "slide",
            .form = "slide:N,K",
            .example = "slide:1.5,0",
            .help =
                "a clear or absorbing plate, such as a slide of glass, as a layer of some "
                "thickness: slide:1.5@1mm; its surfaces reflect, so that the scene needs a "
                "boundary; slide:N absorbs nothing",
            .parameters = kIndex,
            .given =
                [](const Species&) {
                    return by_formula([](double) { return rte::isotropic_optics(0.0); }, 1);
                },
            .has_extinction = true,
            .without_own_keys =
                [](Species rest) {
                    if (rest.amount && rest.amount->value == 0.0) rest.amount.reset();
                    return rest;
                },
            .own_keys = "a slide has its index alone",
            .check =
                [](const Species& m) {
                    if (!m.amount) throw UsageError("a slide has no particles; allowed: amount 0");
                }};
}

MediumKind index() {
    return {.kind = Species::Kind::index,
            .name = "index",
            .form = "index:N,K",
            .example = "index:1.5,0.01",
            .help = "spheres of a constant refractive index n + ik; index:N absorbs nothing",
            .parameters = kIndex};
}

MediumKind table() {
    return {.kind = Species::Kind::table,
            .name = "table",
            .help = "spheres of a refractive index n + ik given at some wavelengths",
            .check = [](const Species& m) { own_index(m); }};
}

MediumKind isotropic() {
    return {.kind = Species::Kind::isotropic,
            .name = "isotropic",
            .form = "isotropic:ALBEDO",
            .example = "isotropic:0.9",
            .help = "a medium that scatters alike in all directions",
            .parameters = {kAlbedo},
            .given = [](const Species& m) {
                return by_formula(
                    [albedo = m.parameters[0]](double) { return rte::isotropic_optics(albedo); },
                    1);
            }};
}

MediumKind rayleigh() {
    return {.kind = Species::Kind::rayleigh,
            .name = "rayleigh",
            .form = "rayleigh:ALBEDO",
            .example = "rayleigh:0.9,depolarisation=0.03",
            .help =
                "particles much smaller than the wavelength; molecules that are no spheres: "
                "rayleigh:ALBEDO,depolarisation=D (air 0.0279)",
            .parameters = {kAlbedo,
                           {.name = "depolarisation factor",
                            .allowed = "[0, 6/7]",
                            .is_allowed = [](double d) { return d >= 0.0 && d <= 6.0 / 7.0; },
                            .key = "depolarisation"}},
            .given = [](const Species& m) {
                return by_formula(
                    [albedo = m.parameters[0],
                     depolarisation = m.parameters.size() > 1 ? m.parameters[1] : 0.0](double) {
                        return rte::rayleigh_optics(albedo, depolarisation);
                    },
                    3);
            }};
}

const MediumParameter kAsymmetry = {"asymmetry", "(-1, 1)",
                                    [](double g) { return g > -1.0 && g < 1.0; }};

MediumKind henyey_greenstein() {
    return {
        .kind = Species::Kind::henyey_greenstein,
        .name = "hg",
        .form = "hg:ALBEDO,G or hg:FILE",
        .example = "hg:0.9,0.7",
        .help =
            "the phase function of Henyey and Greenstein (1941) with asymmetry G; hg:FILE takes "
            "a CSV file with the columns wavelength_nm, single_scattering_albedo, g",
        .parameters = {kAlbedo, kAsymmetry},
        .read_file = read_asymmetry_file,
        .given =
            [](const Species& m) {
                if (m.matrices.empty())
                    return by_formula([albedo = m.parameters[0], g = m.parameters[1]](double) {
                        return rte::henyey_greenstein_optics(albedo, g);
                    });
                return by_formula([table = CoefficientTable(m)](double nm) {
                    const MatrixCoefficients at = table.at(nm);
                    return rte::henyey_greenstein_optics(at.single_scattering_albedo,
                                                         at.a1[1] / 3.0);
                });
            },
        .check =
            [](const Species& m) {
                if (!m.matrices.empty()) check_matrices(m);
            }};
}

/// The two lobes are two media side by side that extinguish by their shares: moments and phase
/// function are exact.
MediumKind double_henyey_greenstein() {
    return {.kind = Species::Kind::double_henyey_greenstein,
            .name = "dhg",
            .form = "dhg:ALBEDO,G1,G2,SHARE",
            .example = "dhg:0.99,0.8,-0.3,0.9",
            .help = "two lobes of Henyey and Greenstein, SHARE of the first",
            .parameters = {kAlbedo,
                           kAsymmetry,
                           kAsymmetry,
                           {"share of the first lobe", "[0, 1]",
                            [](double share) { return share >= 0.0 && share <= 1.0; }}},
            .given = [](const Species& m) {
                return by_formula([p = m.parameters](double) {
                    return rte::mix({{rte::henyey_greenstein_optics(p[0], p[1]), p[3]},
                                     {rte::henyey_greenstein_optics(p[0], p[2]), 1.0 - p[3]}});
                });
            }};
}

std::shared_ptr<const GivenMedium> by_coefficients(const Species& species) {
    CoefficientTable table(species);
    const int orders = table.most_degrees();
    return by_formula([table = std::move(table)](double nm) { return optics_of(table.at(nm)); },
                      orders);
}

MediumKind moments() {
    return {.kind = Species::Kind::moments,
            .name = "moments",
            .form = "moments:FILE",
            .example = "moments:mine.csv",
            .help = "albedo and Legendre moments from a CSV file, also for several wavelengths",
            .parameters = {kAlbedo},
            .read =
                [](const std::string& values, Species& species) {
                    MomentsFile file = read_moments_file(values);
                    species.name = values;
                    species.parameters = {file.single_scattering_albedo};
                    species.chi = std::move(file.chi);
                    species.wavelength_nm = std::move(file.by_wavelength.wavelength_nm);
                    species.matrices = std::move(file.by_wavelength.matrices);
                },
            .given =
                [](const Species& m) {
                    if (!m.matrices.empty()) return by_coefficients(m);
                    rte::Optics optics;
                    optics.single_scattering_albedo = m.parameters[0];
                    optics.one_minus_albedo = 1.0 - m.parameters[0];
                    optics.chi = m.chi;
                    return by_formula([optics](double) { return optics; }, int(m.chi.size()));
                },
            .check =
                [](const Species& m) {
                    if (m.matrices.empty()) return check_moments(m.chi);
                    if (!m.chi.empty())
                        throw std::invalid_argument("chi beside matrices; allowed: one of them");
                    check_matrices(m);
                }};
}

MediumKind matrix() {
    return {.kind = Species::Kind::matrix,
            .name = "matrix",
            .form = "matrix:FILE",
            .example = "matrix:mine.csv",
            .help = "albedo and scattering matrix, as coefficients a1 ... b2, from a CSV file",
            .parameters = {kAlbedo},
            .read =
                [](const std::string& values, Species& species) {
                    species.name = values;
                    MatrixFile file = read_matrix_file(values);
                    species.wavelength_nm = std::move(file.wavelength_nm);
                    species.matrices = std::move(file.matrices);
                    species.parameters = {mean_albedo(species.matrices)};
                },
            .given = by_coefficients,
            .check = check_matrices};
}

MediumKind scattering() {
    return {
        .kind = Species::Kind::scattering,
        .name = "scattering",
        .form = "scattering:FILE",
        .example = "scattering:suso00",
        .help =
            "single scattering from a file of OPAC, a T-matrix program, the databases of ice and "
            "dust (isca.dat), libRadtran, MOPSMAP (NetCDF) or CSV",
        .parameters = {kAlbedo},
        .read = [](const std::string& values,
                   Species& species) { read_scattering_file(values, species); },
        .given = medium_of_file,
        .has_extinction = true,
        .without_own_keys =
            [](Species rest) {
                const bool sized = has_sizes(rest.scattering);
                rest.sizes = {};
                if (sized) rest.density_g_cm3.reset(), rest.layer_density_kg_m3.reset();
                if (sized || (rest.amount && rest.amount->kind == Amount::Kind::number_per_cm3))
                    rest.amount.reset();
                return rest;
            },
        .own_keys =
            "files of scattering take number=, those of single sizes radius=, variance=, "
            "distribution=, volume=, mass= and density=, too",
        .check = check_scattering};
}

}  // namespace

const std::vector<MediumKind>& medium_kinds() {
    static const std::vector<MediumKind> kinds = {
        material(),   index(),    table(),
        isotropic(),  rayleigh(), henyey_greenstein(),
        moments(),    matrix(),   double_henyey_greenstein(),
        scattering(), paste(),    turbid(),
        slide(),
    };
    return kinds;
}

const MediumKind& kind_of(const Species& species) {
    return medium_kinds()[static_cast<std::size_t>(species.kind)];
}

materials::RefractiveIndex own_index(const Species& species) {
    const std::size_t count = species.wavelength_nm.size();
    if (count == 0 || species.index.size() != count) {
        throw std::invalid_argument(
            fmt::format("{} wavelengths and {} refractive indices; allowed: as many wavelengths as "
                        "indices, at least one",
                        count, species.index.size()));
    }
    materials::IndexTable table;
    table.wavelength_nm = species.wavelength_nm;
    for (const std::complex<double> index : species.index) {
        table.n.push_back(index.real());
        table.k.push_back(index.imag());
    }
    return {species.name, std::move(table)};
}

}  // namespace miebrdf
