// Bundled objects, made by formula.
#pragma once

#include "pipeline/render/mesh.h"

namespace miebrdf::render {

/// A trefoil knot of round tube: curved both ways everywhere, and it shadows itself.
/// Centre line ((2 + cos 3t) cos 2t, (2 + cos 3t) sin 2t, 1.5 sin 3t) / 3, tube radius 0.3, exact
/// normals.
/// @param segments  along the knot; an eighth of them around the tube
TriangleMesh make_knot(int segments = 960);

/// A plaque 2 wide and 1 high in the plane of x and y, bulging towards +z by `bulge` in its
/// middle as part of a parabolic cylinder upright: for pictures and text laid on a material.
TriangleMesh make_plaque(double bulge = 0.3, int segments = 400);

}  // namespace miebrdf::render
