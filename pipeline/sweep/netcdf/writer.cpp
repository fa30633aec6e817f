// Sweeps as NetCDF-4. The scenes come in the order of the file, so that memory holds no more than
// the pieces (NetCDF: chunks) that are being filled.
#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <map>

#include "pipeline/io/atomic_file.h"
#include "pipeline/io/netcdf_file.h"
#include "pipeline/sweep/eradiate.h"
#include "pipeline/sweep/layout.h"
#include "pipeline/sweep/netcdf/netcdf_table.h"

namespace miebrdf::sweep {
namespace {

/// Values that are compressed together: 256 kB are few enough to read one spectrum of a large
/// table, enough to compress well.
constexpr std::size_t kPiece = 32768;
constexpr int kDeflateLevel = 4;

/// The innermost dimensions as far as they go into one piece.
std::vector<std::size_t> piece_of(const std::vector<std::size_t>& shape) {
    std::vector<std::size_t> piece(shape.size(), 1);
    std::size_t room = kPiece;
    for (std::size_t d = shape.size(); d-- > 0;) {
        piece[d] = std::min(shape[d], std::max<std::size_t>(room, 1));
        room /= shape[d];
    }
    return piece;
}

std::string long_name_of(const Axis& axis) {
    static const std::map<std::string, std::string> kNames = {
        {"wavelength_nm", "wavelength in vacuum"},
        {"mu_in", "cosine of the angle of incidence"},
        {"theta_in_deg", "angle of incidence from the normal"},
        {"mu_out", "cosine of the angle of reflection"},
        {"theta_out_deg", "angle of reflection from the normal"},
        {"w", "wavelength in vacuum"},
        {"cos_theta_i", "cosine of the angle of incidence"},
        {"cos_theta_o", "cosine of the angle of reflection"},
        {"phi_d", "azimuth of the outgoing minus that of the incoming direction"},
        {"azimuth_deg", "azimuth between incidence and reflection; 0: the mirror side"}};
    const auto found = kNames.find(axis.name);
    return found != kNames.end() ? found->second : axis.name;
}

class NetcdfWriter : public TableWriter {
  public:
    NetcdfWriter(const Sweep& sweep, const Layout& layout, const std::string& file)
        : sweep_(sweep), layout_(layout), atomic_(file), file_(make_netcdf_file(file, "write")) {
        file_->create(atomic_.temporary_path().string());
        define();
    }

    void add(std::size_t first_scene, const std::vector<SceneResult>& results) override {
        for (std::size_t i = 0; i < results.size(); ++i) put(first_scene + i, results[i]);
    }

    void finish() override {
        put_remarks();
        file_->close();
        atomic_.commit();
    }

  private:
    void define() {
        put_origin();
        for (const Dimension& dimension : sweep_.dimensions) {
            const int at = file_->define_dimension(dimension.name, dimension.size());
            scene_dimensions_.push_back(at);
            scene_shape_.push_back(dimension.size());
            for (const Axis& axis : dimension.axes) {
                define_axis(axis, at);
                if (!dimension.is_coordinate())
                    coordinates_ += (coordinates_.empty() ? "" : " ") + axis.name;
            }
        }
        for (const Axis* axis : asked_axes(sweep_)) {
            if (sweep_.for_eradiate() && axis == &sweep_.wavelength && axis->size() == 1) {
                define_single(eradiate_axis(*axis));
                continue;
            }
            const Axis stored = sweep_.for_eradiate() ? eradiate_axis(*axis) : *axis;
            asked_[axis] = file_->define_dimension(stored.name, stored.size());
            define_axis(stored, asked_[axis]);
        }
        for (const Variable& variable : layout_.variables) define_variable(variable);
        error_estimate_ =
            define_values({"error_estimate",
                           "error estimate, relative to the largest value at its incidence", "1"});
        converged_ =
            define_array("converged", NetcdfFile::Type::byte, scene_dimensions_, scene_shape_);
        file_->put_text(converged_, "long_name", "whether error_estimate <= the tolerance");
        file_->put_bytes(converged_, "flag_values", {0, 1});
        file_->put_text(converged_, "flag_meanings", "no yes");
        file_->put_text(converged_, "coordinates", coordinates_);
        file_->end_definitions();
    }

    void put_origin() {
        const Origin origin = origin_of(sweep_);
        file_->put_text(NetcdfFile::kGlobal, "Conventions", "CF-1.8");
        file_->put_text(NetcdfFile::kGlobal, "title",
                        sweep_.title.empty() ? "miebrdf sweep" : sweep_.title);
        file_->put_text(NetcdfFile::kGlobal, "source", origin.program);
        file_->put_text(NetcdfFile::kGlobal, "references",
                        fmt::format("media of the first scene and of texts: {}",
                                    fmt::join(origin.sources, "; ")));
        file_->put_text(NetcdfFile::kGlobal, "sweep_identity", origin.identity);
        file_->put_text(NetcdfFile::kGlobal, "sweep_file", sweep_.text);
    }

    void define_axis(const Axis& axis, int dimension) {
        using Type = NetcdfFile::Type;
        const int variable = file_->define_variable(
            axis.name, axis.is_text() ? Type::text : Type::number, {dimension});
        file_->put_text(variable, "long_name", long_name_of(axis));
        if (!axis.is_text())
            file_->put_text(variable, "units", axis.unit.empty() ? "1" : axis.unit);
        if (axis.name == "wavelength_nm" || (sweep_.for_eradiate() && axis.name == "w"))
            file_->put_text(variable, "standard_name", "radiation_wavelength");
        if (axis.is_logarithmic) file_->put_text(variable, "spacing", "logarithmic");
        file_->end_definitions();
        if (axis.is_text()) {
            file_->write(variable, axis.words);
        } else {
            file_->write(variable, axis.numbers);
        }
        file_->begin_definitions();
    }

