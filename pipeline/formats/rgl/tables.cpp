#include "pipeline/formats/rgl/tables.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>

#include <miebrdf/brdf_source.h>
#include "pipeline/formats/common/tensor_reader.h"

namespace miebrdf {
namespace {

std::vector<float> all_of(const RealView<float>& numbers) {
    std::vector<float> list(numbers.size());
    for (std::size_t i = 0; i < list.size(); ++i) list[i] = numbers[i];
    return list;
}

RglSlices slices(const TensorFields& fields, const std::string& name, std::size_t dimensions,
                 std::size_t count) {
    const Tensor& field = tensor(fields, name, dimensions);
    RglSlices result;
    result.ny = field.shape[dimensions - 2];
    result.nx = field.shape[dimensions - 1];
    result.values = tensor_floats(fields, name);
    if (result.nx < 2 || result.ny < 2 || result.values.size() / result.nx / result.ny != count) {
        throw InputError(fmt::format(
            "rgl: field '{}' has {} tables of {} x {}; expected {} of at "
            "least 2 x 2",
            name, result.values.size() / std::max<std::size_t>(1, result.nx * result.ny), result.nx,
            result.ny, count));
    }
    for (std::size_t i = 0; i < result.values.size(); ++i) {
        if (!std::isfinite(result.values[i]))
            throw InputError(fmt::format("rgl: field '{}' is not finite", name));
    }
    return result;
}

std::vector<float> incident_angles(const TensorFields& fields) {
    std::vector<float> theta = all_of(tensor_floats(fields, "theta_i"));
    if (theta.empty()) throw InputError("rgl: no incident angles");
    for (std::size_t t = 0; t < theta.size(); ++t) {
        if (!(theta[t] >= (t == 0 ? 0.0f : theta[t - 1]) && theta[t] < 1.6f)) {
            throw InputError("rgl: theta_i is not ascending in [0, pi/2]");
        }
    }
    return theta;
}

void read_channels(const TensorFields& fields, RglTables& tables) {
    if (!fields.contains("wavelengths")) {
        if (tensor(fields, "rgb", 5).shape[2] != 3)
            throw InputError("rgl: 'rgb' has not 3 channels");
        tables.channels = {"R", "G", "B"};
        return;
    }
    const std::vector<float> wavelengths = all_of(tensor_floats(fields, "wavelengths"));
    tables.wavelength_nm.assign(wavelengths.begin(), wavelengths.end());
    tables.channels = channel_names(tables.wavelength_nm);
    if (tables.channels.empty()) throw InputError("rgl: no wavelengths");
}

}  // namespace

RglTables read_rgl_tables(std::string_view content) {
    const TensorFields fields = read_tensor_file(content);
    if (tensor(fields, "phi_i", 1).shape[0] > 2) {
        throw InputError("rgl: the material is anisotropic; only isotropic ones are read here");
    }
    RglTables tables;
    tables.theta = incident_angles(fields);
    const std::size_t angles = tables.theta.size();
    tables.ndf = slices(fields, "ndf", 2, 1);
    tables.sigma = slices(fields, "sigma", 2, 1);
    tables.vndf = slices(fields, "vndf", 4, angles);
    tables.luminance = slices(fields, "luminance", 4, angles);
    read_channels(fields, tables);
    const bool spectral = !tables.wavelength_nm.empty();
    tables.spectra =
        slices(fields, spectral ? "spectra" : "rgb", 5, angles * tables.channels.size());
    const Tensor& jacobian = tensor(fields, "jacobian", 1);
    tables.jacobian = !jacobian.bytes.empty() && jacobian.bytes[0] != 0;
    return tables;
}

namespace {

/// t with integral_0^t of (a + (b - a) s) ds = area, in the form without cancellation.
double invert_linear(double a, double b, double area) {
    const double discriminant = std::sqrt(std::max(a * a + 2.0 * (b - a) * area, 0.0));
    const double divisor = a + discriminant;
    return divisor > 0.0 ? std::clamp(2.0 * area / divisor, 0.0, 1.0) : 0.5;
}

std::size_t last_not_above(const double* first, std::size_t count, double value) {
    const auto above = std::upper_bound(first, first + count, value) - first;
    return std::min<std::size_t>(count - 2, above > 0 ? static_cast<std::size_t>(above) - 1 : 0);
}

}  // namespace

BilinearWarp::BilinearWarp(std::vector<double> values, std::size_t nx, std::size_t ny)
    : values_(std::move(values)),
      nx_(nx),
      ny_(ny),
      row_integral_(nx * ny, 0.0),
      integral_(ny, 0.0) {
    for (std::size_t y = 0; y < ny_; ++y) {
        double* row = &row_integral_[y * nx_];
        for (std::size_t x = 1; x < nx_; ++x) row[x] = row[x - 1] + (at(x - 1, y) + at(x, y)) / 2;
        if (y > 0) integral_[y] = integral_[y - 1] + (row[nx_ - 1] + row[-1]) / 2;
    }
    const double total = integral_.back();
    if (!(total > std::numeric_limits<double>::min())) return;
    for (auto* list : {&values_, &row_integral_, &integral_}) {
        for (double& value : *list) value /= total;
    }
}

BilinearWarp::Cell BilinearWarp::locate(Point2 point) const {
    const double x = std::clamp(point.x, 0.0, 1.0) * static_cast<double>(nx_ - 1);
    const double y = std::clamp(point.y, 0.0, 1.0) * static_cast<double>(ny_ - 1);
    const std::size_t column = std::min(nx_ - 2, static_cast<std::size_t>(x));
    const std::size_t row = std::min(ny_ - 2, static_cast<std::size_t>(y));
    return {column, row, x - static_cast<double>(column), y - static_cast<double>(row)};
}

Point2 BilinearWarp::sample(Point2 uniform) const {
    const std::size_t row = last_not_above(integral_.data(), ny_, uniform.y);
    const double* below = &row_integral_[row * nx_];
    const double* above = below + nx_;
    const double y = invert_linear(below[nx_ - 1], above[nx_ - 1], uniform.y - integral_[row]);
    const double target = uniform.x * ((1 - y) * below[nx_ - 1] + y * above[nx_ - 1]);
    std::vector<double> line(nx_);
    for (std::size_t x = 0; x < nx_; ++x) line[x] = (1 - y) * below[x] + y * above[x];
    const std::size_t column = last_not_above(line.data(), nx_, target);
    const double left = (1 - y) * at(column, row) + y * at(column, row + 1);
    const double right = (1 - y) * at(column + 1, row) + y * at(column + 1, row + 1);
    const double x = invert_linear(left, right, target - line[column]);
    return {(static_cast<double>(column) + x) / static_cast<double>(nx_ - 1),
            (static_cast<double>(row) + y) / static_cast<double>(ny_ - 1)};
}

Point2 BilinearWarp::invert(Point2 point) const {
    const Cell cell = locate(point);
    const double* below = &row_integral_[cell.row * nx_];
    const double* above = below + nx_;
    const double total_below = below[nx_ - 1], total_above = above[nx_ - 1];
    const double left =
        (1 - cell.y) * at(cell.column, cell.row) + cell.y * at(cell.column, cell.row + 1);
    const double right =
        (1 - cell.y) * at(cell.column + 1, cell.row) + cell.y * at(cell.column + 1, cell.row + 1);
    const double before = (1 - cell.y) * below[cell.column] + cell.y * above[cell.column];
    const double total = (1 - cell.y) * total_below + cell.y * total_above;
    const double x = before + cell.x * (left + cell.x / 2 * (right - left));
    const double y =
        integral_[cell.row] + cell.y * (total_below + cell.y / 2 * (total_above - total_below));
    return {total > 0 ? x / total : cell.x, y};
}

double BilinearWarp::density(Point2 point) const {
    const Cell cell = locate(point);
    const double below =
        (1 - cell.x) * at(cell.column, cell.row) + cell.x * at(cell.column + 1, cell.row);
    const double above =
        (1 - cell.x) * at(cell.column, cell.row + 1) + cell.x * at(cell.column + 1, cell.row + 1);
    const double cells = static_cast<double>(nx_ - 1) * static_cast<double>(ny_ - 1);
    return ((1 - cell.y) * below + cell.y * above) * cells;
}

}  // namespace miebrdf
