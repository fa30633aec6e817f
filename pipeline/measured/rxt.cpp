// Measurements for iad (inverse adding-doubling): `.rxt` files. Seventeen numbers about sample and
// spheres, then how many values each line has or a letter for each column, then the lines.
// Format: iad's manual, https://github.com/scottprahl/iad.
#include <fmt/format.h>

#include <algorithm>
#include <map>

#include "materials/index/units.h"
#include "materials/readers/text.h"
#include "materials/readers/text_table.h"
#include "pipeline/measured/reader.h"

namespace miebrdf::measured {
namespace {

struct Word {
    std::string text;
    int line = 0;
};

/// Words without what follows a '#', behind the magic word.
std::vector<Word> words_of(const MeasuredFile& file) {
    std::vector<Word> words;
    int number = 0;
    for (std::string_view line : materials::split_lines(file.content)) {
        ++number;
        line = line.substr(0, std::min(line.find('#'), line.size()));
        if (number == 1) line.remove_prefix(std::min<std::size_t>(4, line.size()));
        for (const std::string_view word : materials::split_words(line, " \t"))
            words.push_back({std::string(word), number});
        materials::ReadingBudget::require_values(words.size(), file.path, number);
    }
    return words;
}

class RxtReader {
  public:
    explicit RxtReader(const MeasuredFile& file) : file_(file), words_(words_of(file)) {}

    Measurements read() {
        read_header();
        read_columns();
        while (at_ < words_.size()) read_line();
        for (const auto& [nm, row] : rows_) list_.spheres->rows.push_back(row);
        return std::move(list_);
    }

  private:
    double number() {
        if (at_ >= words_.size()) {
            refuse(file_, words_.empty() ? 1 : words_.back().line, "the file ends too early");
        }
        const Word& word = words_[at_++];
        const auto value = measured_number(word.text);
        if (!value) refuse(file_, word.line, fmt::format("'{}' is not a number", word.text));
        return *value;
    }

    void read_header() {
        static constexpr const char* kNames[] = {"index",
                                                 "slide_index",
                                                 "thickness_mm",
                                                 "slide_thickness_mm",
                                                 "beam_diameter_mm",
                                                 "reflectance_of_standard",
                                                 "spheres"};
        double last = 0.0;
        double standard = 1.0, beam = 0.0;
        for (const char* name : kNames) {
            last = number();
            if (name == std::string_view("beam_diameter_mm")) beam = last;
            if (name == std::string_view("reflectance_of_standard")) standard = last;
            list_.facts.emplace_back(name, fmt::format("{:g}", last));
        }
        if (last > 0.0) {
            list_.doubts.push_back(fmt::format(
                "{}: measured with {:g} integrating sphere{}: a fit takes r and t as they stand "
                "unless it says sphere = \"file\"; without that the scattering that it finds may "
                "be 2 times too small",
                file_.path, last, last > 1.0 ? "s" : ""));
        }
        SphereMeasurement spheres{.spheres = int(last), .beam_mm = beam};
        for (IntegratingSphere* sphere : {&spheres.above, &spheres.below})
            for (double* part : {&sphere->diameter_mm, &sphere->sample_port_mm,
                                 &sphere->third_port_mm, &sphere->detector_port_mm, &sphere->wall})
                *part = number();
        spheres.above.standard = standard;
        if (last == 1.0 || last == 2.0) list_.spheres = std::move(spheres);
    }

    /// "2", or letters with or without blanks: "L r t n".
    void read_columns() {
        if (at_ >= words_.size()) refuse(file_, 0, "ends before its measurements");
        const int line = words_[at_].line;
        const std::string first = words_[at_].text;
        if (first.size() == 1 && first[0] >= '1' && first[0] <= '7') {
            ++at_;
            columns_ = std::string("rtuwWRT").substr(0, static_cast<std::size_t>(first[0] - '0'));
            counted_ = true;
            return;
        }
        while (at_ < words_.size() && words_[at_].line == line) columns_ += words_[at_++].text;
        static constexpr std::string_view kKnown = "aAbBcCdDeEFgiLMnNqrRtSTuwW";
        const std::size_t unknown = columns_.find_first_not_of(kKnown);
        const bool any = columns_.find_first_of("rtu") != std::string::npos;
        if (unknown != std::string::npos || !any) {
            refuse(file_, line,
                   fmt::format("columns '{}'; allowed: letters of iad, among them r, t or u",
                               columns_));
        }
    }

