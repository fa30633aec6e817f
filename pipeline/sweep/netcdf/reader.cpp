// Tables of sweeps, read piece by piece.
#include <fmt/format.h>
#include <miebrdf/error.h>
#include <netcdf.h>

#include <algorithm>
#include <array>
#include <functional>
#include <numeric>
#include <set>

#include "pipeline/sweep/netcdf/handle.h"
#include "pipeline/sweep/netcdf/netcdf_table.h"

namespace miebrdf::sweep {
namespace {

class NetcdfTable : public StoredTable {
  public:
    explicit NetcdfTable(const std::string& file) : file_(file), handle_(file, "read") {
        handle_.open(file);
        int count = 0;
        handle_.check(nc_inq_nvars(handle_.id(), &count));
        for (int v = 0; v < count; ++v) {
            // What a sweep writes as a result says which variables belong to it.
            if (!handle_.text(v, "ancillary_variables").empty() ||
                name_of_variable(v) == "error_estimate")
                variables_.push_back(name_of_variable(v));
        }
        if (variables_.empty())
            throw InputError(fmt::format("'{}' is no table of miebrdf sweep", file));
    }

    std::vector<std::string> variables() const override { return variables_; }

    std::string unit_of(const std::string& variable) const override {
        return handle_.text(number_of(variable), "units");
    }

    std::vector<StoredAxis> axes_of(const std::string& variable) const override {
        std::vector<StoredAxis> axes;
        for (const int dimension : dimensions_of(number_of(variable)))
            axes.push_back(axis_of_dimension(dimension));
        return axes;
    }

    std::vector<double> read(const std::string& variable, const std::vector<std::size_t>& start,
                             const std::vector<std::size_t>& count) const override {
        std::vector<double> values(
            std::accumulate(count.begin(), count.end(), std::size_t{1}, std::multiplies<>()));
        handle_.check(nc_get_vara_double(handle_.id(), number_of(variable), start.data(),
                                         count.data(), values.data()));
        return values;
    }

  private:
    std::string name_of_variable(int variable) const {
        std::array<char, NC_MAX_NAME + 1> name{};
        handle_.check(nc_inq_varname(handle_.id(), variable, name.data()));
        return name.data();
    }

    int number_of(const std::string& variable) const {
        int number = -1;
        handle_.check(nc_inq_varid(handle_.id(), variable.c_str(), &number));
        return number;
    }

    std::vector<int> dimensions_of(int variable) const {
        int count = 0;
        handle_.check(nc_inq_varndims(handle_.id(), variable, &count));
        std::vector<int> dimensions(static_cast<std::size_t>(count));
        handle_.check(nc_inq_vardimid(handle_.id(), variable, dimensions.data()));
        return dimensions;
    }

    StoredAxis axis_of_dimension(int dimension) const {
        std::array<char, NC_MAX_NAME + 1> name{};
        std::size_t size = 0;
        handle_.check(nc_inq_dim(handle_.id(), dimension, name.data(), &size));
        StoredAxis axis{name.data()};
        int variable = -1;
        if (nc_inq_varid(handle_.id(), name.data(), &variable) != NC_NOERR) {
            for (std::size_t i = 0; i < size; ++i) axis.numbers.push_back(double(i));
            axis.is_sample = true;
            return axis;
        }
        nc_type type = NC_NAT;
        handle_.check(nc_inq_vartype(handle_.id(), variable, &type));
        if (type == NC_STRING) {
            axis.texts = strings_of(variable, size);
        } else {
            axis.numbers.resize(size);
            handle_.check(nc_get_var_double(handle_.id(), variable, axis.numbers.data()));
        }
        axis.unit = handle_.text(variable, "units");
        axis.is_logarithmic = handle_.text(variable, "spacing") == "logarithmic";
        return axis;
    }

    std::vector<std::string> strings_of(int variable, std::size_t size) const {
        std::vector<char*> pointers(size, nullptr);
        handle_.check(nc_get_var_string(handle_.id(), variable, pointers.data()));
        std::vector<std::string> texts;
        for (const char* text : pointers) texts.emplace_back(text == nullptr ? "" : text);
        nc_free_string(size, pointers.data());
        return texts;
    }

    std::string file_;
    NetcdfHandle handle_;
    std::vector<std::string> variables_;
};

}  // namespace

std::string identity_of_netcdf(const std::string& file) {
    NetcdfHandle handle(file, "read");
    try {
        handle.open(file);
    } catch (const InputError&) {
        return {};
    }
    return handle.text(NC_GLOBAL, "sweep_identity");
}

std::unique_ptr<StoredTable> open_netcdf_table(const std::string& file) {
    return std::make_unique<NetcdfTable>(file);
}

}  // namespace miebrdf::sweep
