#include <miebrdf/brdf.h>
#include <miebrdf/sampling.h>

#include <iostream>

void show_sampling() {
    using namespace miebrdf;
    const BrdfTable table = solve({.base = medium("hg:0.9,0.3")}, {550}).table();
    const DirectionSampler sampler(table, SamplerOptions{.incidences = 9});
    double albedo = 0.0, brdf = 0.0;
    constexpr int kSide = 16;  // points in the middle of 16 x 16 cells
    for (int i = 0; i < kSide * kSide; ++i) {
        const SampledDirection to =
            sampler.sample(0.5, (i % kSide + 0.5) / kSide, (i / kSide + 0.5) / kSide);
        table.evaluate(std::vector{Direction{0.5, to.mu_out, to.azimuth_deg}}, {&brdf, 1});
        albedo += brdf * to.mu_out / to.density / (kSide * kSide);
    }
    std::cout << "albedo " << albedo << "; density of another direction "
              << sampler.density(0.5, 0.7, 90.0) << " / sr\n";
}
