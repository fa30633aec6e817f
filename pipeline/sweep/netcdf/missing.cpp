// In place of all others here where libnetcdf was not found.
#include <miebrdf/error.h>

#include "pipeline/sweep/netcdf/netcdf_table.h"

namespace miebrdf::sweep {
namespace {

[[noreturn]] void refuse_netcdf() {
    throw UsageError(
        "this build cannot read or write NetCDF; install libnetcdf-dev, then configure and build "
        "again, or write a .csv");
}

}  // namespace

bool has_netcdf() { return false; }

std::unique_ptr<TableWriter> make_netcdf_writer(const Sweep&, const Layout&, const std::string&) {
    refuse_netcdf();
}
std::string identity_of_netcdf(const std::string&) { return {}; }
std::unique_ptr<StoredTable> open_netcdf_table(const std::string&) { refuse_netcdf(); }

}  // namespace miebrdf::sweep
