// AlGaAs7 paint of optical depth 0.1 on TiO2: the spectral BRDF from C++.
#include <cstdio>

#include "pipeline/solve/brdf.h"

int main() {
    miebrdf::Request request;
    request.scene.base = miebrdf::parse_medium("TiO2");
    request.scene.coats = {miebrdf::parse_coat("AlGaAs7@0.1")};
    request.scene.surface = miebrdf::rte::SurfaceOptions{.beckmann_alpha = 0.3};
    request.wavelength_nm = {450, 550, 650};
    request.directions = {.mu_in = {0.5}, .mu_out = {0.3, 0.6, 0.9}, .azimuth_deg = {90}};

    const miebrdf::BrdfResult result = miebrdf::compute_brdf(request);
    for (const auto& slice : result.slices) {
        for (std::size_t o = 0; o < slice.total.size(); ++o) {
            std::printf("%g nm, mu_out %g: %.5f / sr\n", slice.wavelength_nm,
                        request.directions.mu_out[o], slice.total[o]);
        }
    }
    return result.converged ? 0 : 1;
}
