// A material that is in no database: n and k from arrays of one's own, as a pigment over a base
// that is given by its phase function.
#include <miebrdf/brdf.h>
#include <miebrdf/error.h>

#include <iostream>
#include <vector>

int main() try {
    // A band of absorption in the green. Between these wavelengths n and k are interpolated;
    // outside them they are not known, and solve() says so.
    const miebrdf::Species pigment{
        .kind = miebrdf::Species::Kind::table,
        .name = "pigment of mine",
        .wavelength_nm = {420, 480, 520, 550, 580, 640, 700},
        .index = {{1.62, 0.005},
                  {1.55, 0.02},
                  {1.50, 0.15},
                  {1.62, 0.25},
                  {1.75, 0.15},
                  {1.72, 0.01},
                  {1.70, 0.002}},
        .sizes = {.effective_radius_um = 0.15, .effective_variance = 0.1},
    };

    miebrdf::Scene scene;
    scene.base = miebrdf::medium("hg:0.98,0.6");  // albedo and asymmetry, at every wavelength
    scene.layers = {{pigment, 0.5}};              // optical depth 0.5 at 550 nm
    scene.surface = miebrdf::rte::SurfaceOptions{.beckmann_alpha = 0.2};

    const std::vector<double> wavelength_nm = {450, 550, 650};
    const std::vector<double> mu_out = {0.2, 0.6, 1.0};
    const auto values = miebrdf::solve(scene, wavelength_nm, {.tolerance = 1e-3})
                            .evaluate({.mu_in = {0.8}, .mu_out = mu_out, .azimuth_deg = {90}});

    std::cout << "wavelength_nm,mu_out,brdf,of_the_surface\n";
    for (std::size_t w = 0; w < wavelength_nm.size(); ++w) {
        for (std::size_t out = 0; out < mu_out.size(); ++out) {
            std::cout << wavelength_nm[w] << ',' << mu_out[out] << ',' << values.at(w, 0, out, 0)
                      << ',' << values.at(w, 0, out, 0, miebrdf::BrdfPart::surface) << '\n';
        }
    }
    if (!values.converged()) std::cerr << values.shortfall() << '\n';
    return values.converged() ? 0 : 1;
} catch (const miebrdf::Error& error) {
    std::cerr << error.what() << '\n';
    return 2;
}
