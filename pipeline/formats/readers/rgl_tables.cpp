#include "pipeline/formats/readers/rgl_tables.h"

#include <fmt/format.h>

#include <cmath>
#include <map>

#include <miebrdf/error.h>
#include "pipeline/formats/readers/brdf_file.h"

namespace miebrdf::exports {
namespace {

using Fields = std::map<std::string, Tensor>;

std::vector<float> all_of(const RealView<float>& numbers) {
    std::vector<float> list(numbers.size());
    for (std::size_t i = 0; i < list.size(); ++i) list[i] = numbers[i];
    return list;
}

RglSlices slices(const Fields& fields, const std::string& name, std::size_t dimensions,
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

std::vector<float> incident_angles(const Fields& fields) {
    std::vector<float> theta = all_of(tensor_floats(fields, "theta_i"));
    if (theta.empty()) throw InputError("rgl: no incident angles");
    for (std::size_t t = 0; t < theta.size(); ++t) {
        if (!(theta[t] >= (t == 0 ? 0.0f : theta[t - 1]) && theta[t] < 1.6f)) {
            throw InputError("rgl: theta_i is not ascending in [0, pi/2]");
        }
    }
    return theta;
}

void read_channels(const Fields& fields, RglTables& tables) {
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
    const Fields fields = read_tensor_file(content);
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

}  // namespace miebrdf::exports
