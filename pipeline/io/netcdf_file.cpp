#include "pipeline/io/netcdf_file.h"

#include "pipeline/io/plugin.h"

namespace miebrdf {

bool has_netcdf() { return has_plugin("netcdf"); }

std::unique_ptr<NetcdfFile> make_netcdf_file(const std::string& file, const std::string& what) {
    static const auto make = plugin_function<NetcdfFile*(const std::string&, const std::string&)>(
        "netcdf", "miebrdf_netcdf_file", "libnetcdf-dev");
    return std::unique_ptr<NetcdfFile>(make(file, what));
}

}  // namespace miebrdf
