// miebrdf layers: the coefficients of every layer of a scene.
#include "pipeline/solve/brdf_state.h"
#include "tools/miebrdf/scene_options.h"

namespace miebrdf::program {
namespace {

int write_layers(const Brdf& brdf, const Shell& shell) {
    Table table;
    table.facts.emplace_back(
        "units",
        "wavelength_nm: nm in vacuum; optical_depth, albedo, asymmetry: dimensionless; per_um: "
        "1/um; k_km, s_km: Kubelka-Munk's for diffuse light, 1/um; mass_extinction: m2 per kg of "
        "particles; empty: needs amounts or densities, or the layer has no depth");
    for (const std::string& source : brdf.sources()) table.facts.emplace_back("source", source);
    const std::string particles = describe_particles(brdf.scene());
    if (!particles.empty()) table.facts.emplace_back("particles", particles);
    for (const std::string& note : BrdfState::of(brdf).resolved.notes) {
        table.facts.emplace_back("note", note);
        shell.note("note: " + note);
    }
    table.columns = {"wavelength_nm",
                     "layer",
                     "optical_depth",
                     "single_scattering_albedo",
                     "asymmetry",
                     "scattering_per_um",
                     "absorption_per_um",
                     "reduced_scattering_per_um",
                     "k_km",
                     "s_km",
                     "mass_extinction_m2_per_kg"};
    for (const LayerOptics& layer : brdf.layers()) {
        table.rows.push_back({brdf.wavelength_nm()[layer.wavelength], layer.layer,
                              layer.optical_depth, layer.single_scattering_albedo, layer.asymmetry,
                              cell_of(layer.scattering_per_um), cell_of(layer.absorption_per_um),
                              cell_of(layer.reduced_scattering_per_um), cell_of(layer.k_km),
                              cell_of(layer.s_km), cell_of(layer.mass_extinction_m2_per_kg)});
    }
    return shell.write(std::move(table));
}

}  // namespace

void add_layers(CLI::App& command, Shell& shell) {
    auto arguments = std::make_shared<SceneArguments>();
    arguments->add_to(command, shell);
    shell.add_common_options(command);
    command.footer(
        "Example:\n  miebrdf layers --substrate black --coat \"TiO2,radius=0.13,volume=15% in "
        "index:1.5@40um\" --wavelengths 450,550,650");
    shell.on_prepare(command, [arguments, &shell]() -> Job {
        const Brdf brdf = solved(arguments->parse(), shell.control());
        return [brdf, &shell] { return write_layers(brdf, shell); };
    });
}

}  // namespace miebrdf::program
