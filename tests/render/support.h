// Small scenes shared by the renderer's tests.
#pragma once

#include <memory>
#include <vector>

#include "pipeline/render/renderer.h"
#include "tests/render/analytic_brdf.h"

namespace miebrdf::render {

inline const Eigen::Vector3d kFront = Eigen::Vector3d::UnitZ();

/// A unit sphere of one material, without light.
inline RenderScene sphere_scene(std::shared_ptr<const RenderBrdf> material) {
    return {RayScene::sphere(Eigen::Vector3d::Zero(), 1.0), {}, {std::move(material)}, {}};
}

inline std::shared_ptr<const RenderBrdf> lambertian(std::vector<double> albedo) {
    return std::make_shared<LambertianBrdf>(std::move(albedo));
}

/// Parallel rays, the object's bounding sphere touching the picture's edges.
inline Camera parallel_camera(const RenderScene& scene, const Eigen::Vector3d& towards = kFront) {
    return Camera(scene.object.bounds(), towards, 0.0, 1.0, 1.0);
}

/// Mean over all pixels of one wavelength.
inline double mean_radiance(const SpectralPicture& picture, int wavelength = 0) {
    double sum = 0.0;
    for (int y = 0; y < picture.radiance.height; ++y) {
        for (int x = 0; x < picture.radiance.width; ++x) {
            sum += double(picture.radiance.pixel(x, y)[wavelength]);
        }
    }
    return sum / picture.radiance.height / picture.radiance.width;
}

}  // namespace miebrdf::render
