#include "materials/readers/parse_source.h"

#include <fmt/format.h>

#include <cctype>

#include "materials/database/sha256.h"
#include "materials/readers/catalogue.h"
#include "materials/readers/readers.h"

namespace miebrdf::materials {

Dataset parse_source(Format format, const SourceFile& source, const ImportOptions& options) {
    const std::string name = source.path.string();
    const ReadOptions read{.negative_k_tolerance = options.negative_k_tolerance};
    switch (format) {
        case Format::sopra:
            return read_sopra(source.text, name, read);
        case Format::tfcalc:
            return read_tfcalc(source.text, name, read);
        case Format::rii:
            return read_rii_page(source.text, name, read);
        case Format::csv:
            return read_csv(source.text, name, read);
        case Format::imd:
            return read_imd(source.text, name, read);
        case Format::spd:
            break;
    }
    return read_spd(source.text, source.k_text, spd_base(source.path).string(), read);
}

void fill_origin(Dataset& dataset, const SourceFile& source, const ImportOptions& options) {
    dataset.file = source.path.filename().string();
    dataset.file_sha256 = sha256_hex(source.text + source.k_text);
    if (!options.source.empty()) dataset.source = options.source;
    if (const auto page = page_of_path(source.path); page && dataset.format == "rii-yaml") {
        if (dataset.material.empty()) dataset.material = page->material;
        if (dataset.label.empty()) dataset.label = page->label;
        if (dataset.key.empty()) dataset.key = page->key;
    }
    std::string stem = source_stem(source.path);
    if (dataset.format == "sopra") {  // DOS names: their case means nothing
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
}

const char* name_of(Format format) {
    switch (format) {
        case Format::sopra:
            return "sopra";
        case Format::tfcalc:
            return "tfcalc";
        case Format::rii:
            return "rii";
        case Format::csv:
            return "csv";
        case Format::imd:
            return "imd";
        case Format::spd:
            break;
    }
    return "spd";
}

std::optional<Format> parse_format(std::string_view name) {
    for (const Format format :
         {Format::sopra, Format::tfcalc, Format::rii, Format::csv, Format::imd, Format::spd}) {
        if (name == name_of(format)) return format;
    }
    return std::nullopt;
}

std::optional<Format> recognise(std::string_view text) {
    if (looks_like_rii_page(text)) return Format::rii;
    if (looks_like_tfcalc(text)) return Format::tfcalc;
    if (looks_like_imd(text)) return Format::imd;
    if (looks_like_csv(text)) return Format::csv;
    if (looks_like_sopra(text)) return Format::sopra;
    if (looks_like_spd(text)) return Format::spd;
    return std::nullopt;
}

Dataset read_file(const std::filesystem::path& file, const ImportOptions& options) {
    SourceFile source = read_source(file);
    const std::optional<Format> format =
        options.format ? options.format
                       : recognise(source.text.empty() ? source.k_text : source.text);
    if (!format) {
        throw ImportError(
            file.string(), 0,
            "format not recognised; known: SOPRA, TFCalc, refractiveindex.info YAML, CSV "
            "with a header, IMD/Luxpop, spd (a format can be given by name)");
    }
    Dataset dataset = parse_source(*format, source, options);
    fill_origin(dataset, source, options);
    return dataset;
}

}  // namespace miebrdf::materials