    void read_line() {
        MeasuredValue value;
        value.line = words_[at_].line;
        value.geometry = MeasuredGeometry::directional;
        std::map<char, double> measured;
        if (counted_) {
            // A first number above 1 is the wavelength.
            const auto first = materials::parse_number(words_[at_].text);
            if (first && *first > 1.0) value.wavelength_nm = number();
        }
        for (const char column : columns_) {
            const double x = number();
            if (column == 'L') value.wavelength_nm = x;
            // iad writes 0 where u was not measured; of r and t, 0 may be a value.
            if (column != 'u' || x != 0.0) measured[column] = x;
            if (column == 'i') value.mu_in = cosine_of(x);
        }
        // A wavelength that was there before begins another sample.
        const int repeats = std::isnan(value.wavelength_nm) ? 0 : seen_[value.wavelength_nm]++;
        if (list_.spheres && value.wavelength_nm > 0.0) {
            const auto of_column = [&](char letter, double otherwise) {
                const auto found = measured.find(letter);
                return found == measured.end() ? otherwise : found->second;
            };
            const SphereMeasurement& all = *list_.spheres;
            rows_.emplace(
                value.wavelength_nm,
                SphereRow{value.wavelength_nm, of_column('w', all.above.wall),
                          of_column('W', all.below.wall), of_column('R', all.above.standard),
                          of_column('T', all.below.standard)});
        }
        for (const auto& [letter, name] : {std::pair('r', "reflectance"),
                                           {'t', "transmittance"},
                                           {'u', "unscattered_transmittance"}}) {
            const auto found = measured.find(letter);
            if (found == measured.end()) continue;
            value.value = found->second;
            value.quantity =
                letter == 'r' ? MeasuredQuantity::reflectance : MeasuredQuantity::transmittance;
            value.geometry =
                letter == 'u' ? MeasuredGeometry::unscattered : MeasuredGeometry::directional;
            value.sample = sample_of(name, repeats);
            list_.values.push_back(value);
        }
    }

    std::size_t sample_of(std::string name, int repeats) {
        if (repeats > 0) name += fmt::format(" {}", repeats + 1);
        const auto [at, added] = samples_.try_emplace(name, list_.samples.size());
        if (added) list_.samples.push_back(name);
        return at->second;
    }

    const MeasuredFile& file_;
    std::vector<Word> words_;
    std::map<double, int> seen_;
    std::map<double, SphereRow> rows_;
    std::map<std::string, std::size_t> samples_;
    std::size_t at_ = 0;
    std::string columns_;
    bool counted_ = false;  ///< columns by their number alone
    Measurements list_;
};

bool looks_like_rxt(const MeasuredFile& file) { return file.content.starts_with("IAD1"); }

Measurements read_rxt(const MeasuredFile& file, const MeasuredOptions& options) {
    if (!looks_like_rxt(file)) refuse(file, 1, "does not begin with IAD1");
    Measurements list = RxtReader(file).read();
    const bool any_angle = std::any_of(list.values.begin(), list.values.end(),
                                       [](const auto& v) { return !std::isnan(v.mu_in); });
    if (!any_angle && !options.mu_in) {
        list.doubts.push_back(
            fmt::format("{}: the angle of incidence is not in the file (iad takes 0 degrees, or "
                        "what its option -i says); give it with the option theta-in",
                        file.path));
    }
    return list;
}

}  // namespace

extern const Reader kRxt;
constinit const Reader kRxt{{"rxt", "iad (.rxt)"}, looks_like_rxt, read_rxt};

}  // namespace miebrdf::measured
