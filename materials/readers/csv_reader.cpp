// CSV with a header that names columns and unit; '#' lines may carry provenance (`# label: Bond`).
#include <fmt/format.h>

#include <algorithm>

#include "materials/database/provenance.h"
#include "materials/readers/delimited.h"
#include "materials/readers/raw_table.h"
#include "materials/readers/readers.h"

namespace miebrdf::materials {
namespace {

std::string lower(std::string_view text) {
    std::string out(without_blanks(text));
    std::transform(out.begin(), out.end(), out.begin(), [](unsigned char c) {
        return c < 0x80 ? static_cast<char>(std::tolower(c)) : static_cast<char>(c);
    });
    return out;
}

struct Header {
    int x = -1, n = -1, k = -1;
    std::optional<Unit> unit;
    std::string x_name;
    std::vector<std::string> unused;
};

// "wavelength_um", "Wavelength (nm)", "lambda[A]", "energy_eV", "nm" -> unit; "wl" alone is what
// refractiveindex.info writes, in micrometres. Empty when it is no spectral column at all.
std::optional<std::string> unit_text(const std::string& name) {
    static constexpr std::string_view quantities[] = {
        "wavelength", "lambda", "wl", "\xce\xbb", "energy", "photon", "wavenumber", "frequency"};
    if (parse_unit(name)) return name;
    for (const std::string_view quantity : quantities) {
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

std::optional<Header> read_header(const std::vector<std::string>& fields) {
    Header header;
    for (int i = 0; i < static_cast<int>(fields.size()); ++i) {
        const std::string name = lower(fields[static_cast<std::size_t>(i)]);
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
struct Parts {
    RawTable n, k;
};

void read_row(Parts& parts, const Header& header, const std::vector<std::string>& fields,
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

void add_parts(Dataset& dataset, Parts parts, const std::string& file, const ReadOptions& options) {
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

}  // namespace

bool looks_like_csv(std::string_view text) {
    for (const std::string_view line : split_lines(text.substr(0, 100000))) {
        if (without_blanks(line).empty() || without_blanks(line).front() == '#') continue;
        return read_header(split_fields(line, separator_of(line))).has_value();
    }
    return false;
}

Dataset read_csv(std::string_view text, const std::string& file, const ReadOptions& options) {
    Dataset dataset;
    dataset.format = "csv";
    Parts parts;
    std::optional<Header> header;
    char separator = ',';
    int line = 0;
    for (const std::string_view raw : split_lines(text)) {
        ++line;
        const std::string_view content = without_blanks(raw);
        if (content.empty()) continue;
        if (content.front() == '#') {
            read_provenance_line(dataset, content.substr(1));
            continue;
        }
        const char found = separator_of(content);
        const auto fields = split_fields(content, header ? separator : found);
        if (!header || !parse_number(fields.front())) {
            separator = found;
            const auto next = read_header(split_fields(content, found));
            if (!next)
                throw ImportError(file, line, "no header with a wavelength column and n or k");
            if (!next->unit) {
                throw ImportError(file, line,
                                  fmt::format("the unit of '{}' is not known: name the column "
                                              "wavelength_nm, wavelength_um, energy_eV, ...",
                                              next->x_name));
            }
            header = next;
            if (header->n >= 0) parts.n.unit = *header->unit;
            if (header->k >= 0) parts.k.unit = *header->unit;
            for (const std::string& name : header->unused) {
                dataset.corrections.push_back(fmt::format("column '{}' ignored", name));
            }
            continue;
        }
        read_row(parts, *header, fields, file, line);
    }
    add_parts(dataset, std::move(parts), file, options);
    return dataset;
}

}  // namespace miebrdf::materials
