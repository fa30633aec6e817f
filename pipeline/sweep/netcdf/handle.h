// libnetcdf's C interface with errors as exceptions.
#pragma once

#include <string>
#include <vector>

#include "pipeline/sweep/netcdf/late_netcdf.h"

namespace miebrdf::sweep {

/// An open file; closed by the destructor.
class NetcdfHandle {
  public:
    /// @param what  of messages: "write" or "read"
    NetcdfHandle(std::string file, std::string what) : file_(std::move(file)), what_(what) {}
    ~NetcdfHandle();
    NetcdfHandle(const NetcdfHandle&) = delete;
    NetcdfHandle& operator=(const NetcdfHandle&) = delete;

    void create(const std::string& path);
    void open(const std::string& path);
    void close();
    int id() const { return id_; }

    /// @throws InputError  for a status that is not NC_NOERR
    void check(int status) const;

    void put_text(int variable, const char* name, const std::string& text) const;
    /// Empty if there is none.
    std::string text(int variable, const char* name) const;
    void put_strings(int variable, const std::vector<std::string>& texts) const;

  private:
    std::string file_;  ///< in messages
    std::string what_;
    int id_ = -1;
};

}  // namespace miebrdf::sweep
