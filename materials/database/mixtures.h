// Mixtures as materials: "bruggeman(TiO2:30%,SiO2)" is a name like any other.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include <miebrdf/database.h>
#include "materials/index/mixing_rules.h"

namespace miebrdf::materials {

struct Mixture {
    const MixingRule* rule = nullptr;
    struct Part {
        std::string name;
        double fraction = 0.0;
    };
    std::vector<Part> parts;
};

/// Nothing when the text is no RULE(...) of a known rule; "/mixture" may follow, the label of its
/// dataset. One fraction may be missing and is the rest; average(o,e) without any is that of a
/// powder of a uniaxial crystal, 2/3 and 1/3.
/// @throws UsageError  for parts that are missing or too many, and fractions that do not add up
std::optional<Mixture> parse_mixture(const std::string& name);

/// Tabulated at every wavelength of the parts' tables where all parts are known, and at seven
/// between any two of them.
/// @param datasets  of the parts, for titles, references and densities
/// @throws InputError  when the parts have no wavelength in common
Dataset mix(const Mixture& mixture, const std::string& name,
            const std::vector<RefractiveIndex>& indices, const std::vector<Dataset>& datasets);

/// What is known of a dataset that no file holds.
DatasetInfo describe_unstored(const Dataset& dataset);

}  // namespace miebrdf::materials
