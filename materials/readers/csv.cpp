// CSV with a header that names columns and unit; '#' lines may carry provenance (`# label: Bond`).
#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <complex>
#include <initializer_list>
#include <iterator>
#include <optional>

#include "materials/index/units.h"
#include "materials/readers/file_format.h"
#include "materials/readers/text.h"
#include "materials/readers/text_table.h"

namespace miebrdf::materials {
namespace {

/// Which columns hold what; -1: none does.
struct CsvHeader {
    int x = -1, n = -1, k = -1;
    bool is_permittivity = false;  ///< n and k are the columns of eps' and eps''
    SpectralName spectral;
    std::string x_name;
    std::string second_of_a_kind;  ///< column that means what another means already
    std::vector<std::string> unused;
};

bool is_one_of(std::string_view name, std::initializer_list<std::string_view> names) {
    return std::find(names.begin(), names.end(), name) != names.end();
}

std::optional<CsvHeader> read_csv_header(const std::vector<std::string>& fields) {
    CsvHeader header;
    int real = -1, imaginary = -1;  // of the permittivity
    const auto take = [&](int& place, int i) {
        if (place >= 0) header.second_of_a_kind = fields[static_cast<std::size_t>(i)];
        place = i;
    };
    for (int i = 0; i < static_cast<int>(fields.size()); ++i) {
        const std::string& field = fields[static_cast<std::size_t>(i)];
        std::string name = lower_case(field);
        const auto spectral = spectral_name(name);
        std::replace(name.begin(), name.end(), ' ', '_');
        if (is_one_of(name, {"n", "eta", "ior", "refractive_index", "index", "n_real", "real_index",
                             "re(n)"})) {
            take(header.n, i);
        } else if (is_one_of(name, {"k", "kappa", "extinction_coefficient", "extinction", "n_imag",
                                    "im(n)"})) {
            take(header.k, i);
        } else if (is_one_of(name,
                             {"eps1", "e1", "eps_1", "epsilon1", "epsilon_1", "eps'", "eps_real",
                              "eps_re", "eps_r", "re(eps)", "permittivity_real", "\xce\xb5'",
                              "\xce\xb5"
                              "1"})) {
            take(real, i);
        } else if (is_one_of(name, {"eps2", "e2", "eps_2", "epsilon2", "epsilon_2", "eps''",
                                    "eps\"", "eps_imag", "eps_im", "eps_i", "im(eps)",
                                    "permittivity_imag", "\xce\xb5''",
                                    "\xce\xb5"
                                    "2"})) {
            take(imaginary, i);
        } else if (spectral && header.x < 0) {
            header.x = i;
            header.x_name = field;
            header.spectral = *spectral;
        } else {
            header.unused.push_back(field);
        }
    }
    if (header.n < 0 && header.k < 0 && real >= 0 && imaginary >= 0) {
        header.is_permittivity = true;
        header.n = real;
        header.k = imaginary;
    }
    if (header.x < 0 || (header.n < 0 && header.k < 0)) return std::nullopt;
    return header;
}

/// n and k may stand in one block or in two, each with its header.
struct CsvBlocks {
    RawTable n, k;
};

void read_row(CsvBlocks& parts, const CsvHeader& header, TextTable& lines, std::size_t columns) {
    const auto& fields = lines.fields();
    // Separators at the end of a line are empty fields.
    for (std::size_t i = columns; i < fields.size(); ++i) {
        if (fields[i].empty()) continue;
        lines.refuse(
            fmt::format("{} fields under {} names; decimal commas need semicolons between "
                        "the fields",
                        fields.size(), columns));
    }
    const auto field = [&](int i) {
        return i >= 0 && i < static_cast<int>(fields.size()) ? fields[static_cast<std::size_t>(i)]
                                                             : "";
    };
    const double x = lines.number(field(header.x));
    const std::string n = field(header.n), k = field(header.k);
    if (n.empty() && k.empty()) lines.refuse("neither n nor k");
    std::complex<double> index(n.empty() ? 0.0 : lines.number(n),
                               k.empty() ? 0.0 : lines.number(k));
    if (header.is_permittivity) {
        if (n.empty() || k.empty()) lines.refuse("half of a permittivity");
        index = std::sqrt(index);
    }
    if (!n.empty()) parts.n.rows.push_back({x, index.real(), 0.0, lines.line()});
    if (!k.empty()) parts.k.rows.push_back({x, 0.0, index.imag(), lines.line()});
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

bool is_row(const std::vector<std::string>& fields) {
    return std::all_of(fields.begin(), fields.end(), [](const std::string& field) {
        return field.empty() || table_number(field).has_value();
    });
}

/// The line of names, perhaps as a comment above the rows.
std::optional<CsvHeader> header_in_comment(const TextTable& lines) {
    if (lines.comments().empty() || !is_row(lines.fields())) return std::nullopt;
    TextTable comment(lines.comments().back(), "");
    if (!comment.next() || comment.fields().size() != lines.fields().size()) return std::nullopt;
    return read_csv_header(comment.fields());
}

/// Wavelength, n and perhaps k without names, where their unit is given.
std::optional<CsvHeader> bare_header(const TextTable& lines, const ReadOptions& options) {
    const std::size_t count = lines.fields().size();
    if (!options.unit || count < 2 || count > 3 || !is_row(lines.fields())) return std::nullopt;
    CsvHeader header;
    header.x = 0;
    header.n = 1;
    header.k = count > 2 ? 2 : -1;
    header.spectral.unit = options.unit;
    return header;
}

bool looks_like_csv(std::string_view text) {
    TextTable lines(text.substr(0, 100000), "");
    if (!lines.next()) return false;
    if (read_csv_header(lines.fields())) return true;
    return lines.fields().size() > 2 && header_in_comment(lines);  // two columns are spd's
}

Dataset read_csv(const SourceFile& source, const ReadOptions& options) {
    const std::string file = source.path.string();
    Dataset dataset;
    dataset.format = "csv";
    CsvBlocks parts;
    std::optional<CsvHeader> header;
    std::size_t columns = 0;
    TextTable lines(source.text, file);
    BadRows bad;
    const auto begin_block = [&](CsvHeader next) {
        header = std::move(next);
        columns = lines.fields().size();
        std::optional<Unit> named = header->spectral.unit;
        if (header->spectral.is_wl && !options.unit) named = Unit::micrometre;
        if (!named && !options.unit) {
            lines.refuse(
                fmt::format("the unit of '{}' is not known: name the column with its unit, "
                            "as in wavelength_um or energy_eV",
                            header->x_name));
        }
        const Unit unit = settle_unit(dataset, named, options, Unit::nanometre);
        if (!header->second_of_a_kind.empty()) {
            lines.refuse(fmt::format("a second column of the kind of '{}'; give one of n and of k",
                                     header->second_of_a_kind));
        }
        if (header->n >= 0) parts.n.unit = unit;
        if (header->k >= 0) parts.k.unit = unit;
        for (const std::string& name : header->unused)
            dataset.corrections.push_back(fmt::format("column '{}' ignored", name));
        if (header->is_permittivity)
            dataset.corrections.push_back("n + ik is the root of the permittivity given");
    };
    while (lines.next()) {
        const std::vector<std::string>& fields = lines.fields();
        // A line of names begins a block, the first or another.
        if (const auto names = read_csv_header(fields)) {
            lines.take_names();
            begin_block(*names);
            continue;
        }
        if (!header) {
            auto implied = header_in_comment(lines);
            if (!implied) implied = bare_header(lines, options);
            if (!implied) lines.refuse("no header with a wavelength column and n or k");
            begin_block(*implied);
        }
        bad.try_row(options, [&] { read_row(parts, *header, lines, columns); });
    }
    for (const std::string& comment : lines.comments()) read_provenance_line(dataset, comment);
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
