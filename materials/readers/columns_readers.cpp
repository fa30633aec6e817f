// Plain columns: IMD / Luxpop .nk (Angstrom) and Mitsuba / pbrt .spd (nm).
#include <fmt/format.h>

#include "materials/readers/delimited.h"
#include "materials/readers/raw_table.h"
#include "materials/readers/readers.h"

namespace miebrdf::materials {
namespace {

struct Columns {
    std::vector<std::pair<int, std::vector<double>>> rows;  ///< line, numbers
    std::string comments;
};

Columns read_columns(std::string_view text, char comment, std::size_t count,
                     const std::string& file) {
    Columns columns;
    int line = 0;
    for (std::string_view raw : split_lines(text)) {
        ++line;
        const std::size_t mark = raw.find(comment);
        if (mark != std::string_view::npos) {
            const std::string_view remark = without_blanks(raw.substr(mark + 1));
            if (!remark.empty() && columns.comments.size() < 2000) {
                columns.comments += (columns.comments.empty() ? "" : " ") + std::string(remark);
            }
            raw = raw.substr(0, mark);
        }
        const auto words = split_words(raw, " \t,\x1a");
        if (words.empty()) continue;
        if (words.size() != count) {
            throw ImportError(file, line,
                              fmt::format("{} columns, expected {}", words.size(), count));
        }
        std::vector<double> numbers;
        numbers.reserve(count);
        for (const std::string_view word : words)
            numbers.push_back(require_number(word, file, line));
        columns.rows.emplace_back(line, std::move(numbers));
    }
    return columns;
}

// True when the first line that is neither empty nor a comment has `count` numbers.
bool first_row_has(std::string_view text, char comment, std::size_t count) {
    for (const std::string_view raw : split_lines(text)) {
        const auto words = split_words(raw.substr(0, raw.find(comment)), " \t,\x1a");
        if (words.empty()) continue;
        for (const std::string_view word : words) {
            if (!parse_number(word)) return false;
        }
        return words.size() == count;
    }
    return false;
}

char first_character(std::string_view text) {
    const std::string_view start = without_blanks(text);
    return start.empty() ? '\0' : start.front();
}

}  // namespace

bool looks_like_imd(std::string_view text) {
    return first_character(text) == ';' && first_row_has(text, ';', 3);
}

bool looks_like_spd(std::string_view text) { return first_row_has(text, '#', 2); }

Dataset read_imd(std::string_view text, const std::string& file, const ReadOptions& options) {
    Dataset dataset;
    dataset.format = "imd";
    RawTable table;
    table.unit = Unit::angstrom;
    const Columns columns = read_columns(text, ';', 3, file);
    for (const auto& [line, numbers] : columns.rows) {
        table.rows.push_back({numbers[0], numbers[1], numbers[2], line});
    }
    dataset.note = columns.comments;
    add_table(dataset, std::move(table), file, options);
    return dataset;
}

Dataset read_spd(std::string_view eta_text, std::string_view k_text, const std::string& file,
                 const ReadOptions& options) {
    Dataset dataset;
    dataset.format = "spd";
    const auto read = [&](std::string_view text, double RawRow::*member, bool is_n) {
        if (text.empty()) return;
        RawTable table;
        table.has_n = is_n;
        table.has_k = !is_n;
        const Columns columns = read_columns(text, '#', 2, file + (is_n ? ".eta.spd" : ".k.spd"));
        for (const auto& [line, numbers] : columns.rows) {
            RawRow row{numbers[0], 0.0, 0.0, line};
            row.*member = numbers[1];
            table.rows.push_back(row);
        }
        if (dataset.note.empty()) dataset.note = columns.comments;
        add_table(dataset, std::move(table), file + (is_n ? ".eta.spd" : ".k.spd"), options);
    };
    read(eta_text, &RawRow::n, true);
    read(k_text, &RawRow::k, false);
    if (!dataset.n && !dataset.k) throw ImportError(file, 0, "no data");
    return dataset;
}

}  // namespace miebrdf::materials
