// The list of formats, what all of them share, and how one file becomes a dataset with its origin.
#include <fmt/format.h>

#include <cctype>
#include <cerrno>
#include <cstring>
#include <fstream>
#include <iterator>
#include <utility>

#include "materials/index/checksum.h"
#include "materials/index/units.h"
#include "materials/readers/file_format.h"
#include "materials/readers/text.h"
#include "materials/readers/text_table.h"

namespace miebrdf::materials {

extern const FileFormat kOpenMaterial, kSopra, kTfcalc, kRefractiveIndexInfo, kCsv, kImd, kSpd,
    kAtrri;

namespace {

// In the order in which contents are tried: the formats that are easiest to tell apart come first.
constexpr const FileFormat* kFormats[] = {
    &kOpenMaterial, &kRefractiveIndexInfo, &kTfcalc, &kImd, &kCsv, &kSopra, &kSpd, &kAtrri,
};

// The format that has pairs of files with this ending, and what both their paths begin with.
struct Pair {
    const FileFormat* format;
    std::filesystem::path base;
};
Pair pair_of(const std::filesystem::path& file) {
    const std::string name = file.string();
    for (const FileFormat* format : kFormats) {
        if (format->endings[1] == nullptr) continue;
        for (const char* ending : format->endings) {
            if (name.size() > std::strlen(ending) && name.ends_with(ending))
                return {format, name.substr(0, name.size() - std::strlen(ending))};
        }
    }
    return {nullptr, file};
}

// The file's name without folder and extension: "GAP.NK" -> "GAP", "Ag.eta.spd" -> "Ag".
std::string source_stem(const std::filesystem::path& file) {
    const std::filesystem::path base = pair_base(file);
    return base == file ? file.stem().string() : base.filename().string();
}

}  // namespace

const FileFormat& format_named(std::string_view name) {
    std::string known;
    for (const FileFormat* format : kFormats) {
        if (name == format->name || (!name.empty() && name == format->other_name)) return *format;
        known += (known.empty() ? "" : ", ") + std::string(format->name);
    }
    throw UsageError(fmt::format("unknown format '{}'; allowed: {}", name, known));
}

const FileFormat* recognise(std::string_view text) {
    for (const FileFormat* format : kFormats) {
        if (format->looks_like(text)) return format;
    }
    return nullptr;
}

std::vector<MaterialFormat> material_formats() {
    std::vector<MaterialFormat> formats;
    for (const FileFormat* f : kFormats) {
        MaterialFormat& format = formats.emplace_back();
        format.name = f->name;
        format.other_name = f->other_name;
        format.title = f->title;
        for (const char* ending : f->endings) {
            if (ending != nullptr) format.endings.emplace_back(ending);
        }
        format.read = f->read != nullptr;
        format.written = f->write != nullptr;
    }
    return formats;
}

SourceFile read_source(const std::filesystem::path& file) {
    SourceFile source{file, {}, {}};
    const Pair pair = pair_of(file);
    const auto read = [&](const std::filesystem::path& path) {
        return pair.format == nullptr || std::filesystem::exists(path) ? read_bytes(path) : "";
    };
    std::string first = file.string(), second;
    if (pair.format != nullptr) {
        first = pair.base.string() + pair.format->endings[0];
        second = read(pair.base.string() + pair.format->endings[1]);
    }
    std::string text = read(first);
    if (pair.format != nullptr && text.empty() && second.empty())
        throw ImportError(file.string(), 0, "is empty");
    source.sha256 = sha256_hex(text + second);
    source.text = text_of(std::move(text), first);
    source.second_text = text_of(std::move(second), file.string());
    return source;
}

std::filesystem::path pair_base(const std::filesystem::path& file) { return pair_of(file).base; }

void fill_origin(Dataset& dataset, const SourceFile& source, const FileFormat& format,
                 const ImportOptions& options) {
    dataset.file = source.path.filename().string();
    dataset.file_sha256 = source.sha256;
    if (!options.source.empty()) dataset.source = options.source;
    if (format.read_path != nullptr) format.read_path(dataset, source.path);
    std::string stem = source_stem(source.path);
    if (format.caseless_names) {
        for (char& c : stem) c = static_cast<char>(std::toupper(static_cast<unsigned char>(c)));
    }
    if (dataset.key.empty()) dataset.key = stem;
    if (!options.label.empty()) dataset.label = options.label;
    if (dataset.label.empty()) {
        dataset.label =
            fmt::format("{}-{}", dataset.source.empty() ? dataset.format : dataset.source, stem);
    }
    if (!options.material.empty()) dataset.material = options.material;
    if (dataset.material.empty()) dataset.material = stem;
    for (std::string* text :
         {&dataset.material, &dataset.title, &dataset.formula, &dataset.label, &dataset.source,
          &dataset.key, &dataset.reference, &dataset.doi, &dataset.licence, &dataset.composition,
          &dataset.note, &dataset.file, &dataset.density_source}) {
        *text = as_utf8(*text);
    }
    for (std::string& correction : dataset.corrections) correction = as_utf8(correction);
}

ReadOptions read_options(const ImportOptions& options) {
    return {.negative_k_tolerance = options.negative_k_tolerance,
            .skip_bad_rows = options.skip_bad_rows,
            .unit = options.unit};
}

ReadFile read_recognised(const std::filesystem::path& file, const ImportOptions& options) {
    const SourceFile source = read_source(file);
    const Pair pair = pair_of(file);
    const FileFormat* format =
        options.format.empty() && pair.format != nullptr ? pair.format
        : options.format.empty() ? recognise(source.text.empty() ? source.second_text : source.text)
                                 : &format_named(options.format);
    // Bare columns become readable when their unit is given.
    const bool is_bare = format == nullptr || (format == &kSpd && pair.format == nullptr);
    if (options.format.empty() && options.unit && is_bare) format = &kCsv;
    if (format == nullptr) {
        std::string known;
        for (const FileFormat* f : kFormats)
            known += (known.empty() ? "" : ", ") + std::string(f->title);
        throw ImportError(
            file.string(), 0,
            fmt::format("format not recognised; known: {} (a format can be given by name)", known));
    }
    ReadFile read{format->read(source, read_options(options)), *format};
    fill_origin(read.dataset, source, *format, options);
    return read;
}

Dataset read_file(const std::filesystem::path& file, const ImportOptions& options) {
    return read_recognised(file, options).dataset;
}

std::vector<ExportFile> export_dataset(const Dataset& dataset, std::string_view format,
                                       const ExportOptions& options) {
    const FileFormat& asked = format_named(format);
    if (asked.write == nullptr) refuse_export(dataset, asked.name, "the format is not written");
    return asked.write(dataset, options);
}

void refuse_export(const Dataset& d, const char* format, const std::string& reason) {
    throw InputError(
        fmt::format("{}/{} cannot be written as {}: {}", d.material, d.label, format, reason));
}

std::string in_unit(const Series& series, std::size_t row, Unit unit) {
    if (series.unit == unit) return fmt::format("{}", series.x[row]);
    return fmt::format("{}", from_nm_exactly(to_nm(series.x[row], series.unit), unit));
}

JointTable joint_table(const Dataset& d, const char* format, const ExportOptions& options) {
    if (!d.n) refuse_export(d, format, "n is unknown");
    if (!d.n->tabulated()) refuse_export(d, format, "n is a formula; only yaml keeps formulas");
    if (!d.k && !options.unknown_k_as_zero) {
        refuse_export(
            d, format,
            "k is unknown and the format has no word for it (unknown_k_as_zero writes 0)");
    }
    if (d.k && (d.k->unit != d.n->unit || d.k->x != d.n->x)) {
        refuse_export(d, format, "n and k have different grids; csv, yaml and spd can");
    }
    return {*d.n, d.k ? d.k->y : std::vector<double>(d.n->y.size(), 0.0)};
}

std::string bare_columns(const JointTable& table, Unit unit) {
    std::string text;
    for (std::size_t i = 0; i < table.n.x.size(); ++i) {
        fmt::format_to(std::back_inserter(text), "{} {} {}\n", in_unit(table.n, i, unit),
                       table.n.y[i], table.k[i]);
    }
    return text;
}

std::string remarks(const Dataset& d, std::string_view comment) {
    std::string text;
    for (const std::string& line : provenance_lines(d))
        text += fmt::format("{}{}\n", comment, line);
    return text;
}

}  // namespace miebrdf::materials
