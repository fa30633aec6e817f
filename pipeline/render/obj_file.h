// Wavefront OBJ files.
#pragma once

#include <string>

#include "pipeline/render/mesh.h"

namespace miebrdf::render {

/// Reads all faces of a file, polygons split into triangles; materials are ignored. Without
/// normals in the file, corners are smoothed over neighbouring faces that turn by less than 40
/// degrees, and sharper edges stay sharp.
/// @throws InputError  when the file is missing, no OBJ, or holds no valid mesh (validate)
TriangleMesh read_obj(const std::string& path);

}  // namespace miebrdf::render
