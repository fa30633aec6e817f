// JCAMP-DX: spectra of infrared and UV/VIS spectrometers, plain numbers or packed (ASDF).
// McDonald & Wilks 1988, Applied Spectroscopy 42, 151; version 4.24.
#include <fmt/format.h>

#include <algorithm>
#include <map>

#include "materials/index/units.h"
#include "materials/readers/text.h"
#include "materials/readers/text_table.h"
#include "pipeline/measured/columns.h"
#include "pipeline/measured/sheet.h"

namespace miebrdf::measured {
namespace {

/// Labels count without blanks, dashes, slashes and underscores, in capitals.
std::string jcamp_label(std::string_view text) {
    std::string label;
    for (char c : text) {
        if (c == ' ' || c == '-' || c == '/' || c == '_') continue;
        label += c >= 'a' && c <= 'z' ? static_cast<char>(c - 'a' + 'A') : c;
    }
    return label;
}

struct JcampBlock {
    std::map<std::string, std::string> records;
    std::vector<std::pair<int, std::string_view>> data;  ///< lines below XYDATA or XYPOINTS
    std::string data_form;                               ///< "(X++(Y..Y))"
    int line = 0;

    std::string text(const char* label) const {
        const auto found = records.find(label);
        return found == records.end() ? std::string() : found->second;
    }
};

/// Ordinates of one line. Digits may carry the sign and the meaning: SQZ the value itself, DIF its
/// difference from the one before, DUP how often the last is repeated.
class JcampLine {
  public:
    JcampLine(const MeasuredFile& file, int line, std::string_view text)
        : file_(file), line_(line), text_(text) {}

    /// @param values  those of the lines before; the first of this line only checks the last of
    ///                them where that was a difference
    /// @param most  values that there may be: a few letters repeat one a billion times
    /// @return the abscissa
    double read(std::vector<double>& values, bool& last_was_difference, std::size_t most) {
        const double x = plain_number();
        // Programs round abscissas to the last digit that they write.
        const std::string_view written = text_.substr(0, at_);
        const std::size_t exponent = std::min(written.find_first_of("Ee"), written.size()),
                          point = std::min(written.find('.'), exponent);
        const double power =
            exponent + 1 < written.size()
                ? materials::parse_number(written.substr(exponent + 1)).value_or(0.0)
                : 0.0;
        last_digit_ = std::pow(10.0, power - (point < exponent ? double(exponent - point - 1) : 0));
        bool first = true;
        double difference = 0.0;
        bool is_difference = false;
        while (skip_blanks()) {
            const char c = text_[at_];
            double value = 0.0;
            if (c == '?') {
                ++at_;
                value = MeasuredValue::kNone;
                is_difference = false;
            } else if (const int dup = place_in("STUVWXYZs", c); dup >= 0) {
                const double count = packed(dup + 1);
                if (values.empty()) fail();
                if (!(double(values.size()) + count <= double(most) + 1.0)) too_many(most);
                // The value is there once already.
                for (int i = 1; i < static_cast<int>(count); ++i)
                    values.push_back(is_difference ? values.back() + difference : values.back());
                continue;
            } else if (const int plus = place_in("%JKLMNOPQR", c); plus >= 0) {
                difference = packed(plus);
                is_difference = true;
            } else if (const int minus = place_in("jklmnopqr", c); minus >= 0) {
                difference = -packed(minus + 1);
                is_difference = true;
            } else if (const int squeezed = place_in("@ABCDEFGHI", c); squeezed >= 0) {
                value = packed(squeezed);
                is_difference = false;
            } else if (const int negative = place_in("abcdefghi", c); negative >= 0) {
                value = -packed(negative + 1);
                is_difference = false;
            } else {
                value = plain_number();
                is_difference = false;
            }
            if (is_difference) {
                if (values.empty()) fail();
                values.push_back(values.back() + difference);
            } else if (first && last_was_difference) {
                if (values.empty() || values.back() != value) {
                    refuse(file_, line_,
                           fmt::format("its first value {} should repeat {}: the packed data are "
                                       "damaged",
                                       value, values.empty() ? 0.0 : values.back()));
                }
            } else {
                values.push_back(value);
            }
            first = false;
            if (values.size() > most) too_many(most);
        }
        last_was_difference = is_difference;
        return x;
    }
    double last_digit() const { return last_digit_; }

