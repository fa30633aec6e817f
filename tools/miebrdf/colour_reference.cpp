// The other side of a colour difference: spectra of a scene file, of a table, of a BRDF file.
#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <initializer_list>
#include <map>
#include <numbers>
#include <numeric>
#include <optional>
#include <set>
#include <tuple>
#include <utility>

#include <miebrdf/error.h>
#include <miebrdf/formats.h>
#include <miebrdf/measured.h>
#include "materials/readers/text_table.h"
#include "tools/miebrdf/colour_table.h"
#include "tools/miebrdf/direction_options.h"
#include "tools/miebrdf/run_command.h"

namespace miebrdf::program {
namespace {

bool is_scene_file(const std::string& path) { return path.ends_with(".toml"); }

/// The scene of a file's first result, at the wavelengths of the question, over its own ground or
/// over this one.
Brdf scene_of_file(const std::string& path, Request request, const std::optional<Substrate>& ground,
                   const Control& control) {
    request.scene = read_scene_results(path).at(0).request.scene;
    if (ground) request.scene.substrate = ground;
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

void add(ReferenceColours& all, const std::map<double, double>& spectrum) {
    std::vector<double> wavelengths, values;
    for (const auto& [nm, value] : spectrum) {
        wavelengths.push_back(nm);
        values.push_back(value);
    }
    all.wavelength_nm = wavelengths;
    all.reflectance.push_back(values);
}

/// Names of a row of a table, such as mu_in, with what they say there; empty: nothing.
using RowKeys = std::vector<std::pair<std::string, std::string>>;

struct ColourRow {
    RowKeys keys = {};
    Lab lab = {};
};

/// Colours as a file has them; empty: it has none.
struct ColourRows {
    std::vector<ColourRow> rows = {};
    std::optional<std::string> viewing = {};  ///< where the file says it
};

bool is_one_of(const std::string& name, std::initializer_list<const char*> names) {
    return std::any_of(names.begin(), names.end(), [&](const char* n) { return name == n; });
}

/// The rows of a table of CSV with columns L*, a*, b*; none: another file.
ColourRows colours_of_csv(const std::string& path) {
    ColourRows found;
    const std::string bytes = materials::read_bytes(path);
    if (bytes.find('\0') != std::string::npos) return found;
    materials::TextTable table(bytes, path);
    if (!table.next()) return found;
    table.take_names();
    const std::vector<std::string> names = table.fields();
    std::optional<std::size_t> l, a, b;
    for (std::size_t i = 0; i < names.size(); ++i) {
        if (is_one_of(names[i], {"lab_l", "L*", "L"})) l = i;
        if (is_one_of(names[i], {"lab_a", "a*", "a"})) a = i;
        if (is_one_of(names[i], {"lab_b", "b*", "b"})) b = i;
    }
    if (!l || !a || !b) return found;
    while (table.next()) {
        const std::vector<std::string>& fields = table.fields();
        if (fields.size() != names.size())
            table.refuse(fmt::format("{} fields under {} names", fields.size(), names.size()));
        ColourRow row;
        row.lab = {table.number(fields[*l]), table.number(fields[*a]), table.number(fields[*b])};
        for (std::size_t i = 0; i < names.size(); ++i) {
            if (is_one_of(names[i], {"over", "quantity", "mu_in", "mu_out", "azimuth_deg"}))
                row.keys.emplace_back(names[i], fields[i]);
        }
        found.rows.push_back(std::move(row));
    }
    for (const std::string& comment : table.comments()) {
        if (comment.starts_with("viewing: ")) found.viewing = comment.substr(9);
    }
    return found;
}

/// Lab of measurements, sample by sample.
ColourRows colours_of(const Measurements& list) {
    ColourRows found;
    for (std::size_t sample = 0; sample < list.samples.size(); ++sample) {
        std::optional<double> l, a, b;
        for (const MeasuredValue& v : list.values) {
            if (v.sample != sample) continue;
            if (v.quantity == MeasuredQuantity::lab_l) l = v.value;
            if (v.quantity == MeasuredQuantity::lab_a) a = v.value;
            if (v.quantity == MeasuredQuantity::lab_b) b = v.value;
        }
        if (l && a && b) found.rows.push_back({{}, {*l, *a, *b}});
    }
    return found;
}

bool says_the_same(const std::string& text, const std::string& wanted) {
    const auto number = materials::table_number(text), other = materials::table_number(wanted);
    constexpr double kSame = 1e-9;
    return number && other ? std::abs(*number - *other) <= kSame : text == wanted;
}

/// @param wanted  keys of the rows of the table that is written
ReferenceColours labs_of(const ColourRows& colours, const std::vector<RowKeys>& wanted,
                         bool has_two_grounds, const Viewing& viewing, const std::string& path) {
    if (colours.viewing && *colours.viewing != describe(viewing)) {
        throw InputError(fmt::format("reference '{}': its colours are of {}, not of {}", path,
                                     *colours.viewing, describe(viewing)));
    }
    ReferenceColours all{.title = path};
    std::vector<ColourRow> rows = colours.rows;
    if (!rows.front().keys.empty()) {
        for (const RowKeys& keys : wanted) {
            const auto fits = [&](const ColourRow& row) {
                return std::all_of(row.keys.begin(), row.keys.end(), [&](const auto& key) {
                    const auto same = std::find_if(keys.begin(), keys.end(), [&](const auto& own) {
                        return own.first == key.first;
                    });
                    return same == keys.end() || says_the_same(key.second, same->second);
                });
            };
            const auto row = std::find_if(rows.begin(), rows.end(), fits);
            if (row == rows.end()) {
                std::string names;
                for (const auto& [name, text] : keys)
                    names += fmt::format("{}{} {}", names.empty() ? "" : ", ", name, text);
                throw InputError(fmt::format("reference '{}' has no row of {}", path, names));
            }
            all.labs.push_back(row->lab);
        }
        return all;
    }
    std::sort(rows.begin(), rows.end(),
              [](const ColourRow& a, const ColourRow& b) { return a.lab.l < b.lab.l; });
    if (rows.size() > (has_two_grounds ? 2U : 1U)) {
        throw InputError(
            fmt::format("reference '{}': which of its {} colours? Write one{} to a "
                        "file of its own",
                        path, rows.size(), has_two_grounds ? ", or one over each ground," : ""));
    }
    for (std::size_t r = 0; r < wanted.size(); ++r)
        all.labs.push_back(rows[2 * r < wanted.size() ? 0 : rows.size() - 1].lab);
    return all;
}

/// The file's only spectrum, for every row; over two grounds perhaps two, the darker one first.
ReferenceColours repeated(const Measurements& list, std::size_t rows, bool has_two_grounds) {
    using Spectrum = std::tuple<std::size_t, MeasuredQuantity, MeasuredGeometry>;
    std::set<Spectrum> spectra;
    std::string names;
    const auto name_of = [](const MeasuredValue& v) {
        return Spectrum{v.sample, v.quantity, v.geometry};
    };
    const auto is_new = [&](const MeasuredValue& v) {
        if (spectra.insert(name_of(v)).second)
            names += (names.empty() ? "" : ", ") + list.samples[v.sample];
        return true;
    };
    by_wavelength(list, is_new);
    if (spectra.empty() || spectra.size() > (has_two_grounds ? 2U : 1U)) {
        throw InputError(fmt::format(
            "reference '{}': which column? It has {}; write one to a file of its own: miebrdf "
            "measured {} --column NAME -o one.csv",
            list.file, names.empty() ? "no spectrum of a reflectance" : names, list.file));
    }
    ReferenceColours all;
    for (const Spectrum& spectrum : spectra)
        add(all, by_wavelength(list, [&](const auto& v) { return name_of(v) == spectrum; }));
    if (all.reflectance.size() == 1) {
        all.reflectance.resize(rows, all.reflectance.front());
        return all;
    }
    const auto sum = [](const std::vector<double>& r) {
        return std::accumulate(r.begin(), r.end(), 0.0);
    };
    std::vector<std::vector<double>> two = std::move(all.reflectance);
    if (sum(two[1]) < sum(two[0])) std::swap(two[0], two[1]);
    all.reflectance.assign(rows / 2, two[0]);
    all.reflectance.insert(all.reflectance.end(), rows / 2, two[1]);
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

/// What `albedo` has written over one ground.
ReferenceColours rows_of_albedos(const Measurements& list, const AlbedoQuestion& question) {
    ReferenceColours all;
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
            return v.geometry != MeasuredGeometry::directional;
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

/// The measurements of one sample.
Measurements of_sample(const Measurements& list, const std::string& name) {
    Measurements one = list;
    std::erase_if(one.values, [&](const auto& v) { return list.samples[v.sample] != name; });
    return one;
}

/// Likewise over two.
ReferenceColours rows_over_grounds(const Measurements& list, const AlbedoQuestion& question) {
    ReferenceColours all = rows_of_albedos(of_sample(list, "albedo_over_dark"), question);
    const auto light = rows_of_albedos(of_sample(list, "albedo_over_light"), question);
    all.reflectance.insert(all.reflectance.end(), light.reflectance.begin(),
                           light.reflectance.end());
    return all;
}

/// The keys of the rows of `albedo --colour`.
std::vector<RowKeys> keys_of(const AlbedoQuestion& question) {
    std::vector<RowKeys> all;
    const auto add_rows = [&](const RowKeys& ground) {
        const auto add_row = [&](const char* quantity, const std::string& mu_in) {
            RowKeys& keys = all.emplace_back(ground);
            keys.emplace_back("quantity", quantity);
            keys.emplace_back("mu_in", mu_in);
        };
        for (const double mu : question.mu_in) add_row("plane_albedo", fmt::format("{}", mu));
        add_row("spherical_albedo", "");
        if (!question.diffuse_fraction) return;
        for (const double mu : question.mu_in) add_row("blue_sky_albedo", fmt::format("{}", mu));
    };
    if (question.over.empty()) add_rows({});
    for (const Substrate& ground : question.over) add_rows({{"over", describe(ground)}});
    return all;
}

ReferenceColours checked(ReferenceColours spectra, const std::string& path) {
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

/// One measured colour or spectrum for every row, over two grounds perhaps two.
ReferenceColours of_whole_file(const Measurements& list, const std::vector<RowKeys>& rows,
                               bool has_two_grounds, const Viewing& viewing) {
    const bool has_spectrum = !by_wavelength(list, [](const auto&) { return true; }).empty();
    if (const ColourRows colours = colours_of(list); !has_spectrum && !colours.rows.empty())
        return labs_of(colours, rows, has_two_grounds, viewing, list.file);
    return checked(repeated(list, rows.size(), has_two_grounds), list.file);
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

ReferenceColours reference_albedos(const std::string& path, const AlbedoQuestion& question,
                                   const Control& control) {
    const bool has_two_grounds = !question.over.empty();
    if (is_scene_file(path)) {
        ReferenceColours all{.title = path, .wavelength_nm = question.request.wavelength_nm};
        std::vector<std::optional<Substrate>> grounds(question.over.begin(), question.over.end());
        if (grounds.empty()) grounds.emplace_back();
        for (const std::optional<Substrate>& ground : grounds) {
            const Brdf brdf = scene_of_file(path, question.request, ground, control);
            for (auto& row : spectra_of(brdf.albedo(question.mu_in), question.diffuse_fraction))
                all.reflectance.push_back(std::move(row));
        }
        return checked(std::move(all), path);
    }
    const std::vector<RowKeys> keys = keys_of(question);
    if (const ColourRows csv = colours_of_csv(path); !csv.rows.empty())
        return labs_of(csv, keys, has_two_grounds, *question.viewing, path);
    const Measurements list = read_measured(path);
    const auto has_sample = [&](const char* name) {
        return std::find(list.samples.begin(), list.samples.end(), name) != list.samples.end();
    };
    if (has_two_grounds && has_sample("albedo_over_dark") && has_sample("albedo_over_light"))
        return checked(rows_over_grounds(list, question), path);
    if (!has_two_grounds && has_albedos(list))
        return checked(rows_of_albedos(list, question), path);
    return of_whole_file(list, keys, has_two_grounds, *question.viewing);
}

std::vector<std::vector<double>> spectra_of(const BrdfValues& values, BrdfPart part) {
    std::vector<std::vector<double>> rows(values.slices.front().of(part).size());
    for (const BrdfValues::Slice& slice : values.slices) {
        const std::vector<double>& all = slice.of(part);
        for (std::size_t i = 0; i < all.size(); ++i) rows[i].push_back(std::numbers::pi * all[i]);
    }
    return rows;
}

ReferenceColours reference_reflectances(const std::string& path, const BrdfQuestion& question,
                                        const Control& control) {
    if (is_scene_file(path)) {
        const Brdf brdf = scene_of_file(path, question.request, {}, control);
        const BrdfValues values = brdf.evaluate(question.directions, question.parts);
        return checked({path, brdf.wavelength_nm(), spectra_of(values, question.columns.front())},
                       path);
    }
    std::unique_ptr<BrdfFile> file;
    try {
        file = open_brdf_file(path);
    } catch (const InputError&) {  // perhaps colours or a spectrum
    }
    std::vector<RowKeys> keys;
    ReferenceColours all;
    if (file != nullptr) all.wavelength_nm = file->wavelength_nm();
    for_each_direction(question.directions, [&](double in, double out, double azimuth) {
        keys.push_back({{"mu_in", fmt::format("{}", in)},
                        {"mu_out", fmt::format("{}", out)},
                        {"azimuth_deg", fmt::format("{}", azimuth)}});
        if (file == nullptr) return;
        std::vector<double>& values =
            all.reflectance.emplace_back(std::vector<double>(file->channels().size()));
        file->evaluate({in, out, azimuth}, values);
        for (double& value : values) value *= std::numbers::pi;
    });
    if (file == nullptr) {
        if (const ColourRows csv = colours_of_csv(path); !csv.rows.empty())
            return labs_of(csv, keys, false, *question.viewing, path);
        return of_whole_file(read_measured(path), keys, false, *question.viewing);
    }
    return checked(std::move(all), path);
}

}  // namespace miebrdf::program
