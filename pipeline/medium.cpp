#include "pipeline/medium.h"

#include <fmt/format.h>

#include "pipeline/error.h"
#include "pipeline/moments_file.h"
#include "pipeline/number_list.h"

namespace miebrdf {
namespace {

/// The numbers after the colon of `kind:a,b`, exactly `count` of them.
std::vector<double> parameters(const std::string& text, const std::string& values,
                               std::size_t count, const std::string& form) {
    const std::vector<std::string> parts = split_list(values);
    if (parts.size() != count) {
        throw UsageError(fmt::format("medium '{}': write {}", text, form));
    }
    std::vector<double> numbers;
    numbers.reserve(parts.size());
    for (const std::string& part : parts) {
        numbers.push_back(parse_number(part, fmt::format("medium '{}'", text)));
    }
    return numbers;
}

double checked_albedo(const std::string& text, double albedo) {
    if (!(albedo >= 0.0 && albedo <= 1.0)) {
        throw UsageError(
            fmt::format("medium '{}': single-scattering albedo {} is out of range; "
                        "allowed: [0, 1]",
                        text, albedo));
    }
    return albedo;
}

Medium parse_henyey_greenstein(const std::string& text, const std::string& values) {
    const auto numbers = parameters(text, values, 2, "hg:ALBEDO,G, e.g. hg:0.9,0.7");
    if (!(numbers[1] > -1.0 && numbers[1] < 1.0)) {
        throw UsageError(fmt::format("medium '{}': asymmetry {} is out of range; allowed: (-1, 1)",
                                     text, numbers[1]));
    }
    return HenyeyGreensteinMedium{checked_albedo(text, numbers[0]), numbers[1]};
}

Medium parse_index(const std::string& text, const std::string& values) {
    const auto numbers = parameters(text, values, 2, "index:N,K, e.g. index:1.5,0.01");
    if (!(numbers[0] > 0.0 && numbers[1] >= 0.0)) {
        throw UsageError(
            fmt::format("medium '{}': refractive index {} + {}i is out of range; "
                        "allowed: n > 0, k >= 0",
                        text, numbers[0], numbers[1]));
    }
    return IndexMedium{{numbers[0], numbers[1]}};
}

}  // namespace

Medium parse_medium(const std::string& text) {
    const std::size_t colon = text.find(':');
    const std::string kind = text.substr(0, colon);
    const std::string values = colon == std::string::npos ? "" : text.substr(colon + 1);
    if (text.empty()) {
        throw UsageError("an empty medium; write a material's name, e.g. TiO2, or hg:0.9,0.7");
    }
    if (colon == std::string::npos) return DatabaseMedium{text};
    if (kind == "index") return parse_index(text, values);
    if (kind == "hg") return parse_henyey_greenstein(text, values);
    if (kind == "isotropic") {
        const auto numbers = parameters(text, values, 1, "isotropic:ALBEDO, e.g. isotropic:0.9");
        return IsotropicMedium{checked_albedo(text, numbers[0])};
    }
    if (kind == "rayleigh") {
        const auto numbers = parameters(text, values, 1, "rayleigh:ALBEDO, e.g. rayleigh:0.9");
        return RayleighMedium{checked_albedo(text, numbers[0])};
    }
    if (kind == "moments") {
        MomentsFile file = read_moments_file(values);
        return MomentsMedium{values, file.single_scattering_albedo, std::move(file.chi)};
    }
    return DatabaseMedium{text};  // source:KEY
}

std::string describe(const Medium& medium) {
    struct Describer {
        std::string operator()(const DatabaseMedium& m) const { return m.name; }
        std::string operator()(const IndexMedium& m) const {
            return fmt::format("index:{},{}", m.refractive_index.real(), m.refractive_index.imag());
        }
        std::string operator()(const IsotropicMedium& m) const {
            return fmt::format("isotropic:{}", m.single_scattering_albedo);
        }
        std::string operator()(const RayleighMedium& m) const {
            return fmt::format("rayleigh:{}", m.single_scattering_albedo);
        }
        std::string operator()(const HenyeyGreensteinMedium& m) const {
            return fmt::format("hg:{},{}", m.single_scattering_albedo, m.asymmetry);
        }
        std::string operator()(const MomentsMedium& m) const { return "moments:" + m.path; }
    };
    return std::visit(Describer{}, medium);
}

bool needs_mie(const Medium& medium) {
    return std::holds_alternative<DatabaseMedium>(medium) ||
           std::holds_alternative<IndexMedium>(medium);
}

CoatMedium parse_coat(const std::string& text) {
    const std::size_t at = text.rfind('@');
    if (at == std::string::npos) {
        throw UsageError(
            fmt::format("coat '{}' has no optical depth; write MEDIUM@OPTICAL_DEPTH, "
                        "e.g. AlGaAs7@0.1",
                        text));
    }
    const double optical_depth = parse_number_or_infinity(text.substr(at + 1), "optical depth");
    if (!(optical_depth >= 0.0)) {
        throw UsageError(fmt::format("coat '{}': optical depth {} is out of range; allowed: >= 0",
                                     text, optical_depth));
    }
    return {parse_medium(text.substr(0, at)), optical_depth};
}

mie::SizeDistributionKind parse_size_distribution(const std::string& text) {
    using Kind = mie::SizeDistributionKind;
    if (text == "power-law") return Kind::power_law;
    if (text == "gamma") return Kind::gamma;
    if (text == "log-normal") return Kind::log_normal;
    if (text == "mono") return Kind::mono;
    throw UsageError(
        fmt::format("unknown size distribution '{}'; allowed: power-law, gamma, "
                    "log-normal, mono",
                    text));
}

}  // namespace miebrdf
