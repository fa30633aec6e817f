#include <miebrdf/scene.h>

#include <iostream>

void show_scene() {
    using namespace miebrdf;
    // Words, as the program has them; the same without words follows.
    const Species rutile = species("TiO2,radius=0.13,volume=15%");
    const Medium paint =
        medium("TiO2,radius=0.13,volume=15% + index:1.5,0.1,radius=1,volume=1% in PMMA");
    const Layer film = layer("TiO2,radius=0.13,volume=15% in PMMA@40um");
    std::cout << describe(rutile) << "; Mie theory: " << needs_mie(rutile)
              << ", may be mixed: " << has_extinction(rutile) << "; " << paint.species.size()
              << " species in " << describe(*paint.host) << ", " << describe(film.depth) << '\n';

    Species glass{.kind = Species::Kind::index, .parameters = {1.5, 0.0}};
    glass.sizes = ParticleSizes{.effective_radius_um = 1.0};
    glass.amount = Amount{Amount::Kind::volume_fraction, 0.05};
    glass.coatings = {Coating(coating("SiO2@10nm"))};
    glass.shape = GrainShape{};  // spheres
    glass.phase = PhaseForm::mie;
    std::cout << describe(glass) << " under " << describe(glass.coatings[0]) << '\n';

    Scene scene;
    scene.substrate = substrate("lambert:0.3");  // or with an albedo at each wavelength:
    Substrate ground{.kind = Substrate::Kind::lambertian, .albedo = {0.2, 0.4}};
    ground.wavelength_nm = {400, 700};
    scene.layers = {Layer{Medium({glass}, Host{.index = 1.33}), Depth(0.5)},
                    Layer{medium("hg:0.9,0.5"), grey(0.1)}};
    scene.particles = ParticleOptions{.packing = Packing::percus_yevick};
    std::cout << describe(scene) << "; on " << describe(*scene.substrate) << "; on top "
              << describe(top_medium(scene)) << " in "
              << describe(host_of(scene, top_medium(scene))) << '\n';
    validate(scene);  // @throws UsageError

    // Media of one's own moments and matrices come from files, or are filled in.
    Species own{.kind = Species::Kind::matrix, .name = "own", .parameters = {0.9}};
    own.matrices = {MatrixCoefficients{}};
    const FileScattering& none = own.scattering;
    std::cout << none.albedo.size() << ' ' << describe(host("PMMA")) << ' '
              << describe(depth("0.5[450nm]")) << ' ' << describe(ground) << '\n';

    // Numbers with names: for fits and derivatives.
    Scene fitted;
    say(fitted, "base", {"hg:{w=0.9},{g=0.6}"});
    say(fitted, "boundary", {describe(boundary("rough:0.1"))});
    for (const NamedNumber& number : named_numbers(fitted))
        std::cout << number.name << " = " << number.value << '\n';
    const Scene darker = with_values(fitted, {NamedNumber{"w", 0.5}});
    const NamedWords& said = darker.named[0];
    std::cout << said.word << ": " << describe(darker) << "; "
              << with_values("hg:{w},0", {{"w", 0.5}}) << '\n';
    for (const MediumForm& form : medium_forms())
        std::cout << form.form << ", e.g. " << form.example << '\n';
}
