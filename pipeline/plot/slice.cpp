#include "pipeline/plot/slice.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <stdexcept>

#include "pipeline/plot/colour_map.h"
#include "pipeline/plot/svg.h"
#include "pipeline/plot/words.h"
#include "pipeline/solve/vector_pairs.h"

namespace miebrdf::plot {

std::optional<Direction> slice_direction(double theta_h_deg, double theta_d_deg, double phi_d_deg) {
    const double cos_h = std::cos(theta_h_deg * kDegree), sin_h = std::sin(theta_h_deg * kDegree);
    const Eigen::Vector3d d = spherical(theta_d_deg * kDegree, phi_d_deg * kDegree);
    const Eigen::Vector3d in(cos_h * d.x() + sin_h * d.z(), d.y(), cos_h * d.z() - sin_h * d.x());
    const Eigen::Vector3d out = mirrored(in, {sin_h, 0.0, cos_h});
    // Less than rounding above the horizon is on it.
    if (!(in.z() > 1e-14 && out.z() > 1e-14)) return std::nullopt;
    return direction_of(in, out);
}

namespace {

constexpr double kWidth = 460.0;
constexpr double kSide = 290.0;
constexpr int kLeastPixels = 870;

void draw_angles(SvgDrawing& drawing, Point corner, double azimuth_deg) {
    const Stroke edge{"#000000", 1.0, {}};
    drawing.frame(corner, kSide, kSide, edge);
    for (int angle = 0; angle <= 90; angle += 15) {
        const double along = kSide * angle / 90;
        const double x = corner.x + along, y = corner.y + kSide - along;
        drawing.line({x, corner.y + kSide}, {x, corner.y + kSide + 5}, edge);
        drawing.line({corner.x - 5, y}, {corner.x, y}, edge);
        if (angle % 30 != 0) continue;
        drawing.text({x, corner.y + kSide + 18}, fmt::format("{}\u00b0", angle),
                     {12, Anchor::middle, 0, "#000000"});
        drawing.text({corner.x - 8, y + 4}, fmt::format("{}\u00b0", angle),
                     {12, Anchor::end, 0, "#000000"});
    }
    drawing.text({corner.x + 0.5 * kSide, corner.y + kSide + 37}, "half angle \u03b8_h",
                 {13, Anchor::middle, 0, "#000000"});
    drawing.text({16, corner.y + 0.5 * kSide},
                 fmt::format("difference angle \u03b8_d  (\u03c6_d = {:g}\u00b0)", azimuth_deg),
                 {13, Anchor::middle, -90, "#000000"});
}

void check(const SliceMap& map) {
    if ((map.half_cells >= 1 && map.difference_cells >= 1) &&
        map.value.size() == static_cast<std::size_t>(map.half_cells) * map.difference_cells)
        return;
    throw std::invalid_argument(fmt::format("{} values for {} x {} cells of a slice",
                                            map.value.size(), map.half_cells,
                                            map.difference_cells));
}

}  // namespace

PixelMap pixels_of(const SliceMap& map, const Axis& axis) {
    check(map);
    // Every cell has as many pixels as the page can show.
    const int across = std::max(1, kLeastPixels / map.half_cells),
              up = std::max(1, kLeastPixels / map.difference_cells);
    PixelMap pixels(across * map.half_cells, up * map.difference_cells);
    for (int y = 0; y < up * map.difference_cells; ++y) {
        const int d = map.difference_cells - 1 - y / up;
        for (int x = 0; x < across * map.half_cells; ++x)
            pixels.set(x, y, axis,
                       map.value[static_cast<std::size_t>(d * map.half_cells + x / across)]);
    }
    return pixels;
}

Picture draw_slice(const SliceMap& map, const Caption& caption) {
    check(map);
    const Axis axis({map.value_label, map.scale, map.lowest, map.highest}, map.value);
    const Point corner{58, draw_title(nullptr, caption.title, kWidth) + 6.0};
    SvgDrawing drawing(kWidth, std::ceil(corner.y + kSide + 48));
    draw_title(&drawing, caption.title, kWidth);
    pixels_of(map, axis).draw(drawing, corner, kSide, kSide);
    draw_angles(drawing, corner, map.azimuth_deg);
    draw_colour_bar(drawing, axis, {corner.x + kSide + 20, corner.y}, 16, kSide);
    return {drawing.document(caption.title, caption.command), drawing.width(), drawing.height()};
}

}  // namespace miebrdf::plot
