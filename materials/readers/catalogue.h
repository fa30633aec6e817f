// The catalogue of refractiveindex.info: shelves of books of pages.
#pragma once

#include <filesystem>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

namespace miebrdf::materials {

struct CataloguePage {
    std::string material;  ///< the book; where a book is a maker's list of glasses, book and page
    std::string title;     ///< of the book, plain text
    std::string label;     ///< the page
    std::string key;       ///< "shelf/book/page"
    std::string data;      ///< path of the data file, as the catalogue has it
    std::string refusal;   ///< why the entry is not to be trusted; empty when it is
};

/// `catalog-nk.yml` (or the older `library.yml`) in the folder or in its `database` folder.
std::optional<std::filesystem::path> find_catalogue(const std::filesystem::path& folder);

/// @throws ImportError  when it is no catalogue
std::vector<CataloguePage> read_catalogue(std::string_view text, const std::string& file);

/// Shelf, book and page of a data file from its path "shelf/book/nk/page.yml", or from a copy named
/// "shelf_book_nk_page.yml"; nothing when it has another form.
std::optional<CataloguePage> page_of_path(const std::filesystem::path& file);

/// The data file of a page; its folder was called `data`, `data-nk` or nothing over the years.
std::filesystem::path page_file(const std::filesystem::path& folder, const CataloguePage& page);

}  // namespace miebrdf::materials
