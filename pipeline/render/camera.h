// Where a picture is taken from.
#pragma once

#include "pipeline/render/ray_scene.h"

namespace miebrdf::render {

class Camera {
  public:
    /// Looks at the middle of an object from a direction, y up, so that its bounding sphere fits
    /// the shorter side of the picture.
    /// @param towards_camera     unit vector from the object, not along y
    /// @param field_of_view_deg  of the shorter side, in (0, 120]; 0: parallel rays (orthographic)
    /// @param zoom               > 1: closer than the bounding sphere needs
    /// @param aspect             width / height of the picture
    Camera(const Bounds& object, const Eigen::Vector3d& towards_camera, double field_of_view_deg,
           double zoom, double aspect);

    /// @param x, y  position in the picture, both in [0, 1], from the upper left corner
    Ray ray(double x, double y) const;

  private:
    Eigen::Vector3d eye_;
    Eigen::Vector3d forward_;
    Eigen::Vector3d right_;  ///< half the picture's width at distance 1 (or anywhere, orthographic)
    Eigen::Vector3d up_;
    bool orthographic_;
};

}  // namespace miebrdf::render
