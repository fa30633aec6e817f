// libnetcdf's functions, and one of HDF5's below it, loaded when they are called first
// (materials/libraries/late_library.h). libnetcdf brings 40 libraries, most of them to read over
// networks.
#pragma once

#include <H5public.h>
#include <netcdf.h>

#include "materials/libraries/late_library.h"

namespace miebrdf::sweep {

inline const LateLibrary& libnetcdf() {
    static const LateLibrary library(MIEBRDF_LATE_NETCDF);
    return library;
}

}  // namespace miebrdf::sweep

// clang-format off
#define H5dont_atexit(...) MIEBRDF_LATE(::miebrdf::sweep::libnetcdf(), H5dont_atexit)(__VA_ARGS__)
#define nc_close(...) MIEBRDF_LATE(::miebrdf::sweep::libnetcdf(), nc_close)(__VA_ARGS__)
#define nc_create(...) MIEBRDF_LATE(::miebrdf::sweep::libnetcdf(), nc_create)(__VA_ARGS__)
#define nc_def_dim(...) MIEBRDF_LATE(::miebrdf::sweep::libnetcdf(), nc_def_dim)(__VA_ARGS__)
#define nc_def_var(...) MIEBRDF_LATE(::miebrdf::sweep::libnetcdf(), nc_def_var)(__VA_ARGS__)
#define nc_def_var_chunking(...) MIEBRDF_LATE(::miebrdf::sweep::libnetcdf(), nc_def_var_chunking)(__VA_ARGS__)
#define nc_def_var_deflate(...) MIEBRDF_LATE(::miebrdf::sweep::libnetcdf(), nc_def_var_deflate)(__VA_ARGS__)
#define nc_enddef(...) MIEBRDF_LATE(::miebrdf::sweep::libnetcdf(), nc_enddef)(__VA_ARGS__)
#define nc_free_string(...) MIEBRDF_LATE(::miebrdf::sweep::libnetcdf(), nc_free_string)(__VA_ARGS__)
#define nc_get_att_text(...) MIEBRDF_LATE(::miebrdf::sweep::libnetcdf(), nc_get_att_text)(__VA_ARGS__)
#define nc_get_var_double(...) MIEBRDF_LATE(::miebrdf::sweep::libnetcdf(), nc_get_var_double)(__VA_ARGS__)
#define nc_get_var_string(...) MIEBRDF_LATE(::miebrdf::sweep::libnetcdf(), nc_get_var_string)(__VA_ARGS__)
#define nc_get_vara_double(...) MIEBRDF_LATE(::miebrdf::sweep::libnetcdf(), nc_get_vara_double)(__VA_ARGS__)
#define nc_inq_att(...) MIEBRDF_LATE(::miebrdf::sweep::libnetcdf(), nc_inq_att)(__VA_ARGS__)
#define nc_inq_dim(...) MIEBRDF_LATE(::miebrdf::sweep::libnetcdf(), nc_inq_dim)(__VA_ARGS__)
#define nc_inq_nvars(...) MIEBRDF_LATE(::miebrdf::sweep::libnetcdf(), nc_inq_nvars)(__VA_ARGS__)
#define nc_inq_vardimid(...) MIEBRDF_LATE(::miebrdf::sweep::libnetcdf(), nc_inq_vardimid)(__VA_ARGS__)
#define nc_inq_varid(...) MIEBRDF_LATE(::miebrdf::sweep::libnetcdf(), nc_inq_varid)(__VA_ARGS__)
#define nc_inq_varname(...) MIEBRDF_LATE(::miebrdf::sweep::libnetcdf(), nc_inq_varname)(__VA_ARGS__)
#define nc_inq_varndims(...) MIEBRDF_LATE(::miebrdf::sweep::libnetcdf(), nc_inq_varndims)(__VA_ARGS__)
#define nc_inq_vartype(...) MIEBRDF_LATE(::miebrdf::sweep::libnetcdf(), nc_inq_vartype)(__VA_ARGS__)
#define nc_open(...) MIEBRDF_LATE(::miebrdf::sweep::libnetcdf(), nc_open)(__VA_ARGS__)
#define nc_put_att_double(...) MIEBRDF_LATE(::miebrdf::sweep::libnetcdf(), nc_put_att_double)(__VA_ARGS__)
#define nc_put_att_schar(...) MIEBRDF_LATE(::miebrdf::sweep::libnetcdf(), nc_put_att_schar)(__VA_ARGS__)
#define nc_put_att_text(...) MIEBRDF_LATE(::miebrdf::sweep::libnetcdf(), nc_put_att_text)(__VA_ARGS__)
#define nc_put_var1_double(...) MIEBRDF_LATE(::miebrdf::sweep::libnetcdf(), nc_put_var1_double)(__VA_ARGS__)
#define nc_put_var1_schar(...) MIEBRDF_LATE(::miebrdf::sweep::libnetcdf(), nc_put_var1_schar)(__VA_ARGS__)
#define nc_put_var_double(...) MIEBRDF_LATE(::miebrdf::sweep::libnetcdf(), nc_put_var_double)(__VA_ARGS__)
#define nc_put_var_longlong(...) MIEBRDF_LATE(::miebrdf::sweep::libnetcdf(), nc_put_var_longlong)(__VA_ARGS__)
#define nc_put_var_string(...) MIEBRDF_LATE(::miebrdf::sweep::libnetcdf(), nc_put_var_string)(__VA_ARGS__)
#define nc_put_vara_double(...) MIEBRDF_LATE(::miebrdf::sweep::libnetcdf(), nc_put_vara_double)(__VA_ARGS__)
#define nc_redef(...) MIEBRDF_LATE(::miebrdf::sweep::libnetcdf(), nc_redef)(__VA_ARGS__)
#define nc_strerror(...) MIEBRDF_LATE(::miebrdf::sweep::libnetcdf(), nc_strerror)(__VA_ARGS__)
// clang-format on
