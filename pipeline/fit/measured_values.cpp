#include "pipeline/fit/measured_values.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <cmath>
#include <iterator>
#include <limits>
#include <numbers>
#include <utility>

#include <miebrdf/error.h>
#include "pipeline/measured/reader.h"
#include "pipeline/scene/number_list.h"

namespace miebrdf::fitting {
namespace {

constexpr double kSphereDegrees = 8.0;

double cosine(double degrees) { return std::cos(degrees * std::numbers::pi / 180.0); }

/// The values that stand in the fit file itself, as a file's would be.
std::vector<MeasuredValue> written_values(const MeasuredWords& words) {
    const MeasuredOptions& options = words.options;
    if (options.quantity.empty())
        throw UsageError("what are these values? Give quantity = \"plane_albedo\" or another");
    const MeasuredKind kind = measured_kind(options.quantity);
    const bool is_lab = kind.quantity == MeasuredQuantity::lab_l;
    const std::size_t wavelengths = words.wavelength_nm.size();
    if (!is_lab && wavelengths != 1 && wavelengths != words.values.size())
        throw UsageError(fmt::format("{} values and {} wavelengths; allowed: as many, or one",
                                     words.values.size(), wavelengths));
    if (is_lab && words.values.size() != 3)
        throw UsageError(
            fmt::format("{} values; a colour has three: L, a, b", words.values.size()));
    std::vector<MeasuredValue> values;
    for (std::size_t i = 0; i < words.values.size(); ++i) {
        MeasuredValue value{
            .quantity = kind.quantity, .geometry = kind.geometry, .value = words.values[i]};
        if (is_lab) {
            value.quantity = MeasuredQuantity(int(MeasuredQuantity::lab_l) + int(i));
        } else {
            value.wavelength_nm = words.wavelength_nm[wavelengths == 1 ? 0 : i];
        }
        if (options.sigma || options.relative_sigma)
            value.sigma = std::hypot(options.sigma.value_or(0.0),
                                     options.relative_sigma.value_or(0.0) * value.value);
        values.push_back(value);
    }
    return values;
}

/// Directions that the file, or the geometry, has and that are said otherwise.
void require_agreement(const MeasuredValue& value, const MeasuredOptions& options) {
    constexpr double kRounding = 1e-3;  // of a cosine: angles in whole degrees
    const auto differ = [](double has, const std::optional<double>& said) {
        return said && !std::isnan(has) && std::abs(has - *said) > kRounding;
    };
    const bool is_sky = value.geometry == MeasuredGeometry::hemispherical && options.mu_in;
    if (!is_sky && !differ(value.mu_in, options.mu_in) && !differ(value.mu_out, options.mu_out))
        return;
    const std::string geometry = word_of(value.geometry);
    throw UsageError(fmt::format(
        "the direction that is said is not that of the data{}; leave it out, or say with quantity "
        "what they are: plane_albedo has a mu_in of its own, d8-sci and d8-sce are at 8 degrees, "
        "45-0 from 45 degrees to 0, hemispherical from all sides",
        geometry.empty() ? "" : fmt::format(" ({})", geometry)));
}

/// What a geometry fixes, and what is said where it does not.
void complete(MeasuredValue& value, const MeasuredOptions& options) {
    const auto fill = [](double& number, const std::optional<double>& said) {
        if (std::isnan(number) && said) number = *said;
    };
    const bool is_sphere =
        value.geometry == MeasuredGeometry::d8_sci || value.geometry == MeasuredGeometry::d8_sce;
    if (is_sphere) fill(value.mu_in, cosine(kSphereDegrees));
    if (value.geometry == MeasuredGeometry::d45_0) {
        fill(value.mu_in, cosine(45.0));
        fill(value.mu_out, 1.0);
    }
    require_agreement(value, options);
    fill(value.mu_in, options.mu_in);
    fill(value.mu_out, options.mu_out);
    fill(value.azimuth_deg, options.azimuth_deg);
    if (value.quantity >= MeasuredQuantity::lab_l) fill(value.mu_in, cosine(kSphereDegrees));
}

void keep_ranges(std::vector<MeasuredValue>& values,
                 const std::vector<std::pair<double, double>>& ranges, const std::string& doubts) {
    double first = std::numeric_limits<double>::infinity(), last = 0.0;
    for (const MeasuredValue& value : values) {
        first = std::min(first, value.wavelength_nm);
        last = std::max(last, value.wavelength_nm);
    }
    if (!(last > 0.0)) return;
    std::vector<MeasuredValue> kept;
    for (const auto& [from, to] : ranges) {
        const std::size_t before = kept.size();
        std::copy_if(values.begin(), values.end(), std::back_inserter(kept),
                     [from = from, to = to](const MeasuredValue& value) {
                         return value.wavelength_nm >= from && value.wavelength_nm <= to;
                     });
        if (kept.size() == before)
            throw UsageError(fmt::format(
                "wavelengths {}:{} nm: no value is there; the data have {} to {} nm{}{}", from, to,
                first, last, doubts.empty() ? "" : ". What was left out: ", doubts));
    }
    values = std::move(kept);
}

}  // namespace

void read_values(const MeasuredWords& words, FitData& data) {
    std::vector<MeasuredValue>& values = data.values;
    if (words.file.empty()) {
        measured::check(words.options);
        values = written_values(words);
    } else {
        Measurements measured = read_measured(words.file, words.options);
        if (measured.samples.size() > 1 && words.options.column.empty())
            throw UsageError(fmt::format("{} has {} samples; name one: column = \"{}\"", words.file,
                                         measured.samples.size(),
                                         fmt::join(measured.samples, "\" or \"")));
        const auto is_lab = [](const MeasuredValue& v) {
            return v.quantity >= MeasuredQuantity::lab_l;
        };
        const auto colours = std::count_if(measured.values.begin(), measured.values.end(), is_lab);
        if (colours != 0 && std::size_t(colours) != measured.values.size())
            throw UsageError(
                fmt::format("{} has spectra and Lab of the same sample; say which: "
                            "quantity = \"lab\", or that of the spectrum",
                            words.file));
        values = std::move(measured.values);
        data.doubts = std::move(measured.doubts);
        if (words.has_spheres_of_file) {
            if (!measured.spheres)
                throw UsageError(fmt::format(
                    "{} says nothing of spheres; give them: sphere = {{ diameter = 200, "
                    "sample_port = 25, wall = 0.97 }}",
                    words.file));
            const bool as_iad = data.spheres->as_iad, lost = data.spheres->lost_light;
            data.spheres = std::move(measured.spheres);
            data.spheres->as_iad = as_iad;
            data.spheres->lost_light = lost;
        }
        if (data.spheres)  // they are used
            std::erase_if(data.doubts, [](const std::string& doubt) {
                return doubt.find("integrating sphere") != std::string::npos;
            });
    }
    if (!words.ranges.empty())
        keep_ranges(values, words.ranges, fmt::format("{}", fmt::join(data.doubts, "; ")));
    for (MeasuredValue& value : values) complete(value, words.options);
}

std::vector<std::pair<double, double>> wavelength_ranges(const std::string& text) {
    std::vector<std::pair<double, double>> ranges;
    for (const std::string& part : split_list(text, ',')) {
        const auto ends = split_list(part, ':');
        const double first = ends.size() == 2 ? parse_wavelength_nm(ends[0]) : 0.0,
                     last = ends.size() == 2 ? parse_wavelength_nm(ends[1]) : -1.0;
        if (!(first <= last) || (!ranges.empty() && first <= ranges.back().second))
            throw UsageError(
                fmt::format("wavelengths '{}'; write FIRST:LAST, \"900:1250\", or ascending ranges "
                            "after commas, \"900:925,960:1100\"",
                            text));
        ranges.emplace_back(first, last);
    }
    return ranges;
}

void set_loss(FitProblem& problem, const std::string& text) {
    const auto parts = split_list(text, ':');
    if (parts.front() == "squares") {
        problem.loss = FitLoss::squares;
    } else if (parts.front() == "huber") {
        problem.loss = FitLoss::huber;
    } else if (parts.front() == "cauchy") {
        problem.loss = FitLoss::cauchy;
    } else {
        throw UsageError(
            fmt::format("unknown loss '{}'; allowed: squares, huber:WIDTH, cauchy:WIDTH", text));
    }
    if (parts.size() > 1) problem.loss_width = parse_number(parts[1], "loss width");
}

}  // namespace miebrdf::fitting
