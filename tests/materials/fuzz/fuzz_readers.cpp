#include "tests/materials/fuzz/fuzz_readers.h"

#include <algorithm>
#include <cstdio>
#include <cstdlib>
#include <string>

#include <miebrdf/database.h>
#include "materials/index/checksum.h"
#include "materials/index/series.h"
#include "materials/index/units.h"
#include "materials/readers/catalogue.h"
#include "materials/readers/file_format.h"

namespace miebrdf::materials::fuzz {
namespace {

void require(bool condition, const char* what) {
    if (condition) return;
    std::fprintf(stderr, "violated: %s\n", what);
    std::abort();
}

Dataset read(const FileFormat& format, std::string_view text) {
    if (format.endings[1] == nullptr) return format.read({"fuzz", std::string(text), ""}, {});
    // One input for two files: the first byte tells which of the halves are there.
    if (text.empty()) return format.read({"fuzz", "", ""}, {});
    const char which = text.front();
    text.remove_prefix(1);
    const std::size_t half =
        text.find('\0') == std::string_view::npos ? text.size() : text.find('\0');
    const std::string_view first = which == 'k' ? "" : text.substr(0, half);
    const std::string_view second =
        which == 'n' ? "" : text.substr(which == 'k' ? 0 : std::min(half + 1, text.size()));
    return format.read({"fuzz", std::string(first), std::string(second)}, {});
}

// csv keeps everything; the others keep n and k bit for bit and wavelengths to rounding, by which
// two of them may meet: then a row is dropped.
void check_round_trip(const Dataset& dataset, const FileFormat& format) {
    const std::string name = format.name;
    std::vector<ExportFile> files;
    try {
        files = export_dataset(dataset, name);
    } catch (const InputError&) {
        return;  // the format cannot express it, and says so
    }
    if (format.endings[1] != nullptr) return;
    const Dataset back = read(format, files.front().text);
    if (name == "csv" || name == "rii") {
        require(back.n.has_value() == dataset.n.has_value(), "n is known as before");
        require(back.k.has_value() == dataset.k.has_value(), "k is known as before");
    }
    if (name == "csv") require(content_sha256(back) == content_sha256(dataset), "csv round trip");
    if (dataset.n && back.n && back.n->y.size() == dataset.n->y.size()) {
        require(back.n->y == dataset.n->y, "n survives a round trip");
    }
}

void check_dataset(const Dataset& dataset) {
    require(dataset.n || dataset.k, "an accepted file gives n or k");
    if (dataset.n) check_series(*dataset.n, 'n');
    if (dataset.k) check_series(*dataset.k, 'k');
    verify(dataset);
    for (const MaterialFormat& format : material_formats()) {
        check_round_trip(dataset, format_named(format.name));
    }
    try {
        const RefractiveIndex index("fuzz", dataset.n, dataset.k);
        for (const double t : {0.0, 0.3, 1.0}) {
            const auto m =
                index.at(index.shortest_nm() + t * (index.longest_nm() - index.shortest_nm()));
            require(m.real() > 0 && m.imag() >= 0, "n > 0 and k >= 0");
        }
    } catch (const InputError&) {  // no common range, or a formula without a real value
    }
}

}  // namespace

void check(std::string_view reader, std::string_view bytes) {
    if (reader == "recognise") {
        const FileFormat* format = recognise(bytes);
        if (format == nullptr) return;
        reader = format->name;
    }
    try {
        if (reader == "wavelength") {
            require(parse_wavelength_nm(bytes) > 0, "wavelengths are positive");
        } else if (reader == "catalogue") {
            read_catalogue(bytes, "fuzz");
        } else {
            check_dataset(read(format_named(reader), bytes));
        }
    } catch (const ImportError&) {
    } catch (const UsageError&) {
        require(reader == "wavelength", "readers refuse with ImportError");
    }
}

}  // namespace miebrdf::materials::fuzz
