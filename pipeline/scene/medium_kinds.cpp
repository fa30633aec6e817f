#include "pipeline/scene/medium_kinds.h"

#include <fmt/format.h>
#include <miebrdf/error.h>

#include <algorithm>
#include <stdexcept>

#include "pipeline/scene/moments_file.h"
#include "pipeline/scene/scattering_file.h"
#include "pipeline/scene/scene_parts.h"

namespace miebrdf {
namespace {

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

MediumKind index() {
    return {.kind = Species::Kind::index,
            .name = "index",
            .form = "index:N,K",
            .example = "index:1.5,0.01",
            .help = "spheres of a constant refractive index n + ik; index:N absorbs nothing",
            .parameters = {
                {"n", "n > 0, up to 1e6", [](double n) { return n > 0.0 && n <= kLargestIndex; }},
                {.name = "k",
                 .allowed = "k >= 0, up to 1e6",
                 .is_allowed = [](double k) { return k >= 0.0 && k <= kLargestIndex; },
                 .by_default = 0.0}}};
}

MediumKind table() {
    return {.kind = Species::Kind::table,
            .name = "table",
            .help = "spheres of a refractive index n + ik given at some wavelengths",
            .check = [](const Species& m) { own_index(m); }};
}

MediumKind isotropic() {
    return {
        .kind = Species::Kind::isotropic,
        .name = "isotropic",
        .form = "isotropic:ALBEDO",
        .example = "isotropic:0.9",
        .help = "a medium that scatters alike in all directions",
        .parameters = {kAlbedo},
        .optics = [](const Species& m, double) { return rte::isotropic_optics(m.parameters[0]); },
        .most_fourier_orders = [](const Species&) { return 1; }};
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
            .optics =
                [](const Species& m, double) {
                    return rte::rayleigh_optics(m.parameters[0],
                                                m.parameters.size() > 1 ? m.parameters[1] : 0.0);
                },
            .most_fourier_orders = [](const Species&) { return 3; }};
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
        .optics =
            [](const Species& m, double nm) {
                if (m.matrices.empty())
                    return rte::henyey_greenstein_optics(m.parameters[0], m.parameters[1]);
                const MatrixCoefficients at = coefficients_at(m, nm);
                return rte::henyey_greenstein_optics(at.single_scattering_albedo, at.a1[1] / 3.0);
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
            .optics = [](const Species& m, double) {
                const double albedo = m.parameters[0], share = m.parameters[3];
                return rte::mix(
                    {{rte::henyey_greenstein_optics(albedo, m.parameters[1]), share},
                     {rte::henyey_greenstein_optics(albedo, m.parameters[2]), 1.0 - share}});
            }};
}

/// Of coefficients at all wavelengths, at least `least`.
int most_orders(const Species& species, std::size_t least) {
    std::size_t most = least;
    for (const MatrixCoefficients& at : species.matrices) most = std::max(most, at.a1.size());
    return static_cast<int>(most);
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
            .optics =
                [](const Species& m, double nm) {
                    if (!m.matrices.empty()) return optics_of_matrices(m, nm);
                    rte::Optics optics;
                    optics.single_scattering_albedo = m.parameters[0];
                    optics.one_minus_albedo = 1.0 - m.parameters[0];
                    optics.chi = m.chi;
                    return optics;
                },
            .check =
                [](const Species& m) {
                    if (m.matrices.empty()) return check_moments(m.chi);
                    if (!m.chi.empty())
                        throw std::invalid_argument("chi beside matrices; allowed: one of them");
                    check_matrices(m);
                },
            .most_fourier_orders = [](const Species& m) { return most_orders(m, m.chi.size()); }};
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
            .optics = optics_of_matrices,
            .check = check_matrices,
            .most_fourier_orders = [](const Species& m) { return most_orders(m, 1); }};
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
        .optics = optics_of_file,
        .has_extinction = true,
        .check = check_scattering};
}

}  // namespace

const std::vector<MediumKind>& medium_kinds() {
    static const std::vector<MediumKind> kinds = {
        material(),   index(),    table(),
        isotropic(),  rayleigh(), henyey_greenstein(),
        moments(),    matrix(),   double_henyey_greenstein(),
        scattering(),
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
            fmt::format("{} wavelengths and {} refractive indices; allowed: "
                        "as many of the one as of the other, at least one",
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
