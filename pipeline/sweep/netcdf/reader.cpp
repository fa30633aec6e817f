// Tables of sweeps, read piece by piece.
#include <fmt/format.h>

#include <miebrdf/error.h>
#include "pipeline/io/netcdf_file.h"
#include "pipeline/sweep/netcdf/netcdf_table.h"

namespace miebrdf::sweep {
namespace {

class NetcdfTable : public StoredTable {
  public:
    explicit NetcdfTable(const std::string& file) : file_(make_netcdf_file(file, "read")) {
        file_->open(file);
        for (int v = 0; v < file_->variables(); ++v) {
            // Results of a sweep are the variables that name ancillary ones.
            if (!file_->text(v, "ancillary_variables").empty() ||
                file_->name_of(v) == "error_estimate")
                variables_.push_back(file_->name_of(v));
        }
        if (variables_.empty())
            throw InputError(fmt::format("'{}' is not a table of miebrdf sweep", file));
    }

    std::vector<std::string> variables() const override { return variables_; }

    std::string unit_of(const std::string& variable) const override {
        return file_->text(file_->find(variable), "units");
    }

    std::vector<StoredAxis> axes_of(const std::string& variable) const override {
        std::vector<StoredAxis> axes;
        for (const int dimension : file_->dimensions_of(file_->find(variable)))
            axes.push_back(axis_of(file_->dimension(dimension)));
        return axes;
    }

    std::vector<double> read(const std::string& variable, const std::vector<std::size_t>& start,
                             const std::vector<std::size_t>& count) const override {
        return file_->numbers(file_->find(variable), start, count);
    }

  private:
    StoredAxis axis_of(const NetcdfFile::Dimension& dimension) const {
        StoredAxis axis{dimension.name};
        const int variable = file_->find(dimension.name);
        if (variable < 0) {
            for (std::size_t i = 0; i < dimension.size; ++i) axis.numbers.push_back(double(i));
            axis.is_sample = true;
            return axis;
        }
        if (file_->is_text(variable)) {
            axis.texts = file_->texts(variable, dimension.size);
        } else {
            axis.numbers = file_->numbers(variable, {0}, {dimension.size});
        }
        axis.unit = file_->text(variable, "units");
        axis.is_logarithmic = file_->text(variable, "spacing") == "logarithmic";
        return axis;
    }

    std::unique_ptr<NetcdfFile> file_;
    std::vector<std::string> variables_;
};

}  // namespace

std::string identity_of_netcdf(const std::string& file) {
    const auto handle = make_netcdf_file(file, "read");
    try {
        handle->open(file);
    } catch (const InputError&) {
        return {};
    }
    return handle->text(NetcdfFile::kGlobal, "sweep_identity");
}

std::unique_ptr<StoredTable> open_netcdf_table(const std::string& file) {
    return std::make_unique<NetcdfTable>(file);
}

}  // namespace miebrdf::sweep
