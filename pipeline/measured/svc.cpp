// SVC and GER field spectrometers (.sig): lines "key= value" up to "data=", then wavelength, signal
// of the white panel, signal of the sample, reflectance in percent. Where detectors overlap,
// wavelengths go back.
#include <fmt/format.h>

#include <numeric>

#include "materials/readers/text.h"
#include "materials/readers/text_table.h"
#include "pipeline/measured/reader.h"

namespace miebrdf::measured {
namespace {

bool looks_like_svc(const MeasuredFile& file) {
    return file.content.starts_with("/*** Spectra Vista") ||
           file.content.starts_with("///GER SIGNATUR FILE///");
}

/// Of two detectors that overlap the first counts below the middle of the overlap, the second
/// above: each has most noise at its end.
void cut_overlaps(Measurements& list, const std::string& path) {
    constexpr std::size_t kLongest = 300;  // of the text: instruments have three detectors
    std::vector<MeasuredValue> kept;
    std::string cuts, overlap;
    double cut = -INFINITY;
    for (const MeasuredValue& value : list.values) {
        const double low = value.wavelength_nm;
        if (!kept.empty() && low > cut && low <= kept.back().wavelength_nm) {
            const double high = kept.back().wavelength_nm;
            cut = std::midpoint(low, high);
            overlap = fmt::format("{:g} to {:g} nm", low, high);
            while (!kept.empty() && kept.back().wavelength_nm > cut) kept.pop_back();
        }
        if (low <= cut) continue;
        if (!overlap.empty() && !kept.empty() && cuts.size() < kLongest)
            cuts +=
                fmt::format("{}{} (cut at {:g}, from {:.4g} to {:.4g})", cuts.empty() ? "" : ", ",
                            overlap, cut, kept.back().value, value.value);
        overlap.clear();
        kept.push_back(value);
    }
    list.values = std::move(kept);
    if (cuts.empty()) return;
    list.doubts.push_back(fmt::format(
        "{}: detectors overlap at {}. If these steps matter, remove and match the overlaps in the "
        "instrument's program",
        path, cuts));
}

Measurements read_svc(const MeasuredFile& file, const MeasuredOptions& options) {
    Measurements list;
    std::vector<double> nm, values;
    std::vector<int> lines;
    std::string name = "spectrum";
    bool in_data = false, ratio = false;
    std::optional<double> factor;  // of a column of reflectances
    int line = 0;
    for (const std::string_view text : materials::split_lines(file.content)) {
        ++line;
        const std::string_view content = materials::without_blanks(text);
        if (content.empty() || line == 1) continue;
        if (!in_data) {
            const std::size_t mark = std::min(content.find('='), content.size());
            const std::string key = materials::lower_case(content.substr(0, mark));
            const std::string value = materials::as_utf8(
                materials::without_blanks(content.substr(std::min(mark + 1, content.size()))));
            in_data = key == "data";
            if (key == "name" && !value.empty()) name = value;
            if (key == "units" || key == "instrument" || key == "factors" || key == "comm")
                list.facts.emplace_back(key, value);
            continue;
        }
        std::vector<double> numbers;
        for (const std::string& word : materials::split_numbers(content)) {
            const auto number = measured_number(word);
            if (!number) refuse(file, line, fmt::format("'{}' is not a number", word));
            numbers.push_back(*number);
        }
        if (numbers.size() != 3 && numbers.size() != 4) {
            refuse(file, line,
                   fmt::format("{} numbers; expected: wavelength, panel, sample, and reflectance "
                               "in percent",
                               numbers.size()));
        }
        ratio = numbers.size() == 3;
        if (!ratio && !factor) factor = share_factor(list, options, true, "as all .sig files");
        nm.push_back(numbers[0]);
        values.push_back(!ratio             ? numbers[3] * *factor
                         : numbers[1] > 0.0 ? numbers[2] / numbers[1]
                                            : MeasuredValue::kNone);
        lines.push_back(line);
    }
    if (nm.empty()) refuse(file, 0, "no numbers below a line 'data='");
    list.facts.emplace_back(
        "data", ratio ? "sample over white panel" : "reflectance, relative to the white panel");
    add_spectrum(list, name, {MeasuredQuantity::reflectance_factor, MeasuredGeometry::unknown},
                 MeasuredValue::kNone, nm, values, lines);
    cut_overlaps(list, file.path);
    return list;
}

}  // namespace

extern const Reader kSvc;
constinit const Reader kSvc{
    {"svc", "SVC and GER field spectrometers (.sig)"}, looks_like_svc, read_svc};

}  // namespace miebrdf::measured
