#include "pipeline/formats/readers/scatfun_tables.h"

#include <fmt/format.h>

#include <string>

#include <miebrdf/error.h>

namespace miebrdf::exports {
namespace {

[[noreturn]] void refuse(const std::string& reason) { throw InputError("pbrt: " + reason); }

std::uint32_t expect(ByteReader& bytes, const char* field, std::uint32_t lowest,
                     std::uint32_t highest) {
    const auto value = bytes.number<std::uint32_t>();
    if (value < lowest || value > highest) {
        refuse(fmt::format("{} is {}; allowed: {} to {}", field, value, lowest, highest));
    }
    return value;
}

void validate(const ScatfunTables& tables) {
    for (std::size_t i = 0; i < tables.nodes.size(); ++i) {
        const float previous = i == 0 ? -1.0f : tables.nodes[i - 1];
        if (!(tables.nodes[i] >= previous && tables.nodes[i] <= 1.0f)) {
            refuse(fmt::format("cosine nodes are not ascending in [-1, 1] at {}", i));
        }
    }
    const std::uint64_t available = tables.coefficients.size();
    for (const ScatfunSeries& series : tables.series) {
        if (series.length > tables.longest ||
            series.offset + std::uint64_t{series.length} * tables.channels > available) {
            refuse(
                fmt::format("a series of {} terms at {} does not fit {} coefficients (longest {})",
                            series.length, series.offset, available, tables.longest));
        }
    }
}

}  // namespace

ScatfunTables read_scatfun_tables(std::string_view content) {
    ByteReader bytes(content);
    bytes.take(kScatfunMagic.size());
    expect(bytes, "flags", 1, 1);
    ScatfunTables tables;
    const std::uint64_t n = expect(bytes, "nodes", 4, 65536);
    const std::uint64_t coefficients = bytes.number<std::uint32_t>();
    tables.longest = bytes.number<std::uint32_t>();
    tables.channels = bytes.number<std::uint32_t>();
    if (tables.channels != 1 && tables.channels != 3) {
        refuse(fmt::format("{} channels; allowed: 1 or 3", tables.channels));
    }
    expect(bytes, "bases", 1, 1);
    const auto metadata = bytes.number<std::uint32_t>();
    expect(bytes, "parameters", 0, 0);
    expect(bytes, "parameter values", 0, 0);
    bytes.take(20);  // eta (of transmission), two roughnesses, two unused
    tables.nodes = bytes.reals<float>(n);
    tables.cdf = bytes.view<float>(n * n);
    if (bytes.remaining() / 8 < n * n) refuse("the file ends in the table of series");
    tables.series.resize(n * n);
    for (ScatfunSeries& series : tables.series) {
        series.offset = bytes.number<std::uint32_t>();
        series.length = bytes.number<std::uint32_t>();
    }
    tables.coefficients = bytes.view<float>(coefficients);
    if (bytes.remaining() != metadata) {  // layerlab refuses such files too
        refuse(fmt::format("{} bytes of metadata announced, {} left", metadata, bytes.remaining()));
    }
    validate(tables);
    return tables;
}

}  // namespace miebrdf::exports
