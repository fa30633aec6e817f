// Sweeps as NetCDF-4. The scenes come in the order of the file, so that memory holds no more than
// the pieces (NetCDF: chunks) that are being filled.
#include <fmt/format.h>
#include <fmt/ranges.h>
#include <netcdf.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <map>

#include "pipeline/io/atomic_file.h"
#include "pipeline/sweep/eradiate.h"
#include "pipeline/sweep/layout.h"
#include "pipeline/sweep/netcdf/handle.h"
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
        : sweep_(sweep), layout_(layout), atomic_(file), handle_(file, "write") {
        handle_.create(atomic_.temporary_path().string());
        define();
    }

    void add(std::size_t first_scene, const std::vector<SceneResult>& results) override {
        for (std::size_t i = 0; i < results.size(); ++i) put(first_scene + i, results[i]);
    }

    void finish() override {
        put_remarks();
        handle_.close();
        atomic_.commit();
    }

  private:
    int id() const { return handle_.id(); }

    void define() {
        put_origin();
        for (const Dimension& dimension : sweep_.dimensions) {
            const int at = define_dimension(dimension.name, dimension.size());
            scene_dimensions_.push_back(at);
            scene_shape_.push_back(dimension.size());
            for (const Axis& axis : dimension.axes) {
                define_axis(axis, at);
                if (!dimension.is_coordinate())
                    coordinates_ += (coordinates_.empty() ? "" : " ") + axis.name;
            }
        }
        for (const Axis* axis : asked_axes(sweep_)) {
            if (sweep_.for_eradiate && axis == &sweep_.wavelength && axis->size() == 1) {
                define_single(eradiate_axis(*axis));
                continue;
            }
            const Axis stored = sweep_.for_eradiate ? eradiate_axis(*axis) : *axis;
            asked_[axis] = define_dimension(stored.name, stored.size());
            define_axis(stored, asked_[axis]);
        }
        for (const Variable& variable : layout_.variables) define_variable(variable);
        error_estimate_ =
            define_values({"error_estimate",
                           "error estimate, relative to the largest value at its incidence", "1"});
        converged_ = define_array("converged", NC_BYTE, scene_dimensions_, scene_shape_);
        handle_.put_text(converged_, "long_name", "whether error_estimate <= the tolerance");
        const signed char flags[] = {0, 1};
        handle_.check(nc_put_att_schar(id(), converged_, "flag_values", NC_BYTE, 2, flags));
        handle_.put_text(converged_, "flag_meanings", "no yes");
        handle_.put_text(converged_, "coordinates", coordinates_);
        handle_.check(nc_enddef(id()));
    }

    void put_origin() {
        const Origin origin = origin_of(sweep_);
        handle_.put_text(NC_GLOBAL, "Conventions", "CF-1.8");
        handle_.put_text(NC_GLOBAL, "title", sweep_.title.empty() ? "miebrdf sweep" : sweep_.title);
        handle_.put_text(NC_GLOBAL, "source", origin.program);
        handle_.put_text(NC_GLOBAL, "references",
                         fmt::format("media of the first scene and of texts: {}",
                                     fmt::join(origin.sources, "; ")));
        handle_.put_text(NC_GLOBAL, "sweep_identity", origin.identity);
        handle_.put_text(NC_GLOBAL, "sweep_file", sweep_.text);
    }

    int define_dimension(const std::string& name, std::size_t size) {
        int dimension = -1;
        handle_.check(nc_def_dim(id(), name.c_str(), size, &dimension));
        return dimension;
    }

    void define_axis(const Axis& axis, int dimension) {
        int variable = -1;
        handle_.check(nc_def_var(id(), axis.name.c_str(), axis.is_text() ? NC_STRING : NC_DOUBLE, 1,
                                 &dimension, &variable));
        handle_.put_text(variable, "long_name", long_name_of(axis));
        if (!axis.is_text())
            handle_.put_text(variable, "units", axis.unit.empty() ? "1" : axis.unit);
        if (axis.name == "wavelength_nm" || (sweep_.for_eradiate && axis.name == "w"))
            handle_.put_text(variable, "standard_name", "radiation_wavelength");
        if (axis.is_logarithmic) handle_.put_text(variable, "spacing", "logarithmic");
        handle_.check(nc_enddef(id()));
        if (axis.is_text()) {
            handle_.put_strings(variable, axis.words);
        } else {
            handle_.check(nc_put_var_double(id(), variable, axis.numbers.data()));
        }
        handle_.check(nc_redef(id()));
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
        int variable = -1;
        handle_.check(nc_def_var(id(), axis.name.c_str(), NC_DOUBLE, 0, nullptr, &variable));
        handle_.put_text(variable, "long_name", long_name_of(axis));
        handle_.put_text(variable, "units", axis.unit);
        handle_.check(nc_enddef(id()));
        handle_.check(nc_put_var_double(id(), variable, axis.numbers.data()));
        handle_.check(nc_redef(id()));
        coordinates_ += (coordinates_.empty() ? "" : " ") + axis.name;
    }

    /// The axes of a variable behind those of the scenes, as they are stored.
    std::vector<const Axis*> stored_axes(const Variable& variable) const {
        if (!sweep_.for_eradiate || variable.axes.empty()) return variable.axes;
        std::vector<const Axis*> axes = {&sweep_.reflection, &sweep_.azimuth, &sweep_.incidence};
        if (sweep_.wavelength.size() > 1) axes.push_back(&sweep_.wavelength);
        return axes;
    }

    int define_array(const char* name, nc_type type, const std::vector<int>& dimensions,
                     const std::vector<std::size_t>& shape) {
        int variable = -1;
        handle_.check(
            nc_def_var(id(), name, type, int(dimensions.size()), dimensions.data(), &variable));
        if (shape.empty()) return variable;  // one value
        handle_.check(nc_def_var_chunking(id(), variable, NC_CHUNKED, piece_of(shape).data()));
        handle_.check(nc_def_var_deflate(id(), variable, 1, 1, kDeflateLevel));
        return variable;
    }

    int define_values(const Variable& variable) {
        std::vector<int> dimensions = scene_dimensions_;
        std::vector<std::size_t> shape = scene_shape_;
        for (const Axis* axis : stored_axes(variable)) {
            dimensions.push_back(asked_.at(axis));
            shape.push_back(axis->size());
        }
        const int defined = define_array(variable.name.c_str(), NC_DOUBLE, dimensions, shape);
        const double none = std::numeric_limits<double>::quiet_NaN();
        handle_.check(nc_put_att_double(id(), defined, "_FillValue", NC_DOUBLE, 1, &none));
        handle_.put_text(defined, "long_name", variable.long_name);
        handle_.put_text(defined, "units", variable.unit);
        handle_.put_text(defined, "coordinates", coordinates_);
        return defined;
    }

    void define_variable(const Variable& variable) {
        variables_.push_back(define_values(variable));
        handle_.put_text(variables_.back(), "ancillary_variables", "error_estimate converged");
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
            if (sweep_.for_eradiate) {
                ordered = in_eradiate_order(sweep_, values);
                values = ordered.data();
            }
            handle_.check(
                nc_put_vara_double(id(), variables_[v], start.data(), count.data(), values));
        }
        const signed char converged = result.converged;
        handle_.check(
            nc_put_var1_double(id(), error_estimate_, place.data(), &result.error_estimate));
        handle_.check(nc_put_var1_schar(id(), converged_, place.data(), &converged));
        if (result.remark.empty()) return;
        remark_scenes_.push_back((long long)(scene));
        remarks_.push_back(result.remark);
    }

    /// Known when all scenes are; most tables have none.
    void put_remarks() {
        if (remarks_.empty()) return;
        handle_.check(nc_redef(id()));
        const int dimension = define_dimension("remark", remarks_.size());
        int scene = -1, text = -1;
        handle_.check(nc_def_var(id(), "remark_scene", NC_INT64, 1, &dimension, &scene));
        handle_.put_text(scene, "long_name",
                         "number of the scene, from 0; its last dimension advances fastest");
        handle_.check(nc_def_var(id(), "remark", NC_STRING, 1, &dimension, &text));
        handle_.put_text(text, "long_name", "why the scene failed or did not converge");
        handle_.check(nc_enddef(id()));
        handle_.check(nc_put_var_longlong(id(), scene, remark_scenes_.data()));
        handle_.put_strings(text, remarks_);
    }

    const Sweep& sweep_;
    const Layout& layout_;
    AtomicFile atomic_;
    NetcdfHandle handle_;
    std::vector<int> scene_dimensions_, variables_;
    std::vector<std::size_t> scene_shape_;
    std::map<const Axis*, int> asked_;
    std::string coordinates_;  ///< of axes that share a dimension
    int error_estimate_ = -1, converged_ = -1;
    std::vector<long long> remark_scenes_;
    std::vector<std::string> remarks_;
};

}  // namespace

bool has_netcdf() { return libnetcdf().is_there(); }

std::unique_ptr<TableWriter> make_netcdf_writer(const Sweep& sweep, const Layout& layout,
                                                const std::string& file) {
    return std::make_unique<NetcdfWriter>(sweep, layout, file);
}

}  // namespace miebrdf::sweep
