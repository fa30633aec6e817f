// npz by the ZIP and NPY specifications, exr by the OpenEXR file layout: neither NumPy nor OpenEXR.
#include <zlib.h>

#include <algorithm>
#include <map>
#include <sstream>

#include "tests/support/outside/bytes.h"
#include "tests/support/outside/outside_file.h"

namespace miebrdf::support {
namespace {

[[noreturn]] void refuse(const std::string& reason) { throw std::runtime_error(reason); }

/// Version 1.0 of little-endian doubles in C order.
std::vector<double> npy_doubles(const std::string& npy) {
    if (npy.substr(0, 8) != std::string("\x93NUMPY\x01\x00", 8)) refuse("no .npy 1.0");
    const auto length = number_at<std::uint16_t>(npy, 8);
    const std::string header = npy.substr(10, length);
    if (header.find("'descr': '<f8'") == header.npos) return {};
    if (header.find("'fortran_order': False") == header.npos) refuse("not in C order");
    std::istringstream shape(header.substr(header.find('(') + 1));
    std::size_t count = 1;
    for (std::size_t extent; shape >> extent; shape.ignore(2)) count *= extent;
    if (npy.size() != 10u + length + 8 * count) refuse(".npy of another size than its shape");
    return numbers_at<double>(npy, 10u + length, count);
}

/// Readers of ZIP go by the central directory at the end.
std::map<std::string, std::string> stored_members(const std::string& zip) {
    const std::size_t end = zip.rfind("PK\x05\x06");
    if (end == zip.npos) refuse("no end of central directory");
    std::map<std::string, std::string> members;
    std::size_t at = number_at<std::uint32_t>(zip, end + 16);
    for (auto left = number_at<std::uint16_t>(zip, end + 10); left > 0; --left) {
        if (zip.substr(at, 4) != "PK\x01\x02") refuse("no directory entry");
        if (number_at<std::uint16_t>(zip, at + 10) != 0) refuse("member is compressed");
        const auto crc = number_at<std::uint32_t>(zip, at + 16);
        const auto size = number_at<std::uint32_t>(zip, at + 24);
        const auto name = number_at<std::uint16_t>(zip, at + 28);
        const std::size_t local = number_at<std::uint32_t>(zip, at + 42);
        const std::size_t data = local + 30u + number_at<std::uint16_t>(zip, local + 26) +
                                 number_at<std::uint16_t>(zip, local + 28);
        const std::string content = zip.substr(data, size);
        if (crc32(0, reinterpret_cast<const Bytef*>(content.data()), size) != crc)
            refuse("CRC differs");
        members[zip.substr(at + 46, name)] = content;
        at += 46u + name + number_at<std::uint16_t>(zip, at + 30) +
              number_at<std::uint16_t>(zip, at + 32);
    }
    return members;
}

std::map<std::string, std::string> exr_attributes(const std::string& exr, std::size_t& at) {
    std::map<std::string, std::string> attributes;
    const auto word = [&] {
        const std::string text(exr.c_str() + at);
        at += text.size() + 1;
        return text;
    };
    for (std::string name = word(); !name.empty(); name = word()) {
        word();  // its type
        const auto size = number_at<std::uint32_t>(exr, at);
        attributes[name] = exr.substr(at + 4, size);
        at += 4u + size;
    }
    return attributes;
}

std::vector<std::string> channel_names(const std::string& list) {
    std::vector<std::string> names;
    for (std::size_t at = 0; list[at] != 0; at += names.back().size() + 17) {
        names.emplace_back(list.c_str() + at);
        if (number_at<std::int32_t>(list, at + names.back().size() + 1) != 2) refuse("not FLOAT");
    }
    return names;
}

/// ZIP compression: deflated, each byte the difference to the one before (+ 128), and the two
/// halves hold the bytes of even and odd places.
std::string unzipped(const std::string& chunk, std::size_t size) {
    if (chunk.size() == size) return chunk;
    std::string flat(size, '\0'), result(size, '\0');
    uLongf length = size;
    if (uncompress(reinterpret_cast<Bytef*>(flat.data()), &length,
                   reinterpret_cast<const Bytef*>(chunk.data()), chunk.size()) != Z_OK ||
        length != size) {
        refuse("deflated data are damaged");
    }
    for (std::size_t i = 1; i < size; ++i)
        flat[i] = static_cast<char>(static_cast<unsigned char>(flat[i - 1]) +
                                    static_cast<unsigned char>(flat[i]) - 128);
    for (std::size_t i = 0; i < size; ++i)
        result[i] = flat[i % 2 == 0 ? i / 2 : (size + 1) / 2 + i / 2];
    return result;
}

std::vector<double> float_list(const std::string& attribute) {
    const auto floats = numbers_at<float>(attribute, 0, attribute.size() / 4);
    return {floats.begin(), floats.end()};
}

}  // namespace

OutsideTable npz_table(const std::string& bytes) {
    auto members = stored_members(bytes);
    return {npy_doubles(members.at("wavelength_nm.npy")), npy_doubles(members.at("mu_in.npy")),
            npy_doubles(members.at("mu_out.npy")), npy_doubles(members.at("azimuth_deg.npy")),
            npy_doubles(members.at("brdf.npy"))};
}

OutsideTable exr_table(const std::string& bytes) {
    if (number_at<std::uint32_t>(bytes, 0) != 20000630 || bytes[4] != 2) refuse("no EXR 2");
    std::size_t at = 8;
    auto attributes = exr_attributes(bytes, at);
    if (attributes.at("compression")[0] != 3) refuse("not ZIP in blocks of 16 lines");
    const auto window = numbers_at<std::int32_t>(attributes.at("dataWindow"), 0, 4);
    const auto width = static_cast<std::size_t>(window[2] + 1);
    const auto height = static_cast<std::size_t>(window[3] + 1);
    const std::vector<std::string> names = channel_names(attributes.at("channels"));
    OutsideTable table{{},
                       float_list(attributes.at("mu_in")),
                       float_list(attributes.at("mu_out")),
                       float_list(attributes.at("azimuth_deg")),
                       {}};
    // Channels T are reflectances: pi times the BRDF, as the file says.
    const double factor = number_at<double>(attributes.at("brdf_factor"), 0);
    std::map<double, std::vector<double>> planes;
    for (std::size_t block = 0; block < (height + 15) / 16; ++block) {
        const std::size_t chunk = number_at<std::uint64_t>(bytes, at + 8 * block);
        const auto first = static_cast<std::size_t>(number_at<std::int32_t>(bytes, chunk));
        const auto packed = number_at<std::uint32_t>(bytes, chunk + 4);
        const std::size_t lines = std::min<std::size_t>(16, height - first);
        const std::string data =
            unzipped(bytes.substr(chunk + 8, packed), 4 * lines * width * names.size());
        for (std::size_t line = 0; line < lines; ++line) {
            for (std::size_t c = 0; c < names.size(); ++c) {
                if (names[c].rfind("T.", 0) != 0) continue;
                std::string number = names[c].substr(2, names[c].size() - 4);
                std::replace(number.begin(), number.end(), ',', '.');
                auto& plane = planes[std::stod(number)];
                const auto row =
                    numbers_at<float>(data, 4 * width * (line * names.size() + c), width);
                plane.insert(plane.end(), row.begin(), row.end());
            }
        }
    }
    for (const auto& [wavelength, plane] : planes) {
        table.wavelength_nm.push_back(wavelength);
        for (const double value : plane) table.values.push_back(value / factor);
    }
    return table;
}

}  // namespace miebrdf::support
