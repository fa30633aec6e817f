#include "materials/readers/catalogue.h"

#include <fmt/format.h>

#include <algorithm>
#include <set>

#include <miebrdf/database.h>
#include "materials/readers/text.h"
#include "materials/readers/yaml_node.h"

namespace miebrdf::materials {
namespace {

namespace fs = std::filesystem;

using Pages = std::vector<CataloguePage>;

// A shelf or book may be empty, and editors have left the key `content` twice, once with nothing
// under it: all that stands under either counts.
std::vector<const YamlNode*> content_of(const YamlNode& node) {
    std::vector<const YamlNode*> content;
    for (std::size_t i = 0; i < node.keys.size(); ++i) {
        if (node.keys[i] != "content") continue;
        for (const YamlNode& item : node.items[i].items) content.push_back(&item);
    }
    return content;
}

// Manufacturers' data sheets: on this shelf a book is a maker and every page another glass.
bool pages_are_materials(const std::string& shelf) { return shelf == "specs"; }

CataloguePage name_page(const std::string& shelf, const std::string& book,
                        const std::string& page) {
    CataloguePage entry;
    entry.label = page;
    entry.key = fmt::format("{}/{}/{}", shelf, book, page);
    entry.material = pages_are_materials(shelf) ? book + " " + page : book;
    return entry;
}

CataloguePage make_page(const std::string& shelf, const YamlNode& book, const YamlNode& page) {
    CataloguePage entry = name_page(shelf, book.text_of("BOOK"), page.text_of("PAGE"));
    entry.data = page.text_of("data");
    entry.title = without_markup(book.text_of("name"));
    if (pages_are_materials(shelf)) entry.title += " " + without_markup(page.text_of("name"));
    return entry;
}

// The shelf of the 3D renderer's materials lists pages of the other shelves once more, under
// "metals" or "glass".
bool repeats_others(const std::string& shelf) { return shelf == "3d"; }

// On the shelf `main` a book is a chemical formula and has a folder of its own there: a page of one
// that points into the folder of another is an error of the catalogue (MgO/Synowicki and
// ZrO2/Synowicki point to a file of As2S3). Pages that point to another shelf, and books of other
// shelves, may do so (BK7/Lane, SCHOTT's `misc`, an alloy listed with its end members).
void check_folder(CataloguePage& page, const std::string& book,
                  const std::set<std::string>& books) {
    const auto parts = split_words(page.data, "/");
    if (!page.key.starts_with("main/") || parts.size() < 3 || parts[0] != "main") return;
    const std::string folder(parts[1]);
    if (folder == book || books.count("main/" + folder) == 0) return;
    page.refusal =
        fmt::format("{}: the catalogue lists a file of {} under {}", page.data, folder, book);
}

/// Which key says twice what an entry is; empty where none does.
std::string key_said_twice(const YamlNode& entry) {
    for (const char* key : {"SHELF", "BOOK", "PAGE", "data"}) {
        if (std::count(entry.keys.begin(), entry.keys.end(), key) > 1) return key;
    }
    return "";
}

void check_page(CataloguePage& page, const std::string& book, const std::set<std::string>& books) {
    if (!page.refusal.empty()) return;
    if (page.label.empty() || book.empty() || page.data.empty()) {
        page.refusal = fmt::format("{}: a page without name or data file", page.key);
    } else if (page.data.find("..") != std::string::npos || page.data.front() == '/') {
        page.refusal =
            fmt::format("{}: the data file '{}' lies outside the database", page.key, page.data);
    } else {
        check_folder(page, book, books);
    }
}

}  // namespace

std::optional<fs::path> find_catalogue(const fs::path& folder) {
    for (const char* name :
         {"catalog-nk.yml", "library.yml", "database/catalog-nk.yml", "database/library.yml"}) {
        if (fs::exists(folder / name)) return folder / name;
    }
    return std::nullopt;
}

Pages read_catalogue(std::string_view text, const std::string& file) {
    const YamlNode root = parse_yaml(text, file);
    if (root.kind != YamlNode::Kind::sequence)
        throw ImportError(file, root.line, "is not a catalogue");
    Pages pages;
    std::vector<std::string> owners;  // the book of each page
    std::set<std::string> books;
    for (const YamlNode& shelf : root.items) {
        if (shelf.find("SHELF") == nullptr) continue;  // a divider
        if (repeats_others(shelf.text_of("SHELF"))) continue;
        for (const YamlNode* book : content_of(shelf)) {
            if (book->find("BOOK") == nullptr) continue;
            books.insert(shelf.text_of("SHELF") + "/" + book->text_of("BOOK"));
            for (const YamlNode* page : content_of(*book)) {
                if (page->find("PAGE") == nullptr) continue;
                pages.push_back(make_page(shelf.text_of("SHELF"), *book, *page));
                owners.push_back(book->text_of("BOOK"));
                for (const YamlNode* entry : {&shelf, book, page}) {
                    const std::string key = key_said_twice(*entry);
                    if (key.empty()) continue;
                    pages.back().refusal = fmt::format("{}: the key '{}' stands twice in line {}",
                                                       pages.back().key, key, entry->line);
                }
            }
        }
    }
    for (std::size_t i = 0; i < pages.size(); ++i) check_page(pages[i], owners[i], books);
    return pages;
}

std::optional<CataloguePage> page_of_path(const fs::path& file) {
    const std::string stem = file.stem().string();
    const fs::path above = file.parent_path();
    if (above.filename() == "nk" && above.parent_path().has_parent_path()) {
        const fs::path book = above.parent_path();
        return name_page(book.parent_path().filename().string(), book.filename().string(), stem);
    }
    const std::size_t mark = stem.find("_nk_");
    const std::size_t shelf_end = stem.find('_');
    if (mark == std::string::npos || mark == 0 || shelf_end >= mark) return std::nullopt;
    return name_page(stem.substr(0, shelf_end), stem.substr(shelf_end + 1, mark - shelf_end - 1),
                     stem.substr(mark + 4));
}

fs::path page_file(const fs::path& folder, const CataloguePage& page) {
    for (const char* data : {"data", "data-nk", ""}) {
        fs::path file = folder / data / page.data;
        if (fs::exists(file)) return file;
    }
    throw ImportError(page.data, 0, "listed in the catalogue, but there is no such file");
}

}  // namespace miebrdf::materials
