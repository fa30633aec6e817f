// NumPy archives of ours, read without trusting them.
#include <fmt/format.h>

#include <charconv>
#include <memory>

#include "pipeline/formats/common/byte_reader.h"
#include "pipeline/formats/common/grid_file.h"
#include "pipeline/formats/table/late_zip.h"
#include "pipeline/formats/table/npz.h"

namespace miebrdf {
namespace {

/// The text between `before` and `after` of a .npy header's Python dict.
std::string_view between(std::string_view text, std::string_view before, std::string_view after) {
    const std::size_t start = text.find(before);
    if (start == text.npos) throw InputError(fmt::format("npz: array header without {}", before));
    const std::size_t first = start + before.size();
    const std::size_t end = text.find(after, first);
    if (end == text.npos) throw InputError("npz: array header is cut off");
    return text.substr(first, end - first);
}

std::vector<std::size_t> parse_shape(std::string_view text) {
    std::vector<std::size_t> shape;
    const char* next = text.data();
    const char* const end = text.data() + text.size();
    while (next < end) {
        if (*next == ' ' || *next == ',') {
            ++next;
            continue;
        }
        std::size_t extent = 0;
        const auto [after, error] = std::from_chars(next, end, extent);
        if (error != std::errc())
            throw InputError(fmt::format("npz: shape ({}) is no list of numbers", text));
        shape.push_back(extent);
        next = after;
    }
    return shape;
}

NpyArray parse_npy(std::string_view content) {
    if (!content.starts_with("\x93NUMPY")) throw InputError("npz: member is no .npy array");
    ByteReader bytes(content);
    bytes.take(6);
    const auto major = bytes.number<std::uint8_t>();
    bytes.number<std::uint8_t>();
    const std::uint32_t length =
        major == 1 ? bytes.number<std::uint16_t>() : bytes.number<std::uint32_t>();
    const std::string_view header = bytes.take(length);
    if (between(header, "'fortran_order':", ",").find("True") != header.npos) {
        throw InputError("npz: Fortran order is not read");
    }
    NpyArray array;
    array.shape = parse_shape(between(header, "'shape': (", ")"));
    std::uint64_t count = 1;
    for (const std::size_t extent : array.shape) {
        if (extent != 0 && count > content.size() / extent)
            throw InputError("npz: array is larger than the file");
        count *= extent;
    }
    const std::string_view type = between(header, "'descr': '", "'");
    if (type == "<f8") {
        array.values = bytes.reals<double>(count);
    } else if (type == "<f4") {
        const std::vector<float> values = bytes.reals<float>(count);
        array.values.assign(values.begin(), values.end());
    } else if (type == "|u1") {
        for (const char c : bytes.take(count))
            array.values.push_back(static_cast<unsigned char>(c));
        array.is_bytes = true;
    } else {
        throw InputError(fmt::format("npz: type '{}' is not read; known: <f8, <f4, |u1", type));
    }
    return array;
}

std::string read_member(zip_t* archive, zip_uint64_t index, std::size_t largest,
                        std::string& name) {
    zip_stat_t stat;
    zip_stat_init(&stat);
    if (zip_stat_index(archive, index, 0, &stat) != 0)
        throw InputError(fmt::format("npz: {}", zip_strerror(archive)));
    name = (stat.valid & ZIP_STAT_NAME) != 0 ? stat.name : "";
    if (stat.comp_method != ZIP_CM_STORE || stat.size > largest) {
        throw InputError(fmt::format(
            "npz: member '{}' is compressed or damaged; write it with numpy.savez", name));
    }
    const auto close = [](zip_file_t* opened) { zip_fclose(opened); };
    const std::unique_ptr<zip_file_t, decltype(close)> file(zip_fopen_index(archive, index, 0),
                                                            close);
    if (!file) throw InputError(fmt::format("npz: member '{}': {}", name, zip_strerror(archive)));
    std::string content(stat.size, '\0');
    if (zip_fread(file.get(), content.data(), content.size()) !=
        static_cast<zip_int64_t>(content.size())) {
        throw InputError(fmt::format("npz: member '{}' cannot be read", name));
    }
    return content;
}

NpyArray take(std::map<std::string, NpyArray>& arrays, const std::string& name) {
    const auto found = arrays.find(name);
    if (found == arrays.end()) throw InputError(fmt::format("npz: no array '{}'", name));
    return std::move(found->second);
}

}  // namespace

std::map<std::string, NpyArray> read_npz_arrays(std::string_view content) {
    zip_error_t error;
    zip_error_init(&error);
    zip_source_t* source = zip_source_buffer_create(content.data(), content.size(), 0, &error);
    if (source == nullptr) throw InputError("npz: not enough memory");
    zip_t* opened = zip_open_from_source(source, ZIP_RDONLY | ZIP_CHECKCONS, &error);
    if (opened == nullptr) {
        const std::string reason = zip_error_strerror(&error);
        zip_source_free(source);
        zip_error_fini(&error);
        throw InputError("npz: " + reason);
    }
    const auto discard = [](zip_t* unwanted) { zip_discard(unwanted); };
    const std::unique_ptr<zip_t, decltype(discard)> archive(opened, discard);
    std::map<std::string, NpyArray> arrays;
    std::size_t budget = content.size();  // stored members cannot be larger together
    const zip_int64_t count = zip_get_num_entries(archive.get(), 0);
    for (zip_int64_t i = 0; i < count; ++i) {
        std::string name;
        const std::string member =
            read_member(archive.get(), static_cast<zip_uint64_t>(i), budget, name);
        budget -= member.size();
        if (name.ends_with(".npy")) arrays[name.substr(0, name.size() - 4)] = parse_npy(member);
    }
    return arrays;
}

namespace {

Recognised recognise_npz(std::string_view content) {
    return content.starts_with("PK\x03\x04") ? Recognised::by_first_bytes : Recognised::no;
}

std::unique_ptr<BrdfFile> read_npz(std::string content) {
    auto arrays = read_npz_arrays(content);
    NpyArray brdf = take(arrays, "brdf");
    GridTable table;
    table.format = "npz";
    table.wavelength_nm = take(arrays, "wavelength_nm").values;
    table.in = take(arrays, "mu_in").values;
    table.out = take(arrays, "mu_out").values;
    table.azimuth_deg = take(arrays, "azimuth_deg").values;
    const std::vector<std::size_t> expected = {table.wavelength_nm.size(), table.in.size(),
                                               table.out.size(), table.azimuth_deg.size()};
    if (brdf.shape != expected) throw InputError("npz: the shape of 'brdf' does not fit its axes");
    table.set_values(std::move(brdf.values));
    return make_grid_file(std::move(table));
}

}  // namespace

FormatReader npz_reader() { return {recognise_npz, read_npz}; }

}  // namespace miebrdf
