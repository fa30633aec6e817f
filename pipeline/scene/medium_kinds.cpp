#include "pipeline/scene/medium_kinds.h"

#include <fmt/format.h>
#include <miebrdf/error.h>

#include <stdexcept>

#include "pipeline/scene/moments_file.h"

namespace miebrdf {
namespace {

const MediumParameter kAlbedo = {"single-scattering albedo", "[0, 1]",
                                 [](double a) { return a >= 0.0 && a <= 1.0; }};

MediumKind material() {
    return {.name = "material",
            .form = "NAME",
            .example = "TiO2",
            .help = "spheres of a material of the database, by name or source:KEY",
            .read = [](const std::string& values, Medium& medium) { medium.name = values; },
            .check =
                [](const Medium& m) {
                    if (m.name.empty()) throw std::invalid_argument("a material needs a name");
                }};
}

MediumKind index() {
    return {.name = "index",
            .form = "index:N,K",
            .example = "index:1.5,0.01",
            .help = "spheres of a constant refractive index n + ik",
            .parameters = {{"n", "n > 0", [](double n) { return n > 0.0; }},
                           {"k", "k >= 0", [](double k) { return k >= 0.0; }}}};
}

MediumKind table() {
    return {.name = "table",
            .help = "spheres of a refractive index n + ik given at some wavelengths",
            .check = [](const Medium& m) { own_index(m); }};
}

MediumKind isotropic() {
    return {.name = "isotropic",
            .form = "isotropic:ALBEDO",
            .example = "isotropic:0.9",
            .help = "a medium that scatters alike in all directions",
            .parameters = {kAlbedo},
            .optics = [](const Medium& m) { return rte::isotropic_optics(m.parameters[0]); },
            .most_fourier_orders = [](const Medium&) { return 1; }};
}

MediumKind rayleigh() {
    return {.name = "rayleigh",
            .form = "rayleigh:ALBEDO",
            .example = "rayleigh:0.9",
            .help = "particles much smaller than the wavelength",
            .parameters = {kAlbedo},
            .optics = [](const Medium& m) { return rte::rayleigh_optics(m.parameters[0]); },
            .most_fourier_orders = [](const Medium&) { return 3; }};
}

MediumKind henyey_greenstein() {
    return {.name = "hg",
            .form = "hg:ALBEDO,G",
            .example = "hg:0.9,0.7",
            .help = "the phase function of Henyey and Greenstein (1941) with asymmetry G",
            .parameters = {kAlbedo,
                           {"asymmetry", "(-1, 1)", [](double g) { return g > -1.0 && g < 1.0; }}},
            .optics = [](const Medium& m) {
                return rte::henyey_greenstein_optics(m.parameters[0], m.parameters[1]);
            }};
}

MediumKind moments() {
    return {.name = "moments",
            .form = "moments:FILE",
            .example = "moments:mine.csv",
            .help = "albedo and Legendre moments from a CSV file",
            .parameters = {kAlbedo},
            .read =
                [](const std::string& values, Medium& medium) {
                    MomentsFile file = read_moments_file(values);
                    medium.name = values;
                    medium.parameters = {file.single_scattering_albedo};
                    medium.chi = std::move(file.chi);
                },
            .optics =
                [](const Medium& m) {
                    rte::Optics optics;
                    optics.single_scattering_albedo = m.parameters[0];
                    optics.one_minus_albedo = 1.0 - m.parameters[0];
                    optics.chi = m.chi;
                    return optics;
                },
            .check =
                [](const Medium& m) {
                    rte::Optics optics;
                    optics.chi = m.chi;
                    rte::validate(optics);
                },
            .most_fourier_orders = [](const Medium& m) { return static_cast<int>(m.chi.size()); }};
}

}  // namespace

const std::vector<MediumKind>& medium_kinds() {
    static const std::vector<MediumKind> kinds = {
        material(), index(), table(), isotropic(), rayleigh(), henyey_greenstein(), moments(),
    };
    return kinds;
}

const MediumKind& kind_of(const Medium& medium) {
    for (const MediumKind& kind : medium_kinds()) {
        if (kind.name == medium.kind) return kind;
    }
    throw UsageError(fmt::format("unknown kind of medium '{}'", medium.kind));
}

materials::RefractiveIndex own_index(const Medium& medium) {
    const std::size_t count = medium.wavelength_nm.size();
    if (count == 0 || medium.index.size() != count) {
        throw std::invalid_argument(
            fmt::format("{} wavelengths and {} refractive indices; allowed: "
                        "as many of the one as of the other, at least one",
                        count, medium.index.size()));
    }
    materials::IndexTable table;
    table.wavelength_nm = medium.wavelength_nm;
    for (const std::complex<double> index : medium.index) {
        table.n.push_back(index.real());
        table.k.push_back(index.imag());
    }
    return {medium.name, std::move(table)};
}

}  // namespace miebrdf
