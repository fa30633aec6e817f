#include "materials/database/export.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <iterator>
#include <limits>
#include <stdexcept>

#include "materials/database/provenance.h"

namespace miebrdf::materials {
namespace {

[[noreturn]] void refuse(const Dataset& d, Format format, const std::string& reason) {
    throw std::invalid_argument(fmt::format("{}/{} cannot be written as {}: {}", d.material,
                                            d.label, name_of(format), reason));
}

std::string in_unit(const Series& series, std::size_t row, Unit unit) {
    if (series.unit == unit) return fmt::format("{}", series.x[row]);
    return fmt::format("{}", from_nm_exactly(to_nm(series.x[row], series.unit), unit));
}

/// n and k on one grid, k = 0 where that is allowed to stand for unknown.
struct JointTable {
    const Series& n;
    std::vector<double> k;
};

JointTable joint_table(const Dataset& d, Format format, const ExportOptions& options) {
    if (!d.n) refuse(d, format, "n is unknown");
    if (!d.n->tabulated()) refuse(d, format, "n is a formula; only yaml keeps formulas");
    if (!d.k && !options.unknown_k_as_zero) {
        refuse(d, format,
               "k is unknown and the format has no word for it (unknown k is written as 0 with "
               "--unknown-k-zero)");
    }
    if (d.k && (d.k->unit != d.n->unit || d.k->x != d.n->x)) {
        refuse(d, format, "n and k have different grids; csv, yaml and spd can");
    }
    return {*d.n, d.k ? d.k->y : std::vector<double>(d.n->y.size(), 0.0)};
}

std::string remarks(const Dataset& d, std::string_view comment) {
    std::string text;
    for (const std::string& line : provenance_lines(d))
        text += fmt::format("{}{}\n", comment, line);
    return text;
}

int sopra_code(const Dataset& d, Unit unit) {
    switch (unit) {
        case Unit::electronvolt:
            return 1;
        case Unit::micrometre:
            return 2;
        case Unit::per_centimetre:
            return 3;
        case Unit::nanometre:
            return 4;
        default:
            refuse(d, Format::sopra, fmt::format("it has no unit {}", name_of(unit)));
    }
}

std::string sopra(const Dataset& d, const ExportOptions& options) {
    const JointTable table = joint_table(d, Format::sopra, options);
    const std::size_t count = table.n.x.size();
    const auto ascending = [&](std::size_t i) {  // in the unit, as the format wants it
        return is_reciprocal(table.n.unit) ? count - 1 - i : i;
    };
    if (count < 2) refuse(d, Format::sopra, "it needs two rows");
    const double first = table.n.x[ascending(0)];
    const double last = table.n.x[ascending(count - 1)];
    const int intervals = static_cast<int>(count) - 1;
    std::string text =
        fmt::format("{} {} {} {}\r\n", sopra_code(d, table.n.unit), first, last, intervals);
    for (int i = 0; i <= intervals; ++i) {
        const std::size_t row = ascending(static_cast<std::size_t>(i));
        const double expected = i == intervals ? last : first + (last - first) * i / intervals;
        // Decimal steps (0.36, 0.365, ...) are rounded one by one: the reader's grid differs from
        // them by units in the last place, not by a step.
        const double rounding = 4 * std::numeric_limits<double>::epsilon() * std::max(first, last);
        if (!(std::abs(table.n.x[row] - expected) <= rounding)) {
            refuse(d, Format::sopra,
                   fmt::format("its grid is not uniform ({} {} where {} is expected)",
                               table.n.x[row], name_of(table.n.unit), expected));
        }
        fmt::format_to(std::back_inserter(text), "{} {}\r\n", table.n.y[row], table.k[row]);
    }
    return text;
}

std::string tfcalc(const Dataset& d, const ExportOptions& options) {
    const JointTable table = joint_table(d, Format::tfcalc, options);
    std::string text = fmt::format("VERSION*1*\nFORMAT*1*\nPOINTS*{}*\n", table.n.x.size());
    for (std::size_t i = 0; i < table.n.x.size(); ++i) {
        fmt::format_to(std::back_inserter(text), "DATA1*{}*{}*{}*{}*\n", i + 1,
                       in_unit(table.n, i, Unit::nanometre), table.n.y[i], table.k[i]);
    }
    std::string name = d.material + "/" + d.label;
    std::replace(name.begin(), name.end(), '*', ' ');
    return text + fmt::format("COMMENT*{}*\nEOF*\n", name);
}

std::string imd(const Dataset& d, const ExportOptions& options) {
    const JointTable table = joint_table(d, Format::imd, options);
    std::string text = remarks(d, "; ") + "; wavelength (A), n, k\n";
    for (std::size_t i = 0; i < table.n.x.size(); ++i) {
        fmt::format_to(std::back_inserter(text), "{} {} {}\n", in_unit(table.n, i, Unit::angstrom),
                       table.n.y[i], table.k[i]);
    }
    return text;
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

std::string csv(const Dataset& d) {
    if (d.n && !d.n->tabulated())
        refuse(d, Format::csv, "n is a formula; only yaml keeps formulas");
    std::string text = remarks(d, "# ");
    if (d.n && d.k && d.n->unit == d.k->unit && d.n->x == d.k->x) {
        append_csv(text, *d.n, "n", &*d.k);
        return text;
    }
    if (d.n) append_csv(text, *d.n, "n", nullptr);
    if (d.n && d.k) text += '\n';
    if (d.k) append_csv(text, *d.k, "k", nullptr);
    return text;
}

std::vector<ExportFile> spd(const Dataset& d) {
    std::vector<ExportFile> files;
    const auto add = [&](const std::optional<Series>& series, const char* suffix) {
        if (!series) return;
        if (!series->tabulated())
            refuse(d, Format::spd, "n is a formula; only yaml keeps formulas");
        std::string text = remarks(d, "# ");
        for (std::size_t i = 0; i < series->x.size(); ++i) {
            fmt::format_to(std::back_inserter(text), "{} {}\n",
                           in_unit(*series, i, Unit::nanometre), series->y[i]);
        }
        files.push_back({suffix, std::move(text)});
    };
    add(d.n, ".eta.spd");
    add(d.k, ".k.spd");
    return files;
}

std::string literal_block(const std::string& key, const std::string& text) {
    if (text.empty()) return "";
    std::string line = text;
    std::replace(line.begin(), line.end(), '\n', ' ');
    return fmt::format("{}: |\n    {}\n", key, line);
}

std::string yaml_block(const Series& series, const char* type, const Series* second) {
    if (!series.tabulated()) {
        return fmt::format(
            "  - type: formula {}\n    wavelength_range: {} {}\n    coefficients: {}\n",
            series.formula, from_nm_exactly(series.shortest_nm, Unit::micrometre),
            from_nm_exactly(series.longest_nm, Unit::micrometre), fmt::join(series.y, " "));
    }
    std::string text = fmt::format("  - type: {}\n    data: |\n", type);
    for (std::size_t i = 0; i < series.x.size(); ++i) {
        fmt::format_to(std::back_inserter(text), "        {} {}",
                       in_unit(series, i, Unit::micrometre), series.y[i]);
        if (second != nullptr) fmt::format_to(std::back_inserter(text), " {}", second->y[i]);
        text += '\n';
    }
    return text;
}

std::string yaml(const Dataset& d) {
    std::string text = remarks(d, provenance_mark);
    text += literal_block("REFERENCES", d.reference);
    text += literal_block("COMMENTS", d.note);
    if (d.temperature_k || !d.ray.empty()) text += "CONDITIONS:\n";
    if (!d.ray.empty()) text += fmt::format("    direction: {}\n", d.ray);
    if (d.temperature_k) text += fmt::format("    temperature: {}\n", *d.temperature_k);
    text += "DATA:\n";
    if (d.n && d.k && d.n->tabulated() && d.n->unit == d.k->unit && d.n->x == d.k->x) {
        return text + yaml_block(*d.n, "tabulated nk", &*d.k);
    }
    if (d.n) text += yaml_block(*d.n, "tabulated n", nullptr);
    if (d.k) text += yaml_block(*d.k, "tabulated k", nullptr);
    return text;
}

}  // namespace

std::vector<ExportFile> export_dataset(const Dataset& dataset, Format format,
                                       const ExportOptions& options) {
    switch (format) {
        case Format::sopra:
            return {{".nk", sopra(dataset, options)}};
        case Format::tfcalc:
            return {{".MAT", tfcalc(dataset, options)}};
        case Format::imd:
            return {{".nk", imd(dataset, options)}};
        case Format::csv:
            return {{".csv", csv(dataset)}};
        case Format::rii:
            return {{".yml", yaml(dataset)}};
        case Format::spd:
            break;
    }
    return spd(dataset);
}

}  // namespace miebrdf::materials
