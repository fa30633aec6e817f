// libzip's functions, loaded when they are called first (materials/libraries/late_library.h).
// libzip brings OpenSSL for encrypted archives.
#pragma once

#include <zip.h>

#include "materials/libraries/late_library.h"

namespace miebrdf {

inline const LateLibrary& libzip() {
    static const LateLibrary library(MIEBRDF_LATE_ZIP);
    return library;
}

}  // namespace miebrdf

// clang-format off
#define zip_close(...) MIEBRDF_LATE(::miebrdf::libzip(), zip_close)(__VA_ARGS__)
#define zip_discard(...) MIEBRDF_LATE(::miebrdf::libzip(), zip_discard)(__VA_ARGS__)
#define zip_error_fini(...) MIEBRDF_LATE(::miebrdf::libzip(), zip_error_fini)(__VA_ARGS__)
#define zip_error_init(...) MIEBRDF_LATE(::miebrdf::libzip(), zip_error_init)(__VA_ARGS__)
#define zip_error_set(...) MIEBRDF_LATE(::miebrdf::libzip(), zip_error_set)(__VA_ARGS__)
#define zip_error_strerror(...) MIEBRDF_LATE(::miebrdf::libzip(), zip_error_strerror)(__VA_ARGS__)
#define zip_error_to_data(...) MIEBRDF_LATE(::miebrdf::libzip(), zip_error_to_data)(__VA_ARGS__)
#define zip_fclose(...) MIEBRDF_LATE(::miebrdf::libzip(), zip_fclose)(__VA_ARGS__)
#define zip_file_add(...) MIEBRDF_LATE(::miebrdf::libzip(), zip_file_add)(__VA_ARGS__)
#define zip_file_set_dostime(...) MIEBRDF_LATE(::miebrdf::libzip(), zip_file_set_dostime)(__VA_ARGS__)
#define zip_fopen_index(...) MIEBRDF_LATE(::miebrdf::libzip(), zip_fopen_index)(__VA_ARGS__)
#define zip_fread(...) MIEBRDF_LATE(::miebrdf::libzip(), zip_fread)(__VA_ARGS__)
#define zip_get_num_entries(...) MIEBRDF_LATE(::miebrdf::libzip(), zip_get_num_entries)(__VA_ARGS__)
#define zip_open_from_source(...) MIEBRDF_LATE(::miebrdf::libzip(), zip_open_from_source)(__VA_ARGS__)
#define zip_set_file_compression(...) MIEBRDF_LATE(::miebrdf::libzip(), zip_set_file_compression)(__VA_ARGS__)
#define zip_source_buffer_create(...) MIEBRDF_LATE(::miebrdf::libzip(), zip_source_buffer_create)(__VA_ARGS__)
#define zip_source_buffer_fragment(...) MIEBRDF_LATE(::miebrdf::libzip(), zip_source_buffer_fragment)(__VA_ARGS__)
#define zip_source_free(...) MIEBRDF_LATE(::miebrdf::libzip(), zip_source_free)(__VA_ARGS__)
#define zip_source_function_create(...) MIEBRDF_LATE(::miebrdf::libzip(), zip_source_function_create)(__VA_ARGS__)
#define zip_source_make_command_bitmap(...) MIEBRDF_LATE(::miebrdf::libzip(), zip_source_make_command_bitmap)(__VA_ARGS__)
#define zip_stat_index(...) MIEBRDF_LATE(::miebrdf::libzip(), zip_stat_index)(__VA_ARGS__)
#define zip_stat_init(...) MIEBRDF_LATE(::miebrdf::libzip(), zip_stat_init)(__VA_ARGS__)
#define zip_strerror(...) MIEBRDF_LATE(::miebrdf::libzip(), zip_strerror)(__VA_ARGS__)
// clang-format on
