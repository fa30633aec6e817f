// ISOFIT's surfaces as MAT-files of level 5 (MathWorks, "MAT-File Format", chapter 1): elements of
// a type, a size and data, in the byte order that the header says; matrices lie column after
// column.
#include <fmt/format.h>
#include <fmt/ranges.h>
#include <miebrdf/error.h>

#include <Eigen/Core>

#include <algorithm>
#include <cstdint>

#include "pipeline/io/atomic_file.h"
#include "pipeline/sweep/satellite.h"

namespace miebrdf::sweep {
namespace {

constexpr std::size_t kDescription = 116;  ///< bytes of text at the beginning
constexpr char kIdentity[] = ", sweep ";
/// Sizes of elements are 32-bit numbers, and readers take them as signed.
constexpr std::size_t kMostBytes = 0x7fffffff;

enum Type : std::uint32_t { int8 = 1, uint16 = 4, int32 = 5, uint32 = 6, float64 = 9, matrix = 14 };
enum Kind : std::uint32_t { cell = 1, text = 4, number = 6 };

std::string element(Type type, const void* data, std::size_t size) {
    if (size > kMostBytes)
        throw InputError(fmt::format(
            "{} bytes in one array of a MAT-file; at most {} are allowed: use layout cf, or fewer "
            "nodes",
            size, kMostBytes));
    const std::uint32_t tag[2] = {type, std::uint32_t(size)};
    std::string bytes(reinterpret_cast<const char*>(tag), sizeof tag);
    bytes.append(static_cast<const char*>(data), size);
    bytes.resize((bytes.size() + 7) / 8 * 8);
    return bytes;
}

std::string array(Kind kind, const std::string& name, const std::vector<std::int32_t>& shape,
                  const std::string& content) {
    const std::uint32_t flags[2] = {kind, 0};
    const std::string inside = element(uint32, flags, sizeof flags) +
                               element(int32, shape.data(), 4 * shape.size()) +
                               element(int8, name.data(), name.size()) + content;
    return element(matrix, inside.data(), inside.size());
}

std::string numbers(const std::string& name, const std::vector<std::int32_t>& shape,
                    const std::vector<double>& values) {
    return array(number, name, shape, element(float64, values.data(), 8 * values.size()));
}

std::string row(const std::string& name, const std::vector<double>& values) {
    return numbers(name, {1, std::int32_t(values.size())}, values);
}

/// One row of characters for each text, filled with zeros, which NumPy takes off again.
std::string texts(const std::string& name, const std::vector<std::string>& rows) {
    std::size_t width = 0;
    for (const std::string& text : rows) width = std::max(width, text.size());
    std::vector<std::uint16_t> characters(rows.size() * width);
    for (std::size_t r = 0; r < rows.size(); ++r) {
        for (std::size_t c = 0; c < rows[r].size(); ++c)
            characters[c * rows.size() + r] = static_cast<unsigned char>(rows[r][c]);
    }
    return array(text, name, {std::int32_t(rows.size()), std::int32_t(width)},
                 element(uint16, characters.data(), 2 * characters.size()));
}

class IsofitWriter : public GatheredTable {
  public:
    IsofitWriter(const Sweep& sweep, const Layout& layout, const std::string& file)
        : GatheredTable(sweep, layout), file_(file) {}

    void finish() override {
        const Origin origin = origin_of(sweep_);
        std::string description =
            "MATLAB 5.0 MAT-file, " + origin.program + kIdentity + origin.identity;
        description.resize(kDescription, ' ');
        const std::uint16_t version_and_order[2] = {0x0100, 0x4d49};
        file_.stream() << description << std::string(8, '\0');
        file_.stream().write(reinterpret_cast<const char*>(version_and_order), 4);
        file_.stream() << row("wl", sweep_.wavelength.numbers)
                       << texts("source",
                                {fmt::format("{}; media of the first scene: {}", origin.program,
                                             fmt::join(origin.sources, "; "))})
                       << texts("sweep_file", {sweep_.text});
        if (sweep_.table_layout == TableLayout::isofit) {
            write_states();
        } else {
            write_component();
        }
        file_.commit();
    }

