#include "tests/materials/fuzz/fuzz_readers.h"

#include <cstdio>
#include <cstdlib>
#include <stdexcept>

#include "materials/database/export.h"
#include "materials/database/provenance.h"
#include "materials/database/verify.h"
#include "materials/index/refractive_index.h"
#include "materials/index/units.h"
#include "materials/readers/catalogue.h"
#include "materials/readers/readers.h"

namespace miebrdf::materials::fuzz {
namespace {

void require(bool condition, const char* what) {
    if (condition) return;
    std::fprintf(stderr, "violated: %s\n", what);
    std::abort();
}

Dataset read(Format format, std::string_view text) {
    switch (format) {
        case Format::sopra:
            return read_sopra(text, "fuzz");
        case Format::tfcalc:
            return read_tfcalc(text, "fuzz");
        case Format::rii:
            return read_rii_page(text, "fuzz");
        case Format::csv:
            return read_csv(text, "fuzz");
        case Format::imd:
            return read_imd(text, "fuzz");
        case Format::spd:
            break;
    }
    // One input for two files: the first byte tells which of the halves are there.
    if (text.empty()) return read_spd("", "", "fuzz");
    const char which = text.front();
    text.remove_prefix(1);
    const std::size_t half =
        text.find('\0') == std::string_view::npos ? text.size() : text.find('\0');
    return read_spd(
        which == 'k' ? "" : text.substr(0, half),
        which == 'n' ? "" : text.substr(which == 'k' ? 0 : std::min(half + 1, text.size())),
        "fuzz");
}

// csv keeps everything; the others keep n and k bit for bit and wavelengths to rounding, by which
// two of them may meet: then a row is dropped.
void check_round_trip(const Dataset& dataset, Format format) {
    std::vector<ExportFile> files;
    try {
        files = export_dataset(dataset, format);
    } catch (const std::invalid_argument&) {
        return;  // the format cannot express it, and says so
    }
    if (format == Format::spd) return;
    const Dataset back = read(format, files.front().text);
    if (format == Format::csv || format == Format::rii) {
        require(back.n.has_value() == dataset.n.has_value(), "n is known as before");
        require(back.k.has_value() == dataset.k.has_value(), "k is known as before");
    }
    if (format == Format::csv)
        require(content_sha256(back) == content_sha256(dataset), "csv round trip");
    if (dataset.n && back.n && back.n->y.size() == dataset.n->y.size()) {
        require(back.n->y == dataset.n->y, "n survives a round trip");
    }
}

void check_dataset(const Dataset& dataset) {
    require(dataset.n || dataset.k, "an accepted file gives n or k");
    if (dataset.n) check_series(*dataset.n, 'n');
    if (dataset.k) check_series(*dataset.k, 'k');
    verify(dataset);
    for (const Format format :
         {Format::sopra, Format::tfcalc, Format::rii, Format::csv, Format::imd, Format::spd}) {
        check_round_trip(dataset, format);
    }
    try {
        const RefractiveIndex index("fuzz", dataset.n, dataset.k);
        for (const double t : {0.0, 0.3, 1.0}) {
            const auto m =
                index.at(index.shortest_nm() + t * (index.longest_nm() - index.shortest_nm()));
            require(m.real() > 0 && m.imag() >= 0, "n > 0 and k >= 0");
        }
    } catch (const std::logic_error&) {  // no common range, or a formula without a real value
    }
}

}  // namespace

void check(std::string_view reader, std::string_view bytes) {
    if (reader == "recognise") {
        const auto format = recognise(bytes);
        if (!format) return;
        reader = name_of(*format);
    }
    try {
        if (reader == "wavelength") {
            require(parse_wavelength_nm(bytes) > 0, "wavelengths are positive");
        } else if (reader == "catalogue") {
            read_catalogue(bytes, "fuzz");
        } else {
            check_dataset(read(parse_format(reader).value(), bytes));
        }
    } catch (const ImportError&) {
    } catch (const std::invalid_argument&) {
        require(reader == "wavelength", "readers refuse with ImportError");
    }
}

}  // namespace miebrdf::materials::fuzz
