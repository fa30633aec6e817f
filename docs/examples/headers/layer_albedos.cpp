#include <miebrdf/layer_albedos.h>

#include <iostream>
#include <vector>

void show_layer_albedos() {
    const std::vector<double> w = {0.5, 0.9, 0.99}, g = {0.7}, depth = {2.0}, index = {1.0},
                              ground = {0.1}, mu_in = {0.5, 1.0};
    const miebrdf::LayerAlbedos found =
        miebrdf::layer_albedos(miebrdf::LayerBatch{w, g, depth, index, ground, mu_in});
    for (std::size_t layer = 0; layer < w.size(); ++layer)
        std::cout << w[layer] << ": " << found.plane_albedo[layer * mu_in.size()] << '\n';
    const std::vector<double> colour = {0.8, 0.5, 0.3}, below_glass = {1.5};
    for (const double albedo : miebrdf::subsurface_albedo(colour, g, below_glass))
        std::cout << albedo << '\n';
    std::cout << miebrdf::subsurface_colour(w, g, index).front() << '\n';
}
