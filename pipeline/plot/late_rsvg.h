// The functions of librsvg, and of cairo and GLib below it, that pictures need, loaded when they
// are called first (materials/libraries/late_library.h). librsvg brings 40 libraries, with text
// layout and fonts.
#pragma once

#include <cairo.h>
#include <librsvg/rsvg.h>

#include "materials/libraries/late_library.h"

namespace miebrdf::plot {

inline const LateLibrary& librsvg() {
    static const LateLibrary library(MIEBRDF_LATE_RSVG);
    return library;
}

}  // namespace miebrdf::plot

// clang-format off
#define cairo_create(...) MIEBRDF_LATE(::miebrdf::plot::librsvg(), cairo_create)(__VA_ARGS__)
#define cairo_destroy(...) MIEBRDF_LATE(::miebrdf::plot::librsvg(), cairo_destroy)(__VA_ARGS__)
#define cairo_image_surface_create(...) MIEBRDF_LATE(::miebrdf::plot::librsvg(), cairo_image_surface_create)(__VA_ARGS__)
#define cairo_status_to_string(...) MIEBRDF_LATE(::miebrdf::plot::librsvg(), cairo_status_to_string)(__VA_ARGS__)
#define cairo_surface_destroy(...) MIEBRDF_LATE(::miebrdf::plot::librsvg(), cairo_surface_destroy)(__VA_ARGS__)
#define cairo_surface_write_to_png_stream(...) MIEBRDF_LATE(::miebrdf::plot::librsvg(), cairo_surface_write_to_png_stream)(__VA_ARGS__)
#define g_error_free(...) MIEBRDF_LATE(::miebrdf::plot::librsvg(), g_error_free)(__VA_ARGS__)
#define g_object_unref(...) MIEBRDF_LATE(::miebrdf::plot::librsvg(), g_object_unref)(__VA_ARGS__)
#define rsvg_handle_new_from_data(...) MIEBRDF_LATE(::miebrdf::plot::librsvg(), rsvg_handle_new_from_data)(__VA_ARGS__)
#define rsvg_handle_render_document(...) MIEBRDF_LATE(::miebrdf::plot::librsvg(), rsvg_handle_render_document)(__VA_ARGS__)
// clang-format on
