// The albedo of snow over the spectrum, clean and under a thin layer of soot-grey dust, as CSV.
#include <miebrdf/brdf.h>
#include <miebrdf/error.h>

#include <iostream>
#include <vector>

int main() try {
    miebrdf::Scene clean;
    clean.base = miebrdf::medium("H2O_ice,radius=100");  // micrometres
    miebrdf::Scene dusty = clean;
    dusty.layers = {miebrdf::layer("C_graphite,radius=0.5@0.05")};  // optical depth 0.05

    std::vector<double> wavelength_nm;
    for (int nm = 400; nm <= 800; nm += 50) wavelength_nm.push_back(nm);
    const std::vector<double> mu_in = {0.5};  // the sun at 60 degrees

    // What both scenes have in common, the ice, goes through Mie theory once.
    const miebrdf::Control control{.memo = miebrdf::make_optics_memo()};
    const auto snow = miebrdf::solve(clean, wavelength_nm, {}, control).albedo(mu_in);
    const auto dust = miebrdf::solve(dusty, wavelength_nm, {}, control).albedo(mu_in);

    std::cout << "wavelength_nm,plane_albedo,spherical_albedo,plane_albedo_dusty\n";
    for (std::size_t w = 0; w < wavelength_nm.size(); ++w) {
        std::cout << wavelength_nm[w] << ',' << snow.at(w, 0) << ',' << snow.spherical_albedo[w]
                  << ',' << dust.at(w, 0) << '\n';
    }
    for (const auto* albedo : {&snow, &dust}) {
        if (!albedo->converged()) std::cerr << albedo->shortfall() << '\n';
    }
    return snow.converged() && dust.converged() ? 0 : 1;
} catch (const miebrdf::Error& error) {
    std::cerr << error.what() << '\n';
    return 2;
}