    /// Names and units that Eradiate looks for.
    Axis eradiate_axis(const Axis& axis) const {
        if (&axis == &sweep_.wavelength) return renamed(axis, "w", "nm", axis.numbers);
        if (&axis == &sweep_.azimuth) return renamed(axis, "phi_d", "rad", eradiate_azimuths(axis));
        const char* name = &axis == &sweep_.incidence ? "cos_theta_i" : "cos_theta_o";
        return renamed(axis, name, "dimensionless", axis.numbers);
    }

    static Axis renamed(Axis axis, const char* name, const char* unit,
                        const std::vector<double>& numbers) {
        axis.name = name;
        axis.unit = unit;
        axis.numbers = numbers;
        return axis;
    }

    /// A coordinate without a dimension: Eradiate's check wants three, for one wavelength.
    void define_single(const Axis& axis) {
        const int variable = file_->define_variable(axis.name, NetcdfFile::Type::number, {});
        file_->put_text(variable, "long_name", long_name_of(axis));
        file_->put_text(variable, "units", axis.unit);
        file_->end_definitions();
        file_->write(variable, axis.numbers);
        file_->begin_definitions();
        coordinates_ += (coordinates_.empty() ? "" : " ") + axis.name;
    }

    /// The axes of a variable behind those of the scenes, as they are stored.
    std::vector<const Axis*> stored_axes(const Variable& variable) const {
        if (!sweep_.for_eradiate() || variable.axes.empty()) return variable.axes;
        std::vector<const Axis*> axes = {&sweep_.reflection, &sweep_.azimuth, &sweep_.incidence};
        if (sweep_.wavelength.size() > 1) axes.push_back(&sweep_.wavelength);
        return axes;
    }

    int define_array(const std::string& name, NetcdfFile::Type type,
                     const std::vector<int>& dimensions, const std::vector<std::size_t>& shape) {
        const int variable = file_->define_variable(name, type, dimensions);
        if (!shape.empty()) file_->compress(variable, piece_of(shape), kDeflateLevel);
        return variable;
    }

    int define_values(const Variable& variable) {
        std::vector<int> dimensions = scene_dimensions_;
        std::vector<std::size_t> shape = scene_shape_;
        for (const Axis* axis : stored_axes(variable)) {
            dimensions.push_back(asked_.at(axis));
            shape.push_back(axis->size());
        }
        const int defined =
            define_array(variable.name, NetcdfFile::Type::number, dimensions, shape);
        file_->put_number(defined, "_FillValue", std::numeric_limits<double>::quiet_NaN());
        file_->put_text(defined, "long_name", variable.long_name);
        file_->put_text(defined, "units", variable.unit);
        file_->put_text(defined, "coordinates", coordinates_);
        return defined;
    }

    void define_variable(const Variable& variable) {
        variables_.push_back(define_values(variable));
        file_->put_text(variables_.back(), "ancillary_variables", "error_estimate converged");
    }

    void put(std::size_t scene, const SceneResult& result) {
        const std::vector<std::size_t> place = place_of(sweep_, scene);
        for (std::size_t v = 0; v < variables_.size(); ++v) {
            const Variable& variable = layout_.variables[v];
            std::vector<std::size_t> start = place, count(place.size(), 1);
            for (const Axis* axis : stored_axes(variable)) {
                start.push_back(0);
                count.push_back(axis->size());
            }
            const double* values = result.values.data() + variable.offset;
            std::vector<double> ordered;
            if (sweep_.for_eradiate()) {
                ordered = in_eradiate_order(sweep_, values);
                values = ordered.data();
            }
            file_->write(variables_[v], start, count, values);
        }
        file_->write(error_estimate_, place, std::vector<std::size_t>(place.size(), 1),
                     &result.error_estimate);
        file_->write(converged_, place, static_cast<signed char>(result.converged));
        if (result.remark.empty()) return;
        remark_scenes_.push_back((long long)(scene));
        remarks_.push_back(result.remark);
    }

    /// Known when all scenes are; most tables have none.
    void put_remarks() {
        if (remarks_.empty()) return;
        file_->begin_definitions();
        const int dimension = file_->define_dimension("remark", remarks_.size());
        const int scene =
            file_->define_variable("remark_scene", NetcdfFile::Type::integer, {dimension});
        file_->put_text(scene, "long_name",
                        "number of the scene, from 0; its last dimension advances fastest");
        const int text = file_->define_variable("remark", NetcdfFile::Type::text, {dimension});
        file_->put_text(text, "long_name", "why the scene failed or did not converge");
        file_->end_definitions();
        file_->write(scene, remark_scenes_);
        file_->write(text, remarks_);
    }

    const Sweep& sweep_;
    const Layout& layout_;
    AtomicFile atomic_;
    std::unique_ptr<NetcdfFile> file_;
    std::vector<int> scene_dimensions_, variables_;
    std::vector<std::size_t> scene_shape_;
    std::map<const Axis*, int> asked_;
    std::string coordinates_;  ///< of axes that share a dimension
    int error_estimate_ = -1, converged_ = -1;
    std::vector<long long> remark_scenes_;
    std::vector<std::string> remarks_;
};

}  // namespace

std::unique_ptr<TableWriter> make_netcdf_writer(const Sweep& sweep, const Layout& layout,
                                                const std::string& file) {
    return std::make_unique<NetcdfWriter>(sweep, layout, file);
}

}  // namespace miebrdf::sweep
