// The other side of a colour difference: spectra of a scene file, of a table, of a BRDF file.
#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <map>
#include <numbers>
#include <set>
#include <tuple>

#include <miebrdf/error.h>
#include <miebrdf/formats.h>
#include <miebrdf/measured.h>
#include "tools/miebrdf/colour_table.h"
#include "tools/miebrdf/run_command.h"

namespace miebrdf::program {
namespace {

bool is_scene_file(const std::string& path) { return path.ends_with(".toml"); }

/// The scene of a file's first result, at the wavelengths of the question.
Brdf scene_of_file(const std::string& path, Request request, const Control& control) {
    request.scene = read_scene_results(path).at(0).request.scene;
    return solved(request, control);
}

/// Values by ascending wavelength, those that `wanted` chooses.
template <typename Wanted>
std::map<double, double> by_wavelength(const Measurements& list, Wanted wanted) {
    std::map<double, double> spectrum;
    for (const MeasuredValue& v : list.values) {
        const bool seen = v.quantity == MeasuredQuantity::reflectance ||
                          v.quantity == MeasuredQuantity::reflectance_factor;
        if (seen && !std::isnan(v.wavelength_nm) && wanted(v)) spectrum[v.wavelength_nm] = v.value;
    }
    return spectrum;
}

void add(ReferenceSpectra& all, const std::map<double, double>& spectrum) {
    std::vector<double> wavelengths, values;
    for (const auto& [nm, value] : spectrum) {
        wavelengths.push_back(nm);
        values.push_back(value);
    }
    all.wavelength_nm = wavelengths;
    all.reflectance.push_back(values);
}

/// The file's only spectrum, for every row.
ReferenceSpectra repeated(const Measurements& list, std::size_t rows) {
    std::set<std::tuple<std::size_t, MeasuredQuantity, MeasuredGeometry>> spectra;
    std::string names;
    const auto is_new = [&](const MeasuredValue& v) {
        if (spectra.insert({v.sample, v.quantity, v.geometry}).second)
            names += (names.empty() ? "" : ", ") + list.samples[v.sample];
        return true;
    };
    ReferenceSpectra all;
    add(all, by_wavelength(list, is_new));
    if (spectra.size() != 1) {
        throw InputError(fmt::format(
            "reference '{}': which column? It has {}; write one to a file of its own: miebrdf "
            "measured {} --column NAME -o one.csv",
            list.file, names.empty() ? "no spectrum of a reflectance" : names, list.file));
    }
    all.reflectance.resize(rows, all.reflectance.front());
    return all;
}

/// Whether `albedo` has written it: plane albedos by mu_in, and the spherical one.
bool has_albedos(const Measurements& list) {
    const auto any = [&](MeasuredGeometry geometry) {
        return std::any_of(list.values.begin(), list.values.end(), [&](const auto& v) {
            return v.quantity == MeasuredQuantity::reflectance && v.geometry == geometry &&
                   (geometry != MeasuredGeometry::directional || !std::isnan(v.mu_in));
        });
    };
    return any(MeasuredGeometry::directional) && any(MeasuredGeometry::hemispherical);
}

ReferenceSpectra rows_of_albedos(const Measurements& list, const AlbedoQuestion& question) {
    ReferenceSpectra all;
    constexpr double kSame = 1e-9;
    for (const double mu : question.mu_in) {
        const auto spectrum = by_wavelength(list, [&](const MeasuredValue& v) {
            return v.geometry == MeasuredGeometry::directional && std::abs(v.mu_in - mu) <= kSame;
        });
        if (spectrum.empty()) {
            throw InputError(fmt::format("reference '{}' has no rows of mu_in {}", list.file, mu));
        }
        add(all, spectrum);
    }
    add(all, by_wavelength(list, [](const MeasuredValue& v) {
            return v.geometry == MeasuredGeometry::hemispherical;
        }));
    const std::vector<double> diffuse = all.reflectance.back();
    if (!question.diffuse_fraction) return all;
    const double d = *question.diffuse_fraction;
    for (std::size_t i = 0; i < question.mu_in.size(); ++i) {
        std::vector<double> sky = all.reflectance[i];
        for (std::size_t w = 0; w < sky.size(); ++w) sky[w] = (1.0 - d) * sky[w] + d * diffuse[w];
        all.reflectance.push_back(std::move(sky));
    }
    return all;
}

ReferenceSpectra checked(ReferenceSpectra spectra, const std::string& path) {
    const std::size_t count = spectra.wavelength_nm.size();
    const bool whole = std::all_of(spectra.reflectance.begin(), spectra.reflectance.end(),
                                   [&](const auto& r) { return r.size() == count; });
    if (!covers_the_visible(spectra.wavelength_nm) || !whole) {
        throw InputError(fmt::format(
            "reference '{}': {} wavelengths from {} to {} nm; allowed: eight or more, from 430 nm "
            "or less to 650 nm or more, for every row",
            path, count, count > 0 ? spectra.wavelength_nm.front() : 0.0,
            count > 0 ? spectra.wavelength_nm.back() : 0.0));
    }
    for (const std::vector<double>& spectrum : spectra.reflectance) {
        for (const double value : spectrum) {
            if (!(value >= 0.0 && std::isfinite(value))) {
                throw InputError(fmt::format(
                    "reference '{}': reflectance {}; allowed: finite and >= 0", path, value));
            }
        }
    }
    spectra.title = path;
    return spectra;
}

}  // namespace

std::vector<std::vector<double>> spectra_of(const AlbedoValues& values,
                                            const std::optional<double>& diffuse_fraction) {
    const std::size_t wavelengths = values.spherical_albedo.size(), count = values.mu_in.size();
    const auto spectrum = [&](auto value) {
        std::vector<double> all;
        for (std::size_t w = 0; w < wavelengths; ++w) all.push_back(value(w));
        return all;
    };
    std::vector<std::vector<double>> rows;
    for (std::size_t i = 0; i < count; ++i)
        rows.push_back(spectrum([&](std::size_t w) { return values.at(w, i); }));
    rows.push_back(values.spherical_albedo);
    for (std::size_t i = 0; i < count && diffuse_fraction; ++i)
        rows.push_back(
            spectrum([&](std::size_t w) { return values.under_sky(w, i, *diffuse_fraction); }));
    return rows;
}

ReferenceSpectra reference_albedos(const std::string& path, const AlbedoQuestion& question,
                                   const Control& control) {
    const std::size_t count = question.mu_in.size();
    const std::size_t rows = count + 1 + (question.diffuse_fraction ? count : 0);
    if (is_scene_file(path)) {
        const Brdf brdf = scene_of_file(path, question.request, control);
        return checked({path, brdf.wavelength_nm(),
                        spectra_of(brdf.albedo(question.mu_in), question.diffuse_fraction)},
                       path);
    }
    const Measurements list = read_measured(path);
    return checked(has_albedos(list) ? rows_of_albedos(list, question) : repeated(list, rows),
                   path);
}

std::vector<std::vector<double>> spectra_of(const BrdfValues& values, BrdfPart part) {
    std::vector<std::vector<double>> rows(values.slices.front().of(part).size());
    for (const BrdfValues::Slice& slice : values.slices) {
        const std::vector<double>& all = slice.of(part);
        for (std::size_t i = 0; i < all.size(); ++i) rows[i].push_back(std::numbers::pi * all[i]);
    }
    return rows;
}

ReferenceSpectra reference_reflectances(const std::string& path, const BrdfQuestion& question,
                                        const Control& control) {
    const auto& [mu_in, mu_out, azimuth_deg] = question.directions;
    if (is_scene_file(path)) {
        const Brdf brdf = scene_of_file(path, question.request, control);
        const BrdfValues values = brdf.evaluate(question.directions, question.parts);
        return checked({path, brdf.wavelength_nm(), spectra_of(values, question.columns.front())},
                       path);
    }
    std::unique_ptr<BrdfFile> file;
    try {
        file = open_brdf_file(path);
    } catch (const InputError&) {
        const Measurements list = read_measured(path);  // perhaps a spectrum
        return checked(repeated(list, mu_in.size() * mu_out.size() * azimuth_deg.size()), path);
    }
    ReferenceSpectra all;
    all.wavelength_nm = file->wavelength_nm();
    std::vector<double> values(file->channels().size());
    for (const double in : mu_in) {
        for (const double out : mu_out) {
            for (const double azimuth : azimuth_deg) {
                file->evaluate({in, out, azimuth}, values);
                all.reflectance.push_back(values);
                for (double& value : all.reflectance.back()) value *= std::numbers::pi;
            }
        }
    }
    return checked(std::move(all), path);
}

}  // namespace miebrdf::program
