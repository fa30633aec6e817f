#include "pipeline/sweep/netcdf/handle.h"

#include <fmt/format.h>
#include <miebrdf/error.h>

#include <filesystem>
#include <system_error>
#include <utility>

namespace miebrdf::sweep {
namespace {

/// HDF5 tells of every failure alike; less room than this is its likely cause.
constexpr std::uintmax_t kLeastRoom = 64 << 10;

std::string likely_cause(const std::string& file) {
    std::error_code unknown;
    const auto folder = std::filesystem::absolute(file, unknown).parent_path();
    const auto space = std::filesystem::space(folder, unknown);
    return !unknown && space.available < kLeastRoom ? ": the disk is full" : "";
}

/// After a write that failed, HDF5 tries once more when the process ends, and crashes there. Files
/// are closed here, so nothing is left for it to do. Only before its first use.
void let_hdf5_rest_at_exit() {
    static const herr_t done = H5dont_atexit();
    static_cast<void>(done);  // too late where somebody else uses HDF5: as before
}

}  // namespace

NetcdfHandle::~NetcdfHandle() {
    if (id_ >= 0) nc_close(id_);
}

void NetcdfHandle::create(const std::string& path) {
    let_hdf5_rest_at_exit();
    check(nc_create(path.c_str(), NC_NETCDF4 | NC_CLOBBER, &id_));
}

void NetcdfHandle::open(const std::string& path) { check(nc_open(path.c_str(), NC_NOWRITE, &id_)); }

void NetcdfHandle::close() { check(nc_close(std::exchange(id_, -1))); }

void NetcdfHandle::check(int status) const {
    if (status == NC_NOERR) return;
    throw InputError(fmt::format("cannot {} '{}': {}{}", what_, file_, nc_strerror(status),
                                 what_ == "write" ? likely_cause(file_) : ""));
}

void NetcdfHandle::put_text(int variable, const char* name, const std::string& text) const {
    if (!text.empty()) check(nc_put_att_text(id_, variable, name, text.size(), text.data()));
}

std::string NetcdfHandle::text(int variable, const char* name) const {
    std::size_t length = 0;
    nc_type type = NC_NAT;
    if (nc_inq_att(id_, variable, name, &type, &length) != NC_NOERR || type != NC_CHAR) return {};
    std::string text(length, '\0');
    check(nc_get_att_text(id_, variable, name, text.data()));
    return text;
}

void NetcdfHandle::put_strings(int variable, const std::vector<std::string>& texts) const {
    std::vector<const char*> pointers;
    for (const std::string& one : texts) pointers.push_back(one.c_str());
    if (!pointers.empty()) check(nc_put_var_string(id_, variable, pointers.data()));
}

}  // namespace miebrdf::sweep