  private:
    static int place_in(std::string_view letters, char c) {
        const std::size_t place = letters.find(c);
        return place == std::string_view::npos ? -1 : static_cast<int>(place);
    }
    [[noreturn]] void too_many(std::size_t most) const {
        refuse(file_, line_, fmt::format("more values than ##NPOINTS= says, {}", most));
    }
    [[noreturn]] void fail() const {
        refuse(file_, line_, fmt::format("'{}' is not a packed number", text_.substr(at_, 20)));
    }
    bool skip_blanks() {
        while (at_ < text_.size() && (text_[at_] == ' ' || text_[at_] == '\t' || text_[at_] == ','))
            ++at_;
        return at_ < text_.size();
    }
    bool is_digit(std::size_t place) const {
        return place < text_.size() &&
               ((text_[place] >= '0' && text_[place] <= '9') || text_[place] == '.');
    }
    /// A letter that is a digit, and the digits after it.
    double packed(int digit) {
        std::string digits = std::to_string(digit);
        ++at_;
        while (is_digit(at_)) digits += text_[at_++];
        return materials::parse_number(digits).value_or(0.0);
    }
    /// Digits with a sign, and an exponent where digits follow it ("E" alone is a packed digit).
    double plain_number() {
        skip_blanks();
        const std::size_t begin = at_;
        if (at_ < text_.size() && (text_[at_] == '+' || text_[at_] == '-')) ++at_;
        while (is_digit(at_)) ++at_;
        const bool exponent = at_ + 1 < text_.size() && (text_[at_] == 'E' || text_[at_] == 'e') &&
                              (text_[at_ + 1] == '+' || text_[at_ + 1] == '-') && is_digit(at_ + 2);
        if (exponent) {
            at_ += 2;
            while (is_digit(at_)) ++at_;
        }
        std::string number(text_.substr(begin, at_ - begin));
        if (number.starts_with('+')) number.erase(0, 1);
        const auto value = materials::parse_number(number);
        if (!value) fail();
        return *value;
    }

    const MeasuredFile& file_;
    int line_;
    std::string_view text_;
    std::size_t at_ = 0;
    double last_digit_ = 1.0;
};

std::vector<JcampBlock> jcamp_blocks(const MeasuredFile& file) {
    std::vector<JcampBlock> blocks;
    int line = 0;
    bool in_data = false;
    for (std::string_view text : materials::split_lines(file.content)) {
        ++line;
        text = materials::without_blanks(text.substr(0, std::min(text.find("$$"), text.size())));
        if (text.empty()) continue;
        const std::size_t equals = text.find('=');
        if (text.starts_with("##") && equals != std::string_view::npos) {
            const std::string label = jcamp_label(text.substr(2, equals - 2));
            const std::string value(materials::without_blanks(text.substr(equals + 1)));
            if (label == "TITLE") {
                blocks.push_back({});
                blocks.back().line = line;
            }
            if (blocks.empty()) refuse(file, line, "does not begin with ##TITLE=");
            in_data = (label == "XYDATA" || label == "XYPOINTS") && blocks.back().data_form.empty();
            if (in_data) blocks.back().data_form = jcamp_label(value);
            blocks.back().records.try_emplace(label, value);
        } else if (in_data) {
            blocks.back().data.emplace_back(line, text);
        }
    }
    return blocks;
}

double jcamp_number(const MeasuredFile& file, const JcampBlock& block, const char* label,
                    std::optional<double> otherwise = std::nullopt) {
    const std::string text = block.text(label);
    if (text.empty() && otherwise) return *otherwise;
    const auto value = materials::parse_number(text);
    if (!value) {
        refuse(file, block.line,
               text.empty() ? fmt::format("no ##{}=", label)
                            : fmt::format("##{}= '{}' is not a number", label, text));
    }
    return *value;
}

/// The abscissa that a line begins with.
struct JcampLineStart {
    int line = 0;
    std::size_t index = 0;  ///< of the value there
    double x = 0.0, unit = 0.0;
};

/// Abscissas first + step * i.
struct JcampAxis {
    double first = 0.0, step = 0.0;

