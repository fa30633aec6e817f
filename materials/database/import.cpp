// Files of optical constants into a database.
#include <fmt/chrono.h>
#include <fmt/format.h>

#include <algorithm>
#include <ctime>
#include <map>
#include <set>

#include <miebrdf/database.h>
#include "materials/index/checksum.h"
#include "materials/readers/catalogue.h"
#include "materials/readers/file_format.h"
#include "materials/readers/text.h"
#include "materials/readers/text_table.h"

namespace miebrdf::materials {
namespace {

namespace fs = std::filesystem;

/// A dataset to be imported, or the reason why it is refused.
struct Candidate {
    std::string file;
    bool required = false;  ///< given by name: refusing it refuses everything
    Dataset dataset;
    std::string refusal;
};

// "main/GaP/Bond" -> "main/GaP"; nothing without two parts before the last.
std::string book_of(const std::string& key) {
    const std::size_t end = key.rfind('/');
    return end == std::string::npos || key.find('/') == end ? "" : key.substr(0, end);
}

// A name that depends on the file and on what every build carries, never on what was imported
// before. Names of collections are not compared with others: CO_2 is cobalt at SOPRA.
void settle_material(Dataset& dataset, const Database& embedded, const Database& known,
                     const ImportOptions& options) {
    if (!options.material.empty()) {
        dataset.material = known.resolve_exactly(options.material).value_or(options.material);
        return;
    }
    for (const std::string& key : {dataset.key, book_of(dataset.key)}) {
        if (const auto material = embedded.collected_material(dataset.source, key)) {
            dataset.material = *material;
            return;
        }
    }
    const auto taken = embedded.resolve_exactly(dataset.material);
    if (taken && dataset.source == "refractiveindex.info") {
        // A book that the table does not list is not taken for an embedded material of the same
        // name.
        const std::string shelf = dataset.key.substr(0, dataset.key.find('/'));
        dataset.material += shelf.empty() ? " (refractiveindex.info)" : " (" + shelf + ")";
    } else if (taken) {
        dataset.material = *taken;
    }
}

// A printable form of a file name that is not UTF-8, which can be neither stored nor shown as it
// is.
std::string readable(const fs::path& path) {
    std::string name = path.string();
    if (is_utf8(name)) return name;
    std::string shown;
    for (const char c : name) {
        const auto byte = static_cast<unsigned char>(c);
        shown += byte < 0x80 ? std::string(1, c) : fmt::format("\\x{:02x}", byte);
    }
    return shown;
}

// Why a folder's entry is left alone; empty when it is an ordinary file.
std::string not_to_be_read(const fs::directory_entry& entry, const fs::path& folder) {
    std::error_code error;
    if (!is_utf8(entry.path().string())) return "its name is not UTF-8";
    if (entry.is_symlink(error)) {
        const fs::path target = fs::canonical(entry.path(), error);
        if (error) return "a link that leads nowhere";
        const auto [inside, rest] =
            std::mismatch(folder.begin(), folder.end(), target.begin(), target.end());
        if (inside != folder.end()) return "a link out of the folder";
        if (fs::is_directory(target, error)) return "a link to a folder";
    }
    return entry.is_regular_file(error) ? "" : "no ordinary file";
}

class Importer {
  public:
    Importer(const Database& known, const ImportOptions& options)
        : known_(known), options_(options) {}

    void add(const fs::path& path) {
        if (fs::is_directory(path)) {
            const auto catalogue = find_catalogue(path);
            catalogue ? add_catalogue(*catalogue) : add_folder(path);
        } else if (!fs::is_regular_file(path)) {
            throw ImportError(readable(path), 0, "no ordinary file");
        } else {
            add_file(path, false);
        }
    }

    std::vector<Candidate> candidates;

