// Says which material lies where on an object.
#pragma once

#include <cstddef>
#include <string>
#include <variant>

#include "pipeline/render/image.h"
#include "pipeline/render/ray_scene.h"

namespace miebrdf::render {

/// How a mask is laid on an object.
enum class MaskProjection {
    front,  ///< along -z onto the object's bounding rectangle in x and y
    uv,     ///< by the texture coordinates of the file, the first row of the mask at v = 1
};

class MaterialMap {
  public:
    /// Material 0 everywhere.
    MaterialMap() = default;

    /// Material 0 left of a plane, 1 right of it.
    /// @param fraction  where the plane x = const cuts the object's bounding box: 0 at its left
    ///                  face, 1 at its right face
    static MaterialMap split(double fraction, const Bounds& bounds);

    /// Grey levels cut into as many equal steps as there are materials: black is material 0,
    /// white the last. Nearest pixel.
    /// @param name  of the mask, for messages
    /// @throws InputError  when the mask has not the shape of the object's bounding rectangle
    ///                     (front), or the object has no texture coordinates (uv)
    static MaterialMap mask(const Image& grey, std::size_t materials, MaskProjection projection,
                            const RayScene& object, const std::string& name);

    std::size_t material_at(const Hit& hit) const;

  private:
    struct Split {
        double x;
    };
    struct Mask {
        Image grey;
        std::size_t materials;
        MaskProjection projection;
        Bounds bounds;
    };
    std::variant<std::monostate, Split, Mask> map_;
};

}  // namespace miebrdf::render
