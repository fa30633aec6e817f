#include "materials/import.h"

#include <fmt/format.h>

#include <algorithm>
#include <cctype>
#include <set>
#include <stdexcept>

#include "materials/readers/catalogue.h"
#include "materials/readers/readers.h"
#include "materials/readers/source_file.h"
#include "materials/sha256.h"

namespace miebrdf::materials {
namespace {

namespace fs = std::filesystem;

/// A dataset on its way in, or the reason why not.
struct Candidate {
    std::string file;
    Dataset dataset;
    std::string refusal;
};

Dataset parse(Format format, const SourceFile& source, const ImportOptions& options) {
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

// The name a file suggests may be an alias or differ in case from one that is known.
void settle_material(Dataset& dataset, const Database& known, bool exactly,
                     const std::string& file) {
    std::vector<std::string> found;
    if (dataset.format == "sopra" && !exactly) {
        found =
            known.resolve_normalised(dataset.material);  // CO.NK is cobalt: its case means nothing
    } else if (const auto exact = known.resolve_exactly(dataset.material)) {
        found = {*exact};
    } else if (!exactly) {
        found = known.resolve(dataset.material);
    }
    if (found.size() > 1) {
        throw ImportError(file, 0,
                          fmt::format("the name '{}' could mean {}: give the material's name",
                                      dataset.material, fmt::join(found, ", ")));
    }
    if (!found.empty()) dataset.material = found.front();
}

class Importer {
  public:
    Importer(const Database& known, const ImportOptions& options)
        : known_(known), options_(options) {}

    void add(const fs::path& path) {
        if (fs::is_directory(path)) {
            const auto catalogue = find_catalogue(path);
            catalogue ? add_catalogue(*catalogue) : add_folder(path);
        } else {
            add_file(path, false);
        }
    }

    std::vector<Candidate> candidates;

  private:
    void add_folder(const fs::path& folder) {
        std::vector<fs::path> files;
        for (const auto& entry : fs::recursive_directory_iterator(folder)) {
            if (entry.is_regular_file()) files.push_back(entry.path());
        }
        std::sort(files.begin(), files.end());
        for (const fs::path& file : files) add_file(file, true);
    }

    void add_file(const fs::path& path, bool may_refuse) {
        if (!seen_.insert(spd_base(path).string()).second) return;  // the other half of a pair
        Candidate candidate{path.string(), {}, {}};
        try {
            candidate.dataset = read_file(path, options_);
            const bool exactly =
                !options_.material.empty() || candidate.dataset.format == "rii-yaml";
            settle_material(candidate.dataset, known_, exactly, candidate.file);
        } catch (const std::runtime_error& error) {
            if (!may_refuse) throw;
            candidate.refusal = error.what();
        }
        candidates.push_back(std::move(candidate));
    }

    void add_catalogue(const fs::path& file) {
        for (const CataloguePage& page : read_catalogue(read_text(file), file.string())) {
            Candidate candidate{page.data, {}, page.refusal};
            try {
                if (candidate.refusal.empty())
                    candidate.dataset = page_dataset(file.parent_path(), page);
            } catch (const std::runtime_error& error) {
                candidate.refusal = error.what();
            }
            candidates.push_back(std::move(candidate));
        }
    }

    Dataset page_dataset(const fs::path& folder, const CataloguePage& page) const {
        const SourceFile source = read_source(page_file(folder, page));
        Dataset dataset = parse(Format::rii, source, options_);
        dataset.material = page.material;
        dataset.title = page.title;
        dataset.label = page.label;
        dataset.key = page.key;
        fill_origin(dataset, source, {});
        settle_material(dataset, known_, true, page.data);
        return dataset;
    }

    const Database& known_;
    const ImportOptions& options_;
    std::set<std::string> seen_;
};

// Two files of one folder may claim the same label with different figures: the second is refused.
void refuse_clashes(std::vector<Candidate>& candidates) {
    std::set<std::pair<std::string, std::string>> taken;
    for (Candidate& c : candidates) {
        if (!c.refusal.empty()) continue;
        if (!taken.emplace(c.dataset.material, c.dataset.label).second) {
            c.refusal = fmt::format("{}: another file gives {}/{} too", c.file, c.dataset.material,
                                    c.dataset.label);
        }
    }
}

}  // namespace

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

Dataset read_file(const fs::path& file, const ImportOptions& options) {
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
    Dataset dataset = parse(*format, source, options);
    fill_origin(dataset, source, options);
    return dataset;
}

std::vector<ImportItem> import_files(const Database& known, DatabaseWriter& writer,
                                     std::span<const fs::path> files,
                                     const ImportOptions& options) {
    Importer importer(known, options);
    for (const fs::path& file : files) importer.add(file);
    refuse_clashes(importer.candidates);

    std::vector<Dataset> datasets;
    for (const Candidate& c : importer.candidates) {
        if (c.refusal.empty()) datasets.push_back(c.dataset);
    }
    const std::vector<AddOutcome> outcomes = writer.add(datasets, {.replace = options.replace});

    std::vector<ImportItem> items;
    std::size_t added = 0;
    for (Candidate& c : importer.candidates) {
        ImportItem item{c.file, {}, {}, c.refusal, {}};
        if (c.refusal.empty()) {
            item.dataset = c.dataset.material + "/" + c.dataset.label;
            item.outcome = outcomes[added++];
            item.corrections = c.dataset.corrections;
        }
        items.push_back(std::move(item));
    }
    return items;
}

}  // namespace miebrdf::materials
