#include "pipeline/render/material_map.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include <miebrdf/error.h>

namespace miebrdf::render {
namespace {

/// A mask may differ from the rectangle it is laid on by the rounding of its size to pixels.
bool same_shape(const Image& mask, double width, double height) {
    return std::abs(mask.width * height - mask.height * width) <= 1.0 * std::max(width, height);
}

}  // namespace

MaterialMap MaterialMap::split(double fraction, const Bounds& bounds) {
    MaterialMap map;
    map.map_ = Split{bounds.lower.x() + fraction * (bounds.upper - bounds.lower).x()};
    return map;
}

MaterialMap MaterialMap::mask(const Image& grey, std::size_t materials, MaskProjection projection,
                              const RayScene& object, const std::string& name) {
    const Bounds& bounds = object.bounds();
    const Eigen::Vector3d extent = bounds.upper - bounds.lower;
    if (projection == MaskProjection::front && !same_shape(grey, extent.x(), extent.y())) {
        throw InputError(
            fmt::format("{}: the mask is {} x {} pixels, but the object it is laid on is {:.4g} "
                        "wide and {:.4g} "
                        "high; a mask {} pixels wide must be {:.0f} high",
                        name, grey.width, grey.height, extent.x(), extent.y(), grey.width,
                        grey.width * extent.y() / extent.x()));
    }
    if (projection == MaskProjection::uv && !object.has_uv()) {
        throw InputError(
            fmt::format("{}: the object has no texture coordinates to lay the mask on; "
                        "project it from the front",
                        name));
    }
    MaterialMap map;
    map.map_ = Mask{grey, materials, projection, bounds};
    return map;
}

std::size_t MaterialMap::material_at(const Hit& hit) const {
    if (const auto* split = std::get_if<Split>(&map_)) return hit.position.x() < split->x ? 0 : 1;
    const auto* mask = std::get_if<Mask>(&map_);
    if (mask == nullptr) return 0;
    double u = hit.uv.x(), v = hit.uv.y();
    if (mask->projection == MaskProjection::front) {
        const Eigen::Vector3d extent = mask->bounds.upper - mask->bounds.lower;
        u = (hit.position.x() - mask->bounds.lower.x()) / extent.x();
        v = (hit.position.y() - mask->bounds.lower.y()) / extent.y();
    }
    const int x = std::clamp(int(u * mask->grey.width), 0, mask->grey.width - 1);
    const int y = std::clamp(int((1 - v) * mask->grey.height), 0, mask->grey.height - 1);
    const double level = double(*mask->grey.pixel(x, y));
    return std::min(std::size_t(level * double(mask->materials)), mask->materials - 1);
}

}  // namespace miebrdf::render
