// libpng's functions, loaded when they are called first (materials/libraries/late_library.h).
#pragma once

#include <png.h>

#include "materials/libraries/late_library.h"

namespace miebrdf::render {

inline const LateLibrary& libpng() {
    static const LateLibrary library(MIEBRDF_LATE_PNG);
    return library;
}

}  // namespace miebrdf::render

// clang-format off
#define png_create_info_struct(...) MIEBRDF_LATE(::miebrdf::render::libpng(), png_create_info_struct)(__VA_ARGS__)
#define png_create_write_struct(...) MIEBRDF_LATE(::miebrdf::render::libpng(), png_create_write_struct)(__VA_ARGS__)
#define png_destroy_write_struct(...) MIEBRDF_LATE(::miebrdf::render::libpng(), png_destroy_write_struct)(__VA_ARGS__)
#define png_get_io_ptr(...) MIEBRDF_LATE(::miebrdf::render::libpng(), png_get_io_ptr)(__VA_ARGS__)
#define png_image_begin_read_from_file(...) MIEBRDF_LATE(::miebrdf::render::libpng(), png_image_begin_read_from_file)(__VA_ARGS__)
#define png_image_finish_read(...) MIEBRDF_LATE(::miebrdf::render::libpng(), png_image_finish_read)(__VA_ARGS__)
#define png_image_free(...) MIEBRDF_LATE(::miebrdf::render::libpng(), png_image_free)(__VA_ARGS__)
#define png_set_IHDR(...) MIEBRDF_LATE(::miebrdf::render::libpng(), png_set_IHDR)(__VA_ARGS__)
#define png_set_compression_level(...) MIEBRDF_LATE(::miebrdf::render::libpng(), png_set_compression_level)(__VA_ARGS__)
#define png_set_longjmp_fn(...) MIEBRDF_LATE(::miebrdf::render::libpng(), png_set_longjmp_fn)(__VA_ARGS__)
#define png_set_sRGB(...) MIEBRDF_LATE(::miebrdf::render::libpng(), png_set_sRGB)(__VA_ARGS__)
#define png_set_text(...) MIEBRDF_LATE(::miebrdf::render::libpng(), png_set_text)(__VA_ARGS__)
#define png_set_write_fn(...) MIEBRDF_LATE(::miebrdf::render::libpng(), png_set_write_fn)(__VA_ARGS__)
#define png_write_end(...) MIEBRDF_LATE(::miebrdf::render::libpng(), png_write_end)(__VA_ARGS__)
#define png_write_info(...) MIEBRDF_LATE(::miebrdf::render::libpng(), png_write_info)(__VA_ARGS__)
#define png_write_row(...) MIEBRDF_LATE(::miebrdf::render::libpng(), png_write_row)(__VA_ARGS__)
// clang-format on
