// The plug-in netcdf: NetcdfFile by libnetcdf's interface for C.
#include <H5public.h>
#include <fmt/format.h>
#include <netcdf.h>

#include <array>
#include <filesystem>
#include <functional>
#include <numeric>
#include <system_error>
#include <utility>

#include <miebrdf/error.h>
#include "pipeline/io/netcdf_file.h"

namespace miebrdf {
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

class LibraryFile : public NetcdfFile {
  public:
    LibraryFile(std::string file, std::string what)
        : file_(std::move(file)), what_(std::move(what)) {}
    ~LibraryFile() override {
        if (id_ >= 0) nc_close(id_);
    }
    LibraryFile(const LibraryFile&) = delete;
    LibraryFile& operator=(const LibraryFile&) = delete;

    void create(const std::string& path) override {
        let_hdf5_rest_at_exit();
        check(nc_create(path.c_str(), NC_NETCDF4 | NC_CLOBBER, &id_));
    }
    void open(const std::string& path) override { check(nc_open(path.c_str(), NC_NOWRITE, &id_)); }
    void close() override { check(nc_close(std::exchange(id_, -1))); }

    void begin_definitions() override { check(nc_redef(id_)); }
    void end_definitions() override { check(nc_enddef(id_)); }

    int define_dimension(const std::string& name, std::size_t size) override {
        int dimension = -1;
        check(nc_def_dim(id_, name.c_str(), size, &dimension));
        return dimension;
    }
    int define_variable(const std::string& name, Type type,
                        const std::vector<int>& dimensions) override {
        static constexpr nc_type kTypes[] = {NC_DOUBLE, NC_BYTE, NC_INT64, NC_STRING};
        int variable = -1;
        check(nc_def_var(id_, name.c_str(), kTypes[int(type)], int(dimensions.size()),
                         dimensions.data(), &variable));
        return variable;
    }
    void compress(int variable, const Places& piece, int level) override {
        check(nc_def_var_chunking(id_, variable, NC_CHUNKED, piece.data()));
        check(nc_def_var_deflate(id_, variable, 1, 1, level));
    }
    void put_text(int variable, const char* name, const std::string& text) override {
        if (!text.empty()) check(nc_put_att_text(id_, variable, name, text.size(), text.data()));
    }
    void put_number(int variable, const char* name, double value) override {
        check(nc_put_att_double(id_, variable, name, NC_DOUBLE, 1, &value));
    }
    void put_bytes(int variable, const char* name, const std::vector<signed char>& bytes) override {
        check(nc_put_att_schar(id_, variable, name, NC_BYTE, bytes.size(), bytes.data()));
    }

    void write(int variable, const std::vector<double>& values) override {
        check(nc_put_var_double(id_, variable, values.data()));
    }
    void write(int variable, const std::vector<long long>& values) override {
        check(nc_put_var_longlong(id_, variable, values.data()));
    }
    void write(int variable, const std::vector<std::string>& texts) override {
        std::vector<const char*> pointers;
        for (const std::string& one : texts) pointers.push_back(one.c_str());
        if (!pointers.empty()) check(nc_put_var_string(id_, variable, pointers.data()));
    }
    void write(int variable, const Places& start, const Places& count,
               const double* values) override {
        check(nc_put_vara_double(id_, variable, start.data(), count.data(), values));
    }
    void write(int variable, const Places& at, signed char value) override {
        check(nc_put_var1_schar(id_, variable, at.data(), &value));
    }

    int variables() const override {
        int count = 0;
        check(nc_inq_nvars(id_, &count));
        return count;
    }
    std::string name_of(int variable) const override {
        std::array<char, NC_MAX_NAME + 1> name{};
        check(nc_inq_varname(id_, variable, name.data()));
        return name.data();
    }
    int find(const std::string& variable) const override {
        int number = -1;
        return nc_inq_varid(id_, variable.c_str(), &number) == NC_NOERR ? number : -1;
    }
    std::vector<int> dimensions_of(int variable) const override {
        int count = 0;
        check(nc_inq_varndims(id_, variable, &count));
        std::vector<int> dimensions(static_cast<std::size_t>(count));
        check(nc_inq_vardimid(id_, variable, dimensions.data()));
        return dimensions;
    }
    Dimension dimension(int dimension) const override {
        std::array<char, NC_MAX_NAME + 1> name{};
        std::size_t size = 0;
        check(nc_inq_dim(id_, dimension, name.data(), &size));
        return {name.data(), size};
    }
    bool is_text(int variable) const override {
        nc_type type = NC_NAT;
        check(nc_inq_vartype(id_, variable, &type));
        return type == NC_STRING;
    }
    std::string text(int variable, const char* name) const override {
        std::size_t length = 0;
        nc_type type = NC_NAT;
        if (nc_inq_att(id_, variable, name, &type, &length) != NC_NOERR || type != NC_CHAR)
            return {};
        std::string text(length, '\0');
        check(nc_get_att_text(id_, variable, name, text.data()));
        return text;
    }
    std::vector<double> numbers(int variable, const Places& start,
                                const Places& count) const override {
        std::vector<double> values(
            std::accumulate(count.begin(), count.end(), std::size_t{1}, std::multiplies<>()));
        check(nc_get_vara_double(id_, variable, start.data(), count.data(), values.data()));
        return values;
    }
    std::vector<std::string> texts(int variable, std::size_t size) const override {
        std::vector<char*> pointers(size, nullptr);
        check(nc_get_var_string(id_, variable, pointers.data()));
        std::vector<std::string> texts;
        for (const char* text : pointers) texts.emplace_back(text == nullptr ? "" : text);
        nc_free_string(size, pointers.data());
        return texts;
    }

  private:
    void check(int status) const {
        if (status == NC_NOERR) return;
        throw InputError(fmt::format("cannot {} '{}': {}{}", what_, file_, nc_strerror(status),
                                     what_ == "write" ? likely_cause(file_) : ""));
    }

    std::string file_, what_;
    int id_ = -1;
};

}  // namespace
}  // namespace miebrdf

extern "C" __attribute__((visibility("default"))) miebrdf::NetcdfFile* miebrdf_netcdf_file(
    const std::string& file, const std::string& what) {
    return new miebrdf::LibraryFile(file, what);
}
