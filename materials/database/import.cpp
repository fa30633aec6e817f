// Files of optical constants into a database.
#include <fmt/chrono.h>
#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <ctime>
#include <map>
#include <set>

#include <miebrdf/database.h>
#include "materials/index/checksum.h"
#include "materials/readers/catalogue.h"
#include "materials/readers/file_format.h"

namespace miebrdf::materials {
namespace {

namespace fs = std::filesystem;

/// A dataset on its way in, or the reason why not.
struct Candidate {
    std::string file;
    bool required = false;  ///< given by name: refusing it refuses everything
    Dataset dataset;
    std::string refusal;
};

// The name a file suggests may be an alias or differ in case from one that is known.
void settle_material(Dataset& dataset, const Database& known, const FileFormat& format,
                     bool exactly, const std::string& file) {
    std::vector<std::string> found;
    if (format.caseless_names && !exactly) {
        found = known.resolve_normalised(dataset.material);
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
        if (!seen_.insert(pair_base(path).string()).second) return;  // the other half of a pair
        Candidate candidate{path.string(), !may_refuse, {}, {}};
        try {
            ReadFile read = read_recognised(path, options_);
            candidate.dataset = std::move(read.dataset);
            const bool exactly = !options_.material.empty() || read.format.names_material;
            settle_material(candidate.dataset, known_, read.format, exactly, candidate.file);
        } catch (const InputError& error) {
            if (!may_refuse) throw;
            candidate.refusal = error.what();
        }
        candidates.push_back(std::move(candidate));
    }

    void add_catalogue(const fs::path& file) {
        for (const CataloguePage& page : read_catalogue(read_text(file), file.string())) {
            Candidate candidate{page.data, false, {}, page.refusal};
            try {
                if (candidate.refusal.empty())
                    candidate.dataset = page_dataset(file.parent_path(), page);
            } catch (const InputError& error) {
                candidate.refusal = error.what();
            }
            candidates.push_back(std::move(candidate));
        }
    }

    Dataset page_dataset(const fs::path& folder, const CataloguePage& page) const {
        const SourceFile source = read_source(page_file(folder, page));
        const FileFormat& format = format_named("rii");
        Dataset dataset =
            format.read(source, {.negative_k_tolerance = options_.negative_k_tolerance});
        dataset.material = page.material;
        dataset.title = page.title;
        dataset.label = page.label;
        dataset.key = page.key;
        fill_origin(dataset, source, format, {});
        settle_material(dataset, known_, format, true, page.data);
        return dataset;
    }

    const Database& known_;
    const ImportOptions& options_;
    std::set<std::string> seen_;
};

// Why a dataset cannot go where it wants to; empty when it can.
std::string stored_clash(const Database& known, const Dataset& dataset, const std::string& sum,
                         bool replace) {
    if (!known.resolve_exactly(dataset.material)) return "";
    for (const DatasetInfo& d : known.datasets(dataset.material)) {
        if (d.label != dataset.label || d.content_sha256 == sum) continue;
        const bool embedded = d.layer == "embedded";
        if (replace && !embedded) continue;
        return fmt::format("{}/{} is already in {} with other figures; give another label{}",
                           dataset.material, dataset.label,
                           embedded ? "the embedded database" : d.layer,
                           embedded ? "" : " or ask to replace it");
    }
    return "";
}

void refuse_clashes(std::vector<Candidate>& candidates, const Database& known, bool replace) {
    std::map<std::pair<std::string, std::string>, std::string> taken;
    for (Candidate& c : candidates) {
        if (!c.refusal.empty()) continue;
        const std::string sum = content_sha256(c.dataset);
        const auto [first, fresh] =
            taken.emplace(std::pair(c.dataset.material, c.dataset.label), sum);
        std::string reason = stored_clash(known, c.dataset, sum, replace);
        if (first->second != sum) {
            reason = fmt::format("another file gives {}/{} with other figures", c.dataset.material,
                                 c.dataset.label);
        }
        if (reason.empty()) continue;
        if (c.required) throw ImportError(c.file, 0, reason);
        c.refusal = c.file + ": " + reason;
    }
}

std::string utc_now() {
    return fmt::format("{:%Y-%m-%dT%H:%M:%SZ}", fmt::gmtime(std::time(nullptr)));
}

}  // namespace

std::vector<ImportItem> import_files(const fs::path& database, std::span<const fs::path> files,
                                     const ImportOptions& options) {
    const Database known = Database::layered(database);
    Importer importer(known, options);
    for (const fs::path& file : files) importer.add(file);
    refuse_clashes(importer.candidates, known, options.replace);

    std::vector<Dataset> datasets;
    for (const Candidate& c : importer.candidates) {
        if (c.refusal.empty()) datasets.push_back(c.dataset);
    }
    const std::vector<AddOutcome> outcomes =
        DatabaseWriter(database).add(datasets, {.replace = options.replace, .imported = utc_now()});

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
