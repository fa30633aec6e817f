// SQLite's functions, loaded when they are called first (materials/libraries/late_library.h).
#pragma once

#include <sqlite3.h>

#include "materials/libraries/late_library.h"

namespace miebrdf::materials {

inline const LateLibrary& libsqlite() {
    static const LateLibrary library(MIEBRDF_LATE_SQLITE);
    return library;
}

}  // namespace miebrdf::materials

// clang-format off
#define sqlite3_bind_blob64(...) MIEBRDF_LATE(::miebrdf::materials::libsqlite(), sqlite3_bind_blob64)(__VA_ARGS__)
#define sqlite3_bind_double(...) MIEBRDF_LATE(::miebrdf::materials::libsqlite(), sqlite3_bind_double)(__VA_ARGS__)
#define sqlite3_bind_int64(...) MIEBRDF_LATE(::miebrdf::materials::libsqlite(), sqlite3_bind_int64)(__VA_ARGS__)
#define sqlite3_bind_null(...) MIEBRDF_LATE(::miebrdf::materials::libsqlite(), sqlite3_bind_null)(__VA_ARGS__)
#define sqlite3_bind_text64(...) MIEBRDF_LATE(::miebrdf::materials::libsqlite(), sqlite3_bind_text64)(__VA_ARGS__)
#define sqlite3_busy_timeout(...) MIEBRDF_LATE(::miebrdf::materials::libsqlite(), sqlite3_busy_timeout)(__VA_ARGS__)
#define sqlite3_changes(...) MIEBRDF_LATE(::miebrdf::materials::libsqlite(), sqlite3_changes)(__VA_ARGS__)
#define sqlite3_clear_bindings(...) MIEBRDF_LATE(::miebrdf::materials::libsqlite(), sqlite3_clear_bindings)(__VA_ARGS__)
#define sqlite3_close_v2(...) MIEBRDF_LATE(::miebrdf::materials::libsqlite(), sqlite3_close_v2)(__VA_ARGS__)
#define sqlite3_column_blob(...) MIEBRDF_LATE(::miebrdf::materials::libsqlite(), sqlite3_column_blob)(__VA_ARGS__)
#define sqlite3_column_bytes(...) MIEBRDF_LATE(::miebrdf::materials::libsqlite(), sqlite3_column_bytes)(__VA_ARGS__)
#define sqlite3_column_double(...) MIEBRDF_LATE(::miebrdf::materials::libsqlite(), sqlite3_column_double)(__VA_ARGS__)
#define sqlite3_column_int64(...) MIEBRDF_LATE(::miebrdf::materials::libsqlite(), sqlite3_column_int64)(__VA_ARGS__)
#define sqlite3_column_text(...) MIEBRDF_LATE(::miebrdf::materials::libsqlite(), sqlite3_column_text)(__VA_ARGS__)
#define sqlite3_column_type(...) MIEBRDF_LATE(::miebrdf::materials::libsqlite(), sqlite3_column_type)(__VA_ARGS__)
#define sqlite3_deserialize(...) MIEBRDF_LATE(::miebrdf::materials::libsqlite(), sqlite3_deserialize)(__VA_ARGS__)
#define sqlite3_errmsg(...) MIEBRDF_LATE(::miebrdf::materials::libsqlite(), sqlite3_errmsg)(__VA_ARGS__)
#define sqlite3_errstr(...) MIEBRDF_LATE(::miebrdf::materials::libsqlite(), sqlite3_errstr)(__VA_ARGS__)
#define sqlite3_exec(...) MIEBRDF_LATE(::miebrdf::materials::libsqlite(), sqlite3_exec)(__VA_ARGS__)
#define sqlite3_extended_errcode(...) MIEBRDF_LATE(::miebrdf::materials::libsqlite(), sqlite3_extended_errcode)(__VA_ARGS__)
#define sqlite3_finalize(...) MIEBRDF_LATE(::miebrdf::materials::libsqlite(), sqlite3_finalize)(__VA_ARGS__)
#define sqlite3_last_insert_rowid(...) MIEBRDF_LATE(::miebrdf::materials::libsqlite(), sqlite3_last_insert_rowid)(__VA_ARGS__)
#define sqlite3_open_v2(...) MIEBRDF_LATE(::miebrdf::materials::libsqlite(), sqlite3_open_v2)(__VA_ARGS__)
#define sqlite3_prepare_v2(...) MIEBRDF_LATE(::miebrdf::materials::libsqlite(), sqlite3_prepare_v2)(__VA_ARGS__)
#define sqlite3_reset(...) MIEBRDF_LATE(::miebrdf::materials::libsqlite(), sqlite3_reset)(__VA_ARGS__)
#define sqlite3_serialize(...) MIEBRDF_LATE(::miebrdf::materials::libsqlite(), sqlite3_serialize)(__VA_ARGS__)
#define sqlite3_step(...) MIEBRDF_LATE(::miebrdf::materials::libsqlite(), sqlite3_step)(__VA_ARGS__)
#define sqlite3_system_errno(...) MIEBRDF_LATE(::miebrdf::materials::libsqlite(), sqlite3_system_errno)(__VA_ARGS__)
// clang-format on
