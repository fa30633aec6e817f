// libzip, opened with the first archive: it brings libcrypto and others, which take 2.5 ms to load.
// Its functions keep their names here.
#pragma once

#include <dlfcn.h>
#include <fmt/format.h>
#include <zip.h>

#include <miebrdf/error.h>

namespace miebrdf {

inline void* symbol_of_zip(const char* function) {
    static void* const library = ::dlopen(MIEBRDF_LIBZIP, RTLD_LAZY | RTLD_LOCAL);
    void* found = library != nullptr ? ::dlsym(library, function) : nullptr;
    if (found == nullptr)
        throw UsageError(fmt::format("npz: {} cannot be opened; install libzip", MIEBRDF_LIBZIP));
    return found;
}

}  // namespace miebrdf

#define MIEBRDF_ZIP(name) (*reinterpret_cast<decltype(&::name)>(::miebrdf::symbol_of_zip(#name)))
#define zip_close MIEBRDF_ZIP(zip_close)
#define zip_discard MIEBRDF_ZIP(zip_discard)
#define zip_error_fini MIEBRDF_ZIP(zip_error_fini)
#define zip_error_init MIEBRDF_ZIP(zip_error_init)
#define zip_error_set MIEBRDF_ZIP(zip_error_set)
#define zip_error_strerror MIEBRDF_ZIP(zip_error_strerror)
#define zip_error_to_data MIEBRDF_ZIP(zip_error_to_data)
#define zip_fclose MIEBRDF_ZIP(zip_fclose)
#define zip_file_add MIEBRDF_ZIP(zip_file_add)
#define zip_file_set_dostime MIEBRDF_ZIP(zip_file_set_dostime)
#define zip_fopen_index MIEBRDF_ZIP(zip_fopen_index)
#define zip_fread MIEBRDF_ZIP(zip_fread)
#define zip_get_num_entries MIEBRDF_ZIP(zip_get_num_entries)
#define zip_open_from_source MIEBRDF_ZIP(zip_open_from_source)
#define zip_set_file_compression MIEBRDF_ZIP(zip_set_file_compression)
#define zip_source_buffer_create MIEBRDF_ZIP(zip_source_buffer_create)
#define zip_source_buffer_fragment MIEBRDF_ZIP(zip_source_buffer_fragment)
#define zip_source_free MIEBRDF_ZIP(zip_source_free)
#define zip_source_function_create MIEBRDF_ZIP(zip_source_function_create)
#define zip_source_make_command_bitmap MIEBRDF_ZIP(zip_source_make_command_bitmap)
#define zip_stat_index MIEBRDF_ZIP(zip_stat_index)
#define zip_stat_init MIEBRDF_ZIP(zip_stat_init)
#define zip_strerror MIEBRDF_ZIP(zip_strerror)