  private:
    void add_folder(const fs::path& folder) {
        const fs::path whole = fs::canonical(folder);
        std::vector<fs::path> files;
        std::error_code error;
        fs::recursive_directory_iterator entry(
            folder, fs::directory_options::skip_permission_denied, error);
        for (; !error && entry != fs::recursive_directory_iterator(); entry.increment(error)) {
            std::error_code ignored;
            if (!entry->is_symlink(ignored) && entry->is_directory(ignored)) continue;
            const std::string reason = not_to_be_read(*entry, whole);
            if (reason.empty()) {
                files.push_back(entry->path());
            } else {
                const std::string name = readable(entry->path());
                candidates.push_back({name, false, {}, fmt::format("{}: {}", name, reason)});
            }
        }
        if (error) throw ImportError(readable(folder), 0, error.message());
        std::sort(files.begin(), files.end());
        for (const fs::path& file : files) add_file(file, true);
    }

    void add_file(const fs::path& path, bool may_refuse) {
        if (!seen_.insert(pair_base(path).string()).second) return;  // the other half of a pair
        if (!is_utf8(path.string())) {
            throw ImportError(readable(path), 0, "its name is not UTF-8: rename it");
        }
        Candidate candidate{path.string(), !may_refuse, {}, {}};
        try {
            ReadFile read = read_recognised(path, options_);
            candidate.dataset = std::move(read.dataset);
            settle_material(candidate.dataset, embedded_, known_, options_);
        } catch (const InputError& error) {
            if (!may_refuse) throw;
            candidate.refusal = error.what();
        }
        candidates.push_back(std::move(candidate));
    }

    void add_catalogue(const fs::path& file) {
        for (const CataloguePage& page :
             read_catalogue(text_of(read_bytes(file), file.string()), file.string())) {
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
        Dataset dataset = format.read(source, read_options(options_));
        dataset.material = page.material;
        dataset.title = page.title;
        dataset.label = page.label;
        dataset.key = page.key;
        fill_origin(dataset, source, format, {});
        settle_material(dataset, embedded_, known_, {});
        return dataset;
    }

    const Database embedded_ = Database::embedded();
    const Database& known_;
    const ImportOptions& options_;
    std::set<std::string> seen_;
};

// Why a dataset cannot be stored under its label; empty when it can.
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

bool is_embedded(const Database& known, const Dataset& dataset) {
    if (!known.resolve_exactly(dataset.material)) return false;
    const std::string sum = content_sha256(dataset);
    for (const DatasetInfo& d : known.datasets(dataset.material)) {
        if (d.layer == "embedded" && d.label == dataset.label && d.content_sha256 == sum)
            return true;
    }
    return false;
}

bool covers_550_nm(const Dataset& dataset) {
    const auto covers = [](const Series& series) {
        return series.shortest_nm <= 550 && 550 <= series.longest_nm;
    };
    return dataset.n && covers(*dataset.n) && (!dataset.k || covers(*dataset.k));
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

    // The first dataset of a new material becomes its default, so one that covers 550 nm is added
    // first, if there is one.
    std::vector<Candidate*> order;
    for (Candidate& c : importer.candidates) {
        if (c.refusal.empty() && !is_embedded(known, c.dataset)) order.push_back(&c);
    }
    std::stable_partition(order.begin(), order.end(),
                          [](const Candidate* c) { return covers_550_nm(c->dataset); });
    std::vector<Dataset> datasets;
    datasets.reserve(order.size());
    for (const Candidate* c : order) datasets.push_back(c->dataset);
    std::vector<AddOutcome> outcomes;
    if (!datasets.empty() || fs::exists(database)) {
        outcomes = DatabaseWriter(database).add(
            datasets, {.replace = options.replace, .imported = utc_now()});
    }
    std::map<const Candidate*, AddOutcome> outcome_of;
    for (std::size_t i = 0; i < order.size(); ++i) outcome_of[order[i]] = outcomes[i];

    std::vector<ImportItem> items;
    for (Candidate& c : importer.candidates) {
        ImportItem item{c.file, {}, {}, c.refusal, {}};
        if (c.refusal.empty()) {
            item.dataset = c.dataset.material + "/" + c.dataset.label;
            const auto added = outcome_of.find(&c);
            item.outcome = added == outcome_of.end() ? AddOutcome::unchanged : added->second;
            item.corrections = c.dataset.corrections;
        }
        items.push_back(std::move(item));
    }
    return items;
}

}  // namespace miebrdf::materials
