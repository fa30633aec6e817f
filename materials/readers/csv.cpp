// CSV with a header that names columns and unit; '#' lines may carry provenance (`# label: Bond`).
#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <iterator>
#include <limits>
#include <optional>

#include "materials/index/units.h"
#include "materials/readers/file_format.h"
#include "materials/readers/text.h"

namespace miebrdf::materials {
namespace {

std::string lower_case(std::string_view text) {
    std::string out(without_blanks(text));
    std::transform(out.begin(), out.end(), out.begin(), [](unsigned char c) {
        return c < 0x80 ? static_cast<char>(std::tolower(c)) : static_cast<char>(c);
    });
    return out;
}

struct CsvHeader {
    int x = -1, n = -1, k = -1;
    std::optional<Unit> unit;
    std::string x_name;
    std::vector<std::string> unused;
    bool bare = false;  ///< there is none: wavelength, n and perhaps k
};

// "wavelength_um", "Wavelength (nm)", "lambda[A]", "energy_eV", "nm" -> unit; "wl" alone is what
// refractiveindex.info writes, in micrometres. Empty when it is no spectral column at all.
std::optional<std::string> unit_text(const std::string& name) {
    static constexpr std::string_view kQuantities[] = {
        "wavelength", "lambda", "wl", "\xce\xbb", "energy", "photon", "wavenumber", "frequency"};
    if (parse_unit(name)) return name;
    for (const std::string_view quantity : kQuantities) {
        if (!name.starts_with(quantity)) continue;
        const std::string rest = name.substr(quantity.size());
        const auto first = rest.find_first_not_of(" _([,/");
        if (first == std::string::npos) return quantity == "wl" ? "um" : "";
        std::string unit = rest.substr(first);
        if (unit.starts_with("energy")) unit = unit.substr(std::min<std::size_t>(7, unit.size()));
        while (!unit.empty() && (unit.back() == ')' || unit.back() == ']' || unit.back() == ' ')) {
            unit.pop_back();
        }
        while (!unit.empty() && (unit.front() == '(' || unit.front() == '[')) unit.erase(0, 1);
        return unit;
    }
    return std::nullopt;
}

std::optional<CsvHeader> read_csv_header(const std::vector<std::string>& fields) {
    CsvHeader header;
    for (int i = 0; i < static_cast<int>(fields.size()); ++i) {
        const std::string name = lower_case(fields[static_cast<std::size_t>(i)]);
        if (name == "n" || name == "eta" || name == "ior") {
            header.n = i;
        } else if (name == "k" || name == "kappa") {
            header.k = i;
        } else if (const auto unit = unit_text(name); unit && header.x < 0) {
            header.x = i;
            header.x_name = fields[static_cast<std::size_t>(i)];
            header.unit = parse_unit(*unit);
        } else {
            header.unused.push_back(fields[static_cast<std::size_t>(i)]);
        }
    }
    if (header.x < 0 || (header.n < 0 && header.k < 0)) return std::nullopt;
    return header;
}

char separator_of(std::string_view line) {
    for (const char c : {',', ';', '\t'}) {
        if (line.find(c) != std::string_view::npos) return c;
    }
    return ',';
}

/// n and k may stand in one block or in two, each with its header.
struct CsvBlocks {
    RawTable n, k;
};

void read_row(CsvBlocks& parts, const CsvHeader& header, const std::vector<std::string>& fields,
              const std::string& file, int line) {
    const auto field = [&](int i) {
        return i >= 0 && i < static_cast<int>(fields.size()) ? fields[static_cast<std::size_t>(i)]
                                                             : "";
    };
    const double x = require_number(field(header.x), file, line);
    const std::string n = field(header.n);
    const std::string k = field(header.k);
    if (n.empty() && k.empty()) throw ImportError(file, line, "neither n nor k");
    if (!n.empty()) parts.n.rows.push_back({x, require_number(n, file, line), 0.0, line});
    if (!k.empty()) parts.k.rows.push_back({x, 0.0, require_number(k, file, line), line});
}

void add_parts(Dataset& dataset, CsvBlocks parts, const std::string& file,
               const ReadOptions& options) {
    const auto same_x = [](const RawRow& a, const RawRow& b) { return a.x == b.x; };
    const bool joint = parts.n.unit == parts.k.unit &&
                       std::equal(parts.n.rows.begin(), parts.n.rows.end(), parts.k.rows.begin(),
                                  parts.k.rows.end(), same_x);
    if (joint) {
        for (std::size_t i = 0; i < parts.n.rows.size(); ++i) parts.n.rows[i].k = parts.k.rows[i].k;
        return add_table(dataset, std::move(parts.n), file, options);
    }
    parts.n.has_k = parts.k.has_n = false;
    if (!parts.n.rows.empty()) add_table(dataset, std::move(parts.n), file, options);
    if (!parts.k.rows.empty()) add_table(dataset, std::move(parts.k), file, options);
    if (!dataset.n && !dataset.k) throw ImportError(file, 0, "no data");
}

bool is_bare_row(std::string_view content) {
    const auto fields = split_words(content);
    if (fields.size() < 2 || fields.size() > 3) return false;
    return std::all_of(fields.begin(), fields.end(),
                       [](std::string_view field) { return parse_number(field).has_value(); });
}

CsvHeader bare_header(std::string_view content, const ReadOptions& options) {
    CsvHeader header;
    header.x = 0;
    header.n = 1;
    header.k = split_words(content).size() > 2 ? 2 : -1;
    header.unit = options.unit;
    header.bare = true;
    return header;
}

bool looks_like_csv(std::string_view text) {
    for (const std::string_view line : split_lines(text.substr(0, 100000))) {
        if (without_blanks(line).empty() || without_blanks(line).front() == '#') continue;
        return read_csv_header(split_fields(line, separator_of(line))).has_value();
    }
    return false;
}

Dataset read_csv(const SourceFile& source, const ReadOptions& options) {
    const std::string file = source.path.string();
    Dataset dataset;
    dataset.format = "csv";
    CsvBlocks parts;
    std::optional<CsvHeader> header;
    char separator = ',';
    int line = 0;
    BadRows bad;
    for (const std::string_view raw : split_lines(source.text)) {
        ++line;
        const std::string_view content = without_blanks(raw);
        if (content.empty()) continue;
        if (content.front() == '#') {
            read_provenance_line(dataset, content.substr(1));
            continue;
        }
        if (!header && options.unit && is_bare_row(content)) {
            header = bare_header(content, options);
            parts.n.unit = parts.k.unit = *options.unit;
        }
        const char found = separator_of(content);
        const auto words = split_words(content);
        const auto fields = header && header->bare
                                ? std::vector<std::string>(words.begin(), words.end())
                                : split_fields(content, header ? separator : found);
        const bool row = header && parse_number(fields.front());
        // A line that is not a row is a bad row, or a header, which begins the next block.
        const bool bad_row = header && !row && options.skip_bad_rows &&
                             !read_csv_header(split_fields(content, found));
        if (!row && !bad_row) {
            separator = found;
            auto next = read_csv_header(split_fields(content, found));
            if (!next)
                throw ImportError(file, line, "no header with a wavelength column and n or k");
            if (!next->unit) next->unit = options.unit;
            if (!next->unit) {
                throw ImportError(file, line,
                                  fmt::format("the unit of '{}' is not known: name the column "
                                              "with its unit, as in wavelength_um or energy_eV",
                                              next->x_name));
            }
            header = std::move(next);
            if (header->n >= 0) parts.n.unit = *header->unit;
            if (header->k >= 0) parts.k.unit = *header->unit;
            for (const std::string& name : header->unused) {
                dataset.corrections.push_back(fmt::format("column '{}' ignored", name));
            }
            continue;
        }
        bad.try_row(options, [&] { read_row(parts, *header, fields, file, line); });
    }
    bad.record(dataset, std::max(parts.n.rows.size(), parts.k.rows.size()));
    add_parts(dataset, std::move(parts), file, options);
    return dataset;
}

const char* csv_column(Unit unit) {
    switch (unit) {
        case Unit::nanometre:
            return "wavelength_nm";
        case Unit::micrometre:
            return "wavelength_um";
        case Unit::angstrom:
            return "wavelength_angstrom";
        case Unit::electronvolt:
            return "energy_eV";
        case Unit::per_centimetre:
            return "wavenumber_cm-1";
        case Unit::terahertz:
            break;
    }
    return "frequency_THz";
}

void append_csv(std::string& text, const Series& series, const char* column, const Series* second) {
    fmt::format_to(std::back_inserter(text), "{},{}{}\n", csv_column(series.unit), column,
                   second != nullptr ? ",k" : "");
    for (std::size_t i = 0; i < series.x.size(); ++i) {
        fmt::format_to(std::back_inserter(text), "{},{}", series.x[i], series.y[i]);
        if (second != nullptr) fmt::format_to(std::back_inserter(text), ",{}", second->y[i]);
        text += '\n';
    }
}

std::vector<ExportFile> write_csv(const Dataset& d, const ExportOptions&) {
    if (d.n && !d.n->tabulated())
        refuse_export(d, "csv", "n is a formula; only yaml keeps formulas");
    std::string text = remarks(d, "# ");
    if (d.n && d.k && d.n->unit == d.k->unit && d.n->x == d.k->x) {
        append_csv(text, *d.n, "n", &*d.k);
        return {{".csv", std::move(text)}};
    }
    if (d.n) append_csv(text, *d.n, "n", nullptr);
    if (d.n && d.k) text += '\n';
    if (d.k) append_csv(text, *d.k, "k", nullptr);
    return {{".csv", std::move(text)}};
}

}  // namespace

extern const FileFormat kCsv;
constinit const FileFormat kCsv{
    .name = "csv",
    .title = "CSV with a header",
    .endings = {".csv"},
    .looks_like = looks_like_csv,
    .read = read_csv,
    .write = write_csv,
};

}  // namespace miebrdf::materials