    double at(std::size_t index) const { return first + step * double(index); }
    /// @param steps, unit  how far the abscissas of lines may lie off
    const JcampLineStart* first_off(const std::vector<JcampLineStart>& lines, double steps,
                                    double units) const {
        const auto found = std::find_if(lines.begin(), lines.end(), [&](const auto& line) {
            return !(std::abs(line.x - at(line.index)) <=
                     steps * std::abs(step) + units * line.unit);
        });
        return found == lines.end() ? nullptr : &*found;
    }
};

/// The axis that agrees with the lines: by FIRSTX and LASTX, by FIRSTX and DELTAX, or their own.
JcampAxis axis_of(const MeasuredFile& file, const JcampBlock& block, double points,
                  const std::vector<JcampLineStart>& lines, Measurements& list) {
    const double first = jcamp_number(file, block, "FIRSTX"),
                 last = jcamp_number(file, block, "LASTX"),
                 delta = jcamp_number(file, block, "DELTAX", 0.0);
    const JcampAxis by_last{first, points > 1.0 ? (last - first) / (points - 1.0) : 0.0};
    std::vector<JcampAxis> others;
    // Some programs write DELTAX without its sign, others round it: over the whole range it must
    // differ from LASTX by more than a step.
    const double signed_delta = std::copysign(delta, by_last.step);
    const bool has_delta = delta != 0.0 && points > 1.0;
    if (has_delta) others.push_back({first, signed_delta});
    // Two lines alone would agree with any step.
    if (lines.size() > 2 && lines.back().index > lines.front().index) {
        const JcampLineStart &a = lines.front(), &b = lines.back();
        const double step = (b.x - a.x) / double(b.index - a.index);
        others.push_back({a.x - step * double(a.index), step});
    }
    const bool few_lines = lines.empty() || lines.back().index == lines.front().index;
    const bool delta_is_off =
        has_delta && std::abs(signed_delta - by_last.step) * (points - 1.0) > std::abs(delta);
    if (by_last.first_off(lines, 0.01, 1.0) == nullptr && !(few_lines && delta_is_off))
        return by_last;
    for (const JcampAxis& axis : others) {
        if (axis.step == 0.0 || axis.first_off(lines, 0.01, 1.0) != nullptr) continue;
        if (std::abs(axis.at(std::size_t(points) - 1) - last) > 0.5 * std::abs(axis.step)) {
            list.doubts.push_back(
                fmt::format("{}:{}: ##LASTX= is {:g}; {} say {:g}, which is taken", file.path,
                            block.line, last, few_lines ? "##DELTAX= and ##NPOINTS=" : "the lines",
                            axis.at(std::size_t(points) - 1)));
        }
        return axis;
    }
    // Abscissas are rounded more coarsely than they are written; a lost line is ten points.
    const double x_factor = jcamp_number(file, block, "XFACTOR", 1.0);
    const JcampLineStart* off = by_last.first_off(lines, 3.0, 0.5);
    if (off != nullptr &&
        !(std::abs(off->x - by_last.at(off->index)) <= 0.5 * std::abs(x_factor))) {
        refuse(file, off->line,
               fmt::format("begins at {:g}, expected {:g}: lines are missing", off->x,
                           by_last.at(off->index)));
    }
    return by_last;
}

void read_packed(const MeasuredFile& file, const JcampBlock& block, std::vector<double>& x,
                 std::vector<double>& y, Measurements& list) {
    const double x_factor = jcamp_number(file, block, "XFACTOR", 1.0);
    const double points = jcamp_number(file, block, "NPOINTS");
    constexpr auto kMost = materials::ReadingBudget::kValues;
    if (!(points >= 1.0 && points <= double(kMost))) {
        refuse(file, block.line, fmt::format("##NPOINTS= {}; allowed: 1 to {}", points, kMost));
    }
    bool last_was_difference = false;
    std::vector<JcampLineStart> lines;
    for (const auto& [line, text] : block.data) {
        // A last line may hold a check alone, which some programs write as 0.
        if (last_was_difference && double(y.size()) == points) break;
        const std::size_t index = y.size() - (last_was_difference && !y.empty() ? 1 : 0);
        JcampLine ordinates(file, line, text);
        const double stated =
            ordinates.read(y, last_was_difference, std::size_t(points)) * x_factor;
        lines.push_back({line, index, stated, std::abs(x_factor) * ordinates.last_digit()});
    }
    const JcampAxis axis = axis_of(file, block, points, lines, list);
    if (double(y.size()) != points) {
        refuse(file, block.data.empty() ? block.line : block.data.back().first,
               fmt::format("{} values; ##NPOINTS= says {}: the file is cut off", y.size(), points));
    }
    for (std::size_t i = 0; i < y.size(); ++i) x.push_back(axis.at(i));
}

void read_pairs(const MeasuredFile& file, const JcampBlock& block, std::vector<double>& x,
                std::vector<double>& y) {
    const double factor = jcamp_number(file, block, "XFACTOR", 1.0);
    // Programs in languages with decimal commas write "176,36, 32822,795".
    const bool commas = block.text("FIRSTX").find(',') != std::string::npos;
    for (const auto& [line, text] : block.data) {
        auto words = materials::split_words(text, commas ? " \t;" : " \t,;");
        for (std::string_view& word : words) {
            if (word.ends_with(',')) word.remove_suffix(1);
        }
        if (words.size() % 2 != 0)
            refuse(file, line, fmt::format("{} numbers are no pairs", words.size()));
        for (std::size_t i = 0; i < words.size(); ++i) {
            const auto value = measured_number(words[i]);
            if (!value) refuse(file, line, fmt::format("'{}' is not a number", words[i]));
            materials::ReadingBudget::require_values(y.size() + 1, file.path, line);
            (i % 2 == 0 ? x : y).push_back(i % 2 == 0 ? *value * factor : *value);
        }
    }
    const double points = jcamp_number(file, block, "NPOINTS", double(y.size()));
    if (points != double(y.size())) {
        refuse(file, block.line,
               fmt::format("{} values; ##NPOINTS= says {}: the file is cut off", y.size(), points));
    }
}

void add_block(const MeasuredFile& file, const JcampBlock& block, const MeasuredOptions& options,
               Measurements& list) {
    const auto spectral = materials::spectral_name(block.text("XUNITS"));
    const auto unit =
        spectral && spectral->unit ? spectral->unit : materials::parse_unit(block.text("XUNITS"));
    if (!unit) {
        refuse(file, block.line,
               fmt::format("##XUNITS= '{}'; allowed: 1/CM, NANOMETERS, MICROMETERS",
                           block.text("XUNITS")));
    }
    const std::string y_units = block.text("YUNITS");
    const auto meaning = value_meaning(y_units);
    if (!meaning || (!meaning->refused.empty() && options.quantity.empty())) {
        refuse(file, block.line,
               meaning ? refusal_of("##YUNITS= " + y_units, meaning->refused)
                       : fmt::format("##YUNITS= '{}'; allowed: REFLECTANCE, TRANSMITTANCE, "
                                     "ABSORBANCE, KUBELKA-MUNK, LOG(1/R)",
                                     y_units));
    }
    std::vector<double> x, y;
    if (block.data_form.starts_with("(X++(Y..Y)"))
        read_packed(file, block, x, y, list);
    else if (block.data_form.starts_with("(XY"))
        read_pairs(file, block, x, y);
    else
        refuse(file, block.line, fmt::format("data of the form '{}'", block.data_form));
    const bool is_converted = meaning->conversion != Conversion::none;
    const double scale = jcamp_number(file, block, "YFACTOR", 1.0),
                 share = is_converted
                             ? 1.0
                             : share_factor(list, options, says_percent(y_units), "##YUNITS=");
    if (is_converted)
        list.facts.emplace_back("data", words_of(meaning->conversion, meaning->kind.quantity));
    std::vector<double> nm, values;
    for (std::size_t i = 0; i < x.size(); ++i) {
        if (!(x[i] > 0.0)) refuse(file, block.line, fmt::format("abscissa {}", x[i]));
        nm.push_back(materials::to_nm(x[i], *unit));
        const double number = is_fill(y[i]) ? MeasuredValue::kNone : y[i] * scale;
        values.push_back(converted(number, meaning->conversion) * share);
    }
    add_spectrum(list, block.text("TITLE"), meaning->kind, MeasuredValue::kNone, nm, values,
                 std::vector<int>(nm.size(), block.line));
}

/// SpectraSuite (Ocean Optics) writes blocks of counts, all named "Transmission (%)": the sample as
/// "PROCESSED SPECTRUM", then the dark signal and the reference. They make one share.
void join_counts(Measurements& list, const std::string& path) {
    const auto numbers_of = [&](const char* title) {
        std::vector<double> numbers;
        for (const MeasuredValue& v : list.values) {
            if (list.samples[v.sample].ends_with(title)) numbers.push_back(v.value);
        }
        return numbers;
    };
    std::vector<double> counts = numbers_of("PROCESSED SPECTRUM"),
                        dark = numbers_of(": DARK SPECTRUM"),
                        reference = numbers_of(": REFERENCE SPECTRUM");
    if (list.samples.size() != 3 || counts.empty() || dark.size() != counts.size() ||
        reference.size() != counts.size())
        return;
    for (std::size_t i = 0; i < counts.size(); ++i) {
        const double white = reference[i] - dark[i];
        list.values[i].value = white > 0.0 ? (counts[i] - dark[i]) / white : MeasuredValue::kNone;
    }
    list.values.resize(counts.size());
    list.samples.resize(1);
    list.doubts.push_back(
        fmt::format("{}: (sample - dark) / (reference - dark) of the three blocks, which their "
                    "program calls transmission even of reflected light: the option quantity says "
                    "what it is",
                    path));
}

bool looks_like_jcamp(const MeasuredFile& file) {
    const std::string_view start = file.content.substr(0, 4000);
    return start.find("##TITLE") != std::string_view::npos &&
           (start.find("##JCAMP") != std::string_view::npos ||
            start.find("##jcamp") != std::string_view::npos);
}

Measurements read_jcamp(const MeasuredFile& file, const MeasuredOptions& options) {
    Measurements list;
    bool any = false;
    for (const JcampBlock& block : jcamp_blocks(file)) {
        if (block.data_form.empty()) continue;  // links, notes
        add_block(file, block, options, list);
        any = true;
    }
    if (!any) refuse(file, 0, "no ##XYDATA= or ##XYPOINTS= of a spectrum");
    join_counts(list, file.path);
    return list;
}

}  // namespace

extern const Reader kJcamp;
constinit const Reader kJcamp{{"jcamp", "JCAMP-DX (.jdx, .dx)"}, looks_like_jcamp, read_jcamp};

}  // namespace miebrdf::measured
