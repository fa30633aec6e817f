#include "materials/readers/text_table.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <cerrno>
#include <cmath>
#include <cstring>
#include <fstream>
#include <iterator>
#include <limits>

#include "materials/index/units.h"
#include "materials/readers/text.h"

namespace miebrdf::materials {
namespace {

/// Whether the separator stands in the line outside quotes.
bool separates(std::string_view line, char separator) {
    bool quoted = false;
    for (const char c : line) {
        if (c == '"') quoted = !quoted;
        if (c == separator && !quoted) return true;
    }
    return false;
}

bool begins_number(std::string_view text) {
    return !text.empty() && std::string_view("0123456789+-.").find(text[0]) != std::string::npos;
}

/// Words between blanks; "(nm)" belongs to the word before.
std::vector<std::string> split_names(std::string_view line) {
    std::vector<std::string> names;
    for (const std::string_view word : split_words(line, " \t")) {
        if (!names.empty() && (word.front() == '(' || word.front() == '['))
            names.back() += " " + std::string(word);
        else
            names.emplace_back(word);
    }
    return names;
}

/// What spreadsheets write in place of a number, which is no comment.
bool is_spreadsheet_error(std::string_view text) {
    static constexpr std::string_view kErrors[] = {"#N/A",  "#NA",    "#VALUE!", "#DIV/0!",
                                                   "#NUM!", "#NULL!", "#REF!",   "#NAME?"};
    return std::any_of(std::begin(kErrors), std::end(kErrors), [&](std::string_view error) {
        return text.starts_with(error) &&
               (text.size() == error.size() ||
                std::string_view(",; \t\"").find(text[error.size()]) != std::string_view::npos);
    });
}

bool says_percent(std::string_view name) {
    const std::string text = lower_case(name);
    return text.find('%') != std::string::npos || text.find("percent") != std::string::npos;
}

}  // namespace

void ReadingBudget::require_values(std::size_t count, const std::string& file, int line,
                                   std::size_t most) {
    if (count <= most) return;
    throw ImportError(file, line,
                      fmt::format("has more than {0} values or lines; allowed: {0} in one file. "
                                  "Split it",
                                  most));
}

std::string read_bytes(const std::filesystem::path& file, std::uintmax_t most) {
    std::error_code error;
    if (std::filesystem::is_directory(file, error)) {
        throw ImportError(file.string(), 0, "is a folder");
    }
    // Reading a pipe could wait for ever, and a device may never end.
    if (std::filesystem::exists(file, error) && !std::filesystem::is_regular_file(file, error)) {
        throw ImportError(file.string(), 0, "no ordinary file");
    }
    std::ifstream stream(file, std::ios::binary);
    if (!stream) {
        throw ImportError(file.string(), 0,
                          fmt::format("cannot be read: {}", std::strerror(errno)));
    }
    const auto too_large = [&] {
        throw ImportError(file.string(), 0, fmt::format("larger than {} MiB", most >> 20));
    };
    const auto size = std::filesystem::file_size(file, error);
    if (!error && size > most) too_large();
    // What a file says of its size need not be true: those of /proc say 0.
    std::string text;
    if (!error) text.reserve(size);
    std::vector<char> piece(1 << 16);
    while (stream.read(piece.data(), std::streamsize(piece.size())) || stream.gcount() > 0) {
        text.append(piece.data(), std::size_t(stream.gcount()));
        if (text.size() > most) too_large();
    }
    if (stream.bad()) throw ImportError(file.string(), 0, "cannot be read");
    return text;
}

std::string without_mark(std::string text, const std::string& file) {
    if (text.starts_with("\xff\xfe") || text.starts_with("\xfe\xff"))
        throw ImportError(file, 0, "is UTF-16 text; save it as UTF-8");
    if (text.starts_with("\xef\xbb\xbf")) text.erase(0, 3);
    for (const char end : {'\n', '\r'}) {
        ReadingBudget::require_values(std::size_t(std::count(text.begin(), text.end(), end)), file);
    }
    return text;
}

std::string text_of(std::string bytes, const std::string& file) {
    std::string text = without_mark(std::move(bytes), file);
    if (text.find('\0') != std::string::npos)
        throw ImportError(file, 0, "holds binary data; allowed: text");
    return text;
}

std::optional<double> table_number(std::string_view field) {
    std::string text(without_blanks(field));
    const bool is_percent = text.ends_with('%');
    if (is_percent) text = without_blanks(std::string_view(text).substr(0, text.size() - 1));
    std::replace(text.begin(), text.end(), ',', '.');
    const auto value = parse_number(text);
    if (!value || !std::isfinite(*value)) return std::nullopt;
    return is_percent ? *value / 100.0 : *value;
}

std::vector<std::string> split_numbers(std::string_view line) {
    std::vector<std::string_view> words = split_words(line, " \t;\x1a");
    const auto has_inner_comma = [](std::string_view word) {
        const auto comma = word.find(',');
        return comma != std::string::npos && comma > 0 && comma + 1 < word.size();
    };
    const auto ends_in_comma = [](std::string_view word) { return word.ends_with(','); };
    const bool in_words = std::any_of(words.begin(), words.end(), has_inner_comma);
    const bool after_words = std::any_of(words.begin(), words.end(), ends_in_comma);
    // "400,0, 1,5, 0,01": every number has a comma inside, and a comma separates them.
    const bool both = in_words && after_words && line.find('.') == std::string::npos &&
                      std::all_of(words.begin(), words.end(), has_inner_comma) &&
                      std::all_of(words.begin(), words.end() - 1, ends_in_comma);
    const bool decimal = in_words && words.size() > 1 && (!after_words || both);
    if (!decimal) {
        words = split_words(line, " \t;,\x1a");
        return {words.begin(), words.end()};
    }
    std::vector<std::string> numbers;
    for (std::string_view word : words) {
        if (ends_in_comma(word)) word.remove_suffix(1);
        numbers.emplace_back(word);
    }
    return numbers;
}

std::optional<SpectralName> spectral_name(std::string_view name) {
    static constexpr std::string_view kQuantities[] = {
        "wavelength", "lambda",    "wl",  "\xce\xbb", "energy", "photon",
        "wavenumber", "frequency", "wvl", "wave",     "wavel"};
    std::string text = lower_case(name);
    if (const auto unit = parse_unit(text)) return SpectralName{unit};
    for (const std::string_view quantity : kQuantities) {
        if (!text.starts_with(quantity)) continue;
        const char after = text.size() > quantity.size() ? text[quantity.size()] : ' ';
        if (quantity.starts_with("w") && quantity.size() < 5 && after >= 'a' && after <= 'z')
            continue;  // "waves", "wlan"
        text.erase(0, quantity.size());
        const auto drop_marks = [&] {
            text.erase(0, std::min(text.find_first_not_of(" _([,/:"), text.size()));
        };
        drop_marks();
        for (const std::string_view word : {"energy", "in "}) {
            if (text.starts_with(word)) text.erase(0, word.size());
            drop_marks();
        }
        text.resize(std::min(text.find_first_of(" )],;\t"), text.size()));
        return SpectralName{parse_unit(text), quantity == "wl" && text.empty()};
    }
    return std::nullopt;
}

TextTable::TextTable(std::string_view text, std::string file, char comment)
    : rest_(text), file_(std::move(file)), comment_(comment) {}

bool TextTable::next() {
    while (!rest_.empty()) {
        const std::size_t end = std::min(rest_.find_first_of("\r\n"), rest_.size());
        std::string_view content = rest_.substr(0, end);
        ends_with_blank_ = content.ends_with(' ') || content.ends_with('\t');
        content = without_blanks(content);
        rest_.remove_prefix(
            rest_.substr(end).starts_with("\r\n") ? end + 2 : std::min(end + 1, rest_.size()));
        ++line_;
        // Behind numbers a comment may follow; in a line of names "#1" is part of a name.
        std::size_t mark = content.find(comment_);
        while (mark != std::string::npos && is_spreadsheet_error(content.substr(mark)))
            mark = content.find(comment_, mark + 1);
        if (mark == 0 || (mark != std::string::npos && begins_number(content))) {
            const std::string_view remark = without_blanks(content.substr(mark + 1));
            if (!remark.empty()) comments_.emplace_back(remark);
            content = without_blanks(content.substr(0, mark));
        }
        if (content.empty() || content == "\x1a") continue;
        content_ = content;
        fields_ = split(content);
        ReadingBudget::require_values(fields_.size(), file_, line_);
        if (!fields_.empty()) return true;
    }
    return false;
}

std::vector<std::string> TextTable::split(std::string_view content) const {
    if (names_ == 1) return split_fields(content, ';');
    for (const char separator : {';', '\t', ','}) {
        const bool is_of_names = separator == separator_;
        const bool free = separator_ == '\0' && !begins_number(content);
        if ((separator == ';' || is_of_names || free) && separates(content, separator))
            return split_fields(content, separator);
    }
    return begins_number(content) ? split_numbers(content) : split_names(content);
}

void TextTable::take_names() {
    separator_ = ' ';
    for (const char separator : {',', '\t', ';'}) {
        if (separates(content_, separator)) separator_ = separator;
    }
    names_ = fields_.size();
}

double TextTable::number(std::string_view field) {
    has_point_ = has_point_ || field.find('.') != std::string_view::npos;
    has_comma_ = has_comma_ || field.find(',') != std::string_view::npos;
    if (has_point_ && has_comma_) {
        refuse(
            fmt::format("'{}': the file has decimal points and decimal commas; write one of "
                        "them throughout",
                        field.substr(0, 40)));
    }
    const auto value = table_number(field);
    if (!value) refuse(fmt::format("'{}' is not a number", field.substr(0, 40)));
    return *value;
}

void TextTable::refuse(const std::string& reason) const { throw ImportError(file_, line_, reason); }

NumberTable::NumberTable(const std::string& path) : path_(path) {
    const std::string text = text_of(read_bytes(path), path);
    TextTable table(text, path);
    while (table.next()) {
        const std::vector<std::string>& fields = table.fields();
        if (names_.empty()) {
            if (begins_number(fields.front()))
                table.refuse(fmt::format("'{}': the first line must name the columns",
                                         fmt::join(fields, ",")));
            table.take_names();
            names_ = fields;
            columns_.resize(fields.size());
            continue;
        }
        if (fields.size() != names_.size()) {
            table.refuse(
                fmt::format("{} fields under {} names; decimal commas need semicolons "
                            "between the fields",
                            fields.size(), names_.size()));
        }
        ReadingBudget::require_values((lines_.size() + 1) * fields.size(), path_, table.line());
        for (std::size_t c = 0; c < fields.size(); ++c) {
            columns_[c].push_back(fields[c].empty() ? std::numeric_limits<double>::quiet_NaN()
                                                    : table.number(fields[c]));
        }
        lines_.push_back(table.line());
    }
    if (lines_.empty()) refuse("has no rows; the first line names the columns");
    for (std::size_t c = 0; c < names_.size() && wavelength_nm_.empty(); ++c) {
        const auto spectral = spectral_name(names_[c]);
        if (!spectral || !spectral->unit || names_[c].size() < 2) continue;  // "A" is an albedo
        wavelength_column_ = c;
        for (const double x : columns_[c]) wavelength_nm_.push_back(to_nm(x, *spectral->unit));
    }
    comments_ = table.comments();
}

void NumberTable::require_names(std::initializer_list<std::string_view> needed,
                                std::initializer_list<std::string_view> allowed) const {
    for (const std::string_view name : needed) column(name);
    // find("wavelength_nm") takes it from this column where no other has that name.
    const bool converts = !wavelength_nm_.empty() && find("wavelength_nm") == &wavelength_nm_;
    for (const std::string& name : names_) {
        const std::string_view meant = converts && &name == &names_[wavelength_column_]
                                           ? std::string_view("wavelength_nm")
                                           : std::string_view(name);
        const auto is = [&](std::string_view known) { return lower_case(meant) == known; };
        const bool known = std::any_of(needed.begin(), needed.end(), is) ||
                           std::any_of(allowed.begin(), allowed.end(), is);
        const auto same = [&](const std::string& other) { return other == name; };
        if (known && std::count_if(names_.begin(), names_.end(), same) == 1) continue;
        std::vector<std::string_view> all(needed);
        all.insert(all.end(), allowed);
        refuse(fmt::format("column '{}' is unknown or there twice; allowed: '{}'", name,
                           fmt::join(all, "', '")));
    }
}

const std::vector<double>* NumberTable::find(std::string_view name) const {
    const auto found = std::find_if(names_.begin(), names_.end(), [&](const std::string& known) {
        return lower_case(known) == lower_case(name);
    });
    if (found != names_.end()) return &columns_[std::size_t(found - names_.begin())];
    return name == "wavelength_nm" && !wavelength_nm_.empty() ? &wavelength_nm_ : nullptr;
}

const std::vector<double>& NumberTable::column(std::string_view name) const {
    const std::vector<double>* found = find(name);
    if (found == nullptr)
        refuse(fmt::format("no column '{}'; there are '{}'", name, fmt::join(names_, "', '")));
    return *found;
}

std::size_t NumberTable::spectrum() const {
    if (wavelength_nm_.empty() || names_.size() != 2) {
        refuse(
            fmt::format("which column? It has {}; allowed: a column of wavelengths, named with "
                        "their unit (wavelength_nm), and one other",
                        fmt::join(names_, ", ")));
    }
    return 1 - wavelength_column_;
}

std::vector<double> NumberTable::fractions(std::size_t column, double largest) const {
    std::vector<double> values = columns_[column];
    for (std::size_t row = 0; row < values.size(); ++row) {
        if (says_percent(names_[column])) values[row] /= 100.0;
        if (values[row] <= largest) continue;
        refuse(row,
               fmt::format("{} is {}; allowed: up to {}, a share of 1. Percentages are written "
                           "45% or named so: '{} (%)'",
                           names_[column], columns_[column][row], largest, names_[column]));
    }
    return values;
}

std::optional<double> NumberTable::comment(std::string_view name) const {
    for (const std::string& comment : comments_) {
        const std::size_t at = comment.find(std::string(name) + ":");
        if (at == std::string::npos) continue;
        const auto value = table_number(std::string_view(comment).substr(at + name.size() + 1));
        if (!value) refuse(fmt::format("'# {}' has no number", comment));
        return value;
    }
    return std::nullopt;
}

void NumberTable::refuse(std::size_t row, const std::string& reason) const {
    throw ImportError(path_, lines_[row], reason);
}

void NumberTable::refuse(const std::string& reason) const { throw ImportError(path_, 0, reason); }

}  // namespace miebrdf::materials
