#include <miebrdf/brdf.h>

#include <iostream>

void show_brdf() {
    using namespace miebrdf;
    Scene scene;
    say(scene, "base", {"rayleigh:{w=0.9}"});  // a number with a name: for derivatives
    scene.layers = {layer("hg:0.95,0.6@0.5[grey]")};
    const Brdf brdf = solve(scene, {450, 550}, {.tolerance = 1e-3});
    const Directions directions{.mu_in = {0.5}, .mu_out = {0.3, 0.9}, .azimuth_deg = {0, 180}};

    const BrdfValues values = brdf.evaluate(directions, BrdfParts{.surface = false});
    std::cout << values.at(0, 0, 1, 0) << " / sr, " << name_of(BrdfPart::subsurface) << ' '
              << values.slices[0].of(parse_brdf_part("subsurface"))[2] << '\n';
    const PhysicsReport& physics = values.slices[0].physics;
    std::cout << "reflects at most " << physics.largest_albedo.value_or(0) << ", least value "
              << physics.least_value << '\n';
    const ResultReport& report = values;  // of every kind of result
    const WavelengthReport& worst = report.worst();
    const PhaseNoise& noise = report.noisiest().phase_noise;
    std::cout << report.summary() << "; " << worst.wavelength_nm << " nm is the worst, noise "
              << noise.largest << '\n';
    for (const std::string& line : report.shortfalls()) std::cout << line << '\n';
    for (const std::string& line : report.polarisation()) std::cout << line << '\n';

    const MuellerValues mueller = brdf.mueller(directions);
    std::cout << "polarised by " << mueller.degree_of_linear_polarisation(0, 0, 1, 0) << " at "
              << mueller.angle_of_polarisation_deg(0, 0, 1, 0) << " degrees\n";
    const AlbedoValues albedo = brdf.albedo({0.5, 1.0});
    std::cout << "plane albedo " << albedo.at(0, 1) << ", spherical " << albedo.spherical_albedo[0]
              << ", under a sky " << albedo.under_sky(0, 0, 0.2) << '\n';
    const HdrfValues seen = brdf.hdrf(directions, /*diffuse_fraction*/ 0.2);
    std::cout << "under that sky it looks " << seen.hdrf[0][0] << " as bright as white\n";
    const Sky clear = sky("cie-clear");
    std::cout << "under a clear sky, " << clear.radiance(0.5, 0.0, 0.5, 550)
              << " of the zenith's radiance around the sun, "
              << brdf.hdrf(directions, 0.2, clear).hdrf[0][0] << '\n';
    for (const LayerOptics& of : brdf.layers())
        std::cout << of.layer << ": depth " << of.optical_depth << ", g " << of.asymmetry << '\n';

    const BrdfTable table = brdf.table(TableOptions{.part = BrdfPart::subsurface});
    std::vector<double> spectrum(table.channels().size());
    table.evaluate(std::vector{Direction{0.5, 0.9, 180.0}}, spectrum);

    const BrdfDerivatives by = brdf.derivatives({"w"});
    const WithDerivatives<AlbedoValues> change = by.albedo({0.5});
    std::cout << "d albedo / d " << by.parameters()[0] << " = " << change.derivatives[0].at(0, 0)
              << '\n';
    std::cout << brdf.sources().size() << " sources, tolerance " << brdf.options().tolerance << ", "
              << describe(brdf.scene()) << " at " << brdf.wavelength_nm().size()
              << " wavelengths, solved: " << brdf.report().converged() << '\n';

    Scene film{.layers = {layer("hg:0.9,0.6@1")}};
    film.substrate = substrate("none");
    const FilmTransmission passed(solve(film, {550}));
    const std::vector<Direction> straight_on{{0.8, 0.7, 0.0}};
    double btdf = 0.0;
    passed.evaluate(straight_on, {&btdf, 1});
    std::cout << passed.provenance().component << ": " << btdf << " / sr, unscattered "
              << passed.unscattered(0, 0.8) << ", " << kTransmitted << '\n';
}
