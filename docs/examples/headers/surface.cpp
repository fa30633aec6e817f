#include <miebrdf/surface.h>

#include <iostream>

void show_surface() {
    using namespace miebrdf::rte;
    const SurfaceOptions rough{.beckmann_alpha = 0.2,
                               .distribution = MicrofacetDistribution::ggx,
                               .shadowing = Shadowing::smith_correlated,
                               .fresnel = FresnelKind::exact};
    validate(rough);  // @throws UsageError
    const SurfaceLobe gold({0.3, 2.7}, rough);
    std::cout << gold.brdf(0.5, 0.5, 0.0) << " / sr in the mirror direction; reflects "
              << gold.directional_reflectance(0.5) << " of " << gold.refractive_index() << ", lets "
              << gold.averaged_diffuse_reflectance_factor() << " through\n";
    const IntegralResult reflected = directional_reflectance({0.3, 2.7}, rough, 0.5, 1e-4);
    const IntegralResult mean =
        mean_transmittance([](double mu) { return 0.04 + 0.1 * (1 - mu); }, HemisphereMean::cosine);
    std::cout << reflected.value << " by " << reflected.nodes << " nodes; mean " << mean.value
              << '\n';
    const SurfaceTransmission through(gold, SurfaceCoupling::reciprocal);
    const SurfaceWeights weights = through.weights(0.5);
    std::cout << "in " << weights.in << " = " << through.in(0.5) << ", out " << through.out(0.5)
              << '\n';
    const Boundary varnish{.roughness = 0.1, .matrices = BoundaryMatrices::followed};
    validate(varnish);
    std::cout << (varnish.is_rough() ? "rough\n" : "smooth\n");
    const GroundBrdf soil{.kind = GroundBrdf::Kind::rpv, .values = {0.1, 0.8, -0.1, 0.1}};
    validate(soil);
    const GroundEnergy energy = energy_of(soil);
    std::cout << soil.model().name << ": hot spot " << soil.reflection(0.5, 0.5, -1.0)
              << ", spherical albedo " << energy.spherical_albedo << '\n';
    for (const GroundModel& model : ground_models()) {
        for (const GroundParameter& one : model.parameters)
            std::cout << model.name << ' ' << one.name << ": " << one.low << " to " << one.high
                      << '\n';
    }
}
