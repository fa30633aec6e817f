#include <miebrdf/value_derivatives.h>

#include <iostream>

void show_value_derivatives() {
    using namespace miebrdf;
    Scene scene;
    say(scene, "base", {"hg:{w=0.9},0.6"});
    const std::vector<double> nm = {400, 440, 480, 520, 560, 600, 640, 680};
    const Brdf brdf = solve(scene, nm);

    const WithDerivatives<HdrfValues> sky =
        hdrf_derivatives(brdf, {"w"}, {{0.5}, {0.9}, {30}}, 0.2);
    std::cout << "HDRF " << sky.values.hdrf[0][0] << ", by w " << sky.derivatives[0].hdrf[0][0]
              << '\n';

    const auto albedo = brdf.derivatives({"w"}).albedo({0.5});
    const ColourDerivative colour = derivative_of_colour(
        Colorimeter(nm), albedo.values.spherical_albedo, albedo.derivatives[0].spherical_albedo);
    std::cout << "Y by w " << colour.xyz.y << ", L* by w " << colour.lab.l << ", encoded red "
              << colour.encoded.red << '\n';
}