  private:
    /// The grid of lut_surface, and each state's range as its prior.
    void write_states() {
        std::vector<const Axis*> axes = {&sweep_.wavelength};
        std::vector<std::string> names, states;
        std::vector<double> low, high;
        std::vector<std::int32_t> shape;
        std::string grids;
        const auto add = [&](const Axis& axis, const std::string& name) {
            // The list for `over` has the slowest first, columns the fastest.
            axes.insert(axes.begin() + 1, &axis);
            names.push_back(name);
            shape.push_back(std::int32_t(axis.size()));
            grids += row("", axis.numbers);
        };
        for (const Dimension& dimension : sweep_.dimensions) {
            const Axis& axis = dimension.axes.front();
            add(axis, axis.name);
            states.push_back(axis.name);
            low.push_back(axis.numbers.front());
            high.push_back(axis.numbers.back());
        }
        if (sweep_.incidence.size() > 0) add(sweep_.incidence, "SOLZEN");
        if (sweep_.reflection.size() > 0) add(sweep_.reflection, "VIEWZEN");
        shape.push_back(std::int32_t(sweep_.wavelength.size()));

        std::vector<double> bounds = low, middle, width;
        bounds.insert(bounds.end(), high.begin(), high.end());
        for (std::size_t s = 0; s < low.size(); ++s) {
            middle.push_back((low[s] + high[s]) / 2);
            width.push_back(high[s] > low[s] ? high[s] - low[s] : 1.0);
        }
        file_.stream() << array(cell, "grids", {1, std::int32_t(names.size())}, grids)
                       << texts("lut_names", names) << texts("statevec_names", states)
                       << numbers("data", shape, over(axes))
                       << numbers("bounds", {std::int32_t(low.size()), 2}, bounds);
        for (const char* name : {"init", "mean", "prior_mean"}) file_.stream() << row(name, middle);
        for (const char* name : {"scale", "sigma", "prior_sigma"})
            file_.stream() << row(name, width);
    }

    /// The Gaussian of all spectra. The error of the values adds to each channel's variance:
    /// without it spectra of few scenes have no covariance that can be inverted.
    void write_component() {
        std::vector<const Axis*> axes;
        for (const Dimension& dimension : sweep_.dimensions)
            axes.push_back(&dimension.axes.front());
        for (const Axis* axis : {&sweep_.incidence, &sweep_.reflection, &sweep_.wavelength}) {
            if (axis->size() > 0) axes.push_back(axis);
        }
        using Rows = Eigen::Matrix<double, Eigen::Dynamic, Eigen::Dynamic, Eigen::RowMajor>;
        const std::vector<double> values = over(axes);
        const auto channels = Eigen::Index(sweep_.wavelength.size());
        const Eigen::Map<const Rows> spectra(values.data(), Eigen::Index(values.size()) / channels,
                                             channels);
        if (spectra.rows() < 2 || spectra.hasNaN())
            throw InputError(
                "layout isofit-surface: a covariance needs two spectra or more, all of them "
                "computed");
        const Eigen::RowVectorXd mean = spectra.colwise().mean();
        const Rows apart = spectra.rowwise() - mean;
        Rows covariance = apart.transpose() * apart / double(spectra.rows() - 1);
        const Eigen::Index of_scene = spectra.rows() / Eigen::Index(error_estimates_.size());
        for (Eigen::Index k = 0; k < spectra.rows(); ++k)
            covariance.diagonal() += (error_estimates_[std::size_t(k / of_scene)] * spectra.row(k))
                                         .cwiseAbs2()
                                         .transpose() /
                                     double(spectra.rows());
        const auto n = std::int32_t(channels);
        file_.stream() << row("means", {mean.begin(), mean.end()})
                       << numbers("covs", {1, n, n},
                                  {covariance.reshaped().begin(), covariance.reshaped().end()})
                       << texts("normalize", {"None"}) << row("refwl", sweep_.wavelength.numbers);
    }

    AtomicFile file_;
};

}  // namespace

std::unique_ptr<TableWriter> make_isofit_writer(const Sweep& sweep, const Layout& layout,
                                                const std::string& file) {
    return std::make_unique<IsofitWriter>(sweep, layout, file);
}

std::string identity_of_mat(const std::string& file) {
    std::ifstream stream(file, std::ios::binary);
    std::string description(kDescription, ' ');
    stream.read(description.data(), kDescription);
    const std::size_t at = description.find(kIdentity);
    if (at == std::string::npos) return {};
    const std::size_t first = at + sizeof kIdentity - 1;
    return description.substr(first, description.find(' ', first) - first);
}

}  // namespace miebrdf::sweep
