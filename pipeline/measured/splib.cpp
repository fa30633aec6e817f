// Spectra of the USGS Spectral Library, version 7, as text: a line "splib07a Record=1: ...", then
// one value a line; wavelengths are a file of their own. -1.23e34 marks deleted channels.
// Kokaly et al. 2017, USGS Data Series 1035, doi:10.3133/ds1035.
#include <fmt/format.h>

#include <algorithm>

#include "materials/index/units.h"
#include "materials/readers/text.h"
#include "materials/readers/text_table.h"
#include "pipeline/measured/reader.h"

namespace miebrdf::measured {
namespace {

namespace fs = std::filesystem;

struct SplibColumn {
    std::string title;
    std::vector<double> values;
};

SplibColumn splib_column(const MeasuredFile& file) {
    SplibColumn column;
    int line = 0;
    for (const std::string_view text : materials::split_lines(file.content)) {
        ++line;
        const std::string_view content = materials::without_blanks(text);
        if (line == 1) {
            column.title = content;
            continue;
        }
        if (content.empty()) continue;
        const auto value = measured_number(content);
        if (!value) refuse(file, line, fmt::format("'{}' is not a number", content.substr(0, 40)));
        column.values.push_back(*value);
    }
    return column;
}

bool looks_like_splib(const MeasuredFile& file) {
    const std::string_view first = file.content.substr(0, file.content.find('\n'));
    return first.find("Record=") != std::string_view::npos;
}

/// The spectrometer that a title names, as files of wavelengths name it; empty: none known.
std::string spectrometer_in(const std::string& title) {
    for (const char* name : {"ASDFR", "ASDHR", "ASDNG", "ASD", "BECK", "NIC4", "AVIRIS", "CRISM",
                             "HYMAP", "HYPERION", "VIMS", "M3", "SENTINEL", "LANDSAT", "ASTER"}) {
        if (materials::lower_case(title).find(materials::lower_case(name)) != std::string::npos)
            return std::string(name).substr(0, 3);  // "ASDFR" has the wavelengths of "ASD"
    }
    return {};
}

/// The file of as many wavelengths beside the spectrum or in the two folders above; where several
/// fit, the one of the same spectrometer.
fs::path find_wavelengths(const MeasuredFile& file, const SplibColumn& spectrum) {
    std::vector<fs::path> fitting;
    const std::string instrument = materials::lower_case(spectrometer_in(spectrum.title));
    fs::path folder = fs::absolute(file.path).parent_path();
    for (int up = 0; up < 3 && fitting.empty(); ++up, folder = folder.parent_path()) {
        std::error_code ignored;
        for (const auto& entry : fs::directory_iterator(folder, ignored)) {
            const std::string name = entry.path().filename().string();
            if (name.find("avelengths") == std::string::npos || !entry.is_regular_file(ignored))
                continue;
            const std::string text = materials::read_bytes(entry.path());
            try {
                const SplibColumn other = splib_column({entry.path().string(), text});
                if (other.values.size() == spectrum.values.size()) fitting.push_back(entry.path());
            } catch (const materials::ImportError&) {
                continue;  // another table, or notes
            }
        }
    }
    const auto same = [&](const fs::path& path) {
        return materials::lower_case(path.filename().string()).find(instrument) !=
               std::string::npos;
    };
    if (fitting.size() > 1 && !instrument.empty())
        std::erase_if(fitting, [&](const fs::path& path) { return !same(path); });
    if (fitting.size() != 1) {
        refuse(file, 0,
               fmt::format("its {} wavelengths are in a file of their own: {} of as many beside it "
                           "or in the two folders above; give it with the option wavelengths",
                           spectrum.values.size(), fitting.empty() ? "none" : "more than one"));
    }
    return fitting.front();
}

Measurements read_splib(const MeasuredFile& file, const MeasuredOptions& options) {
    const SplibColumn spectrum = splib_column(file);
    if (spectrum.title.find("Wavelengths") != std::string::npos)
        refuse(file, 1, "these are wavelengths, not a spectrum");
    Measurements list;
    const fs::path path =
        options.wavelengths.empty() ? find_wavelengths(file, spectrum) : options.wavelengths;
    const std::string text = materials::read_bytes(path);
    const SplibColumn wavelengths = splib_column({path.string(), text});
    if (wavelengths.values.size() != spectrum.values.size()) {
        refuse(file, 0,
               fmt::format("{} values; '{}' has {} wavelengths", spectrum.values.size(),
                           path.string(), wavelengths.values.size()));
    }
    const std::string title = materials::lower_case(wavelengths.title);
    const bool in_nm =
        title.find(" nm") != std::string::npos || title.find("nanom") != std::string::npos;
    list.facts.emplace_back("wavelengths", path.string() + (in_nm ? " (nm)" : " (um)"));

    MeasuredKind kind;
    if (spectrum.title.ends_with("TRAN")) kind.quantity = MeasuredQuantity::transmittance;
    if (spectrum.title.ends_with("RREF")) {
        kind.quantity = MeasuredQuantity::reflectance_factor;
        list.facts.emplace_back("data", "RREF: relative to the white panel, not absolute");
    }
    std::vector<double> nm, values;
    std::vector<int> lines;
    for (std::size_t i = 0; i < spectrum.values.size(); ++i) {
        const int line = static_cast<int>(i) + 2;
        if (std::isnan(wavelengths.values[i])) continue;  // deleted there
        if (!(wavelengths.values[i] > 0.0))
            refuse(file, line, fmt::format("wavelength {}", wavelengths.values[i]));
        nm.push_back(wavelengths.values[i] * (in_nm ? 1.0 : 1000.0));
        values.push_back(spectrum.values[i]);
        lines.push_back(line);
    }
    // "splib07a Record=11062: Acmite NMNH133746 BECKa AREF": the sample stands behind the colon.
    const std::size_t colon = spectrum.title.find(':');
    add_spectrum(list,
                 colon == std::string::npos
                     ? spectrum.title
                     : std::string(materials::without_blanks(spectrum.title.substr(colon + 1))),
                 kind, MeasuredValue::kNone, nm, values, lines);
    return list;
}

}  // namespace

extern const Reader kSplib;
constinit const Reader kSplib{
    {"splib", "USGS spectral library (.txt)"}, looks_like_splib, read_splib};

}  // namespace miebrdf::measured
