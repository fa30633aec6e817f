// The table of snow that CRTM interpolates in the visible and near infrared.
#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>

#include "pipeline/io/atomic_file.h"
#include "pipeline/io/netcdf_file.h"
#include "pipeline/sweep/netcdf/netcdf_table.h"
#include "pipeline/sweep/satellite.h"

namespace miebrdf::sweep {
namespace {

class CrtmWriter : public GatheredTable {
  public:
    CrtmWriter(const Sweep& sweep, const Layout& layout, const std::string& file)
        : GatheredTable(sweep, layout), atomic_(file), file_(make_netcdf_file(file, "write")) {
        file_->create(atomic_.temporary_path().string());
    }

    void finish() override {
        constexpr int kGlobal = NetcdfFile::kGlobal;
        const Origin origin = origin_of(sweep_);
        file_->put_number(kGlobal, "Release", 1);
        file_->put_number(kGlobal, "Version", 1);
        file_->put_text(kGlobal, "Classification_Name", "SNICAR");  // CRTM's name of the layout
        file_->put_text(kGlobal, "Title", sweep_.title.empty() ? "miebrdf sweep" : sweep_.title);
        file_->put_text(kGlobal, "History", origin.program);
        file_->put_text(kGlobal, "Comment",
                        fmt::format("plane albedo of direct light; media of the first scene: {}",
                                    fmt::join(origin.sources, "; ")));
        file_->put_text(kGlobal, "sweep_identity", origin.identity);
        file_->put_text(kGlobal, "sweep_file", sweep_.text);

        std::vector<double> wavenumbers;  // ascending, as the wavelengths are from behind
        for (const double nm : sweep_.wavelength.numbers)
            wavenumbers.insert(wavenumbers.begin(), 1e7 / nm);
        const Axis &radius = *sweep_.find_axis("radius_um"), &depth = *sweep_.find_axis("depth_m"),
                   &density = *sweep_.find_axis("density_kg_m3");
        define("n_Densities", "Density", "kg/m^3", density.numbers);
        define("n_Depths", "Depth", "meters", depth.numbers);
        define("n_Grain_Sizes", "Grain_Size", "effective radius in microns (um)", radius.numbers);
        define("n_Frequencies", "Frequency", "inverse centimeters (cm^-1)", wavenumbers);
        define("n_Angles", "Angle", "degrees from vertical", sweep_.incidence.numbers);

        std::vector<double> values =
            over({&density, &depth, &radius, &sweep_.wavelength, &sweep_.incidence});
        const auto angles = std::ptrdiff_t(sweep_.incidence.size()),
                   spectrum = std::ptrdiff_t(sweep_.wavelength.size()) * angles;
        for (auto at = values.begin(); at != values.end(); at += spectrum) {
            // The wavelengths from behind: all of it, then each row of angles again.
            std::reverse(at, at + spectrum);
            for (auto row = at; row != at + spectrum; row += angles)
                std::reverse(row, row + angles);
        }
        const int reflectance =
            file_->define_variable("Reflectance", NetcdfFile::Type::number, dimensions_);
        file_->put_text(reflectance, "long_name", "Reflectance");
        file_->put_text(reflectance, "units", "N/A");
        file_->put_number(reflectance, "_FillValue", -999.0);
        file_->end_definitions();
        file_->write(reflectance, values);
        file_->close();
        atomic_.commit();
    }

  private:
    void define(const char* dimension, const char* name, const char* unit,
                const std::vector<double>& values) {
        dimensions_.push_back(file_->define_dimension(dimension, values.size()));
        const int variable =
            file_->define_variable(name, NetcdfFile::Type::number, {dimensions_.back()});
        file_->put_text(variable, "long_name", name);
        file_->put_text(variable, "units", unit);
        file_->end_definitions();
        file_->write(variable, values);
        file_->begin_definitions();
    }

    AtomicFile atomic_;
    std::unique_ptr<NetcdfFile> file_;
    std::vector<int> dimensions_;
};

}  // namespace

std::unique_ptr<TableWriter> make_crtm_writer(const Sweep& sweep, const Layout& layout,
                                              const std::string& file) {
    return std::make_unique<CrtmWriter>(sweep, layout, file);
}

}  // namespace miebrdf::sweep
