// The kinds of media, in one list: what their words are, and what optics they bring.
#pragma once

#include <miebrdf/optics.h>
#include <miebrdf/scene.h>

#include <functional>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include <miebrdf/index.h>
#include "pipeline/scene/given_medium.h"

namespace miebrdf {

/// One of the numbers after the colon.
struct MediumParameter {
    std::string name;     ///< "single-scattering albedo"
    std::string allowed;  ///< "[0, 1]"
    bool (*is_allowed)(double value);
    std::optional<double> by_default = {};  ///< of a last number that may be left out
    const char* key = nullptr;  ///< that it is given by, `depolarisation=0.03`, or left out: then 0
};

/// A new kind of medium is one object of this type and one line in medium_kinds().
struct MediumKind {
    Species::Kind kind;
    std::string name;       ///< before the colon: "hg"
    std::string form = {};  ///< how it is written: "hg:ALBEDO,G"; empty: words cannot say it
    std::string example = {};
    std::string help = {};
    std::vector<MediumParameter> parameters = {};
    /// Reads what follows the colon into name, parameters and chi; empty: `parameters`, numbers
    /// separated by commas.
    std::function<void(const std::string& values, Species& species)> read = {};
    /// Where `parameters` may come from a file in place of numbers: reads it.
    std::function<void(const std::string& path, Species& species)> read_file = {};
    /// Makes its data, where the medium brings its optics; empty: spheres of a refractive index,
    /// through Mie theory.
    std::function<std::shared_ptr<const GivenMedium>(const Species& species)> given = {};
    /// Whether its extinction is known beside its optics.
    bool has_extinction = false;
    /// Whether its extinction is that per um of a layer which it fills: a thickness needs no
    /// amount, and shares of the volume reach 1.
    bool fills_layer = false;
    /// The species without the keys that it takes (sizes, amounts), which describe_keys() writes.
    std::function<Species(Species species)> without_own_keys = [](Species all) { return all; };
    std::string own_keys = {};  ///< these, in words for a message
    /// Refuses what no such medium can be, beyond ranges of parameters.
    std::function<void(const Species& species)> check = [](const Species&) {};
};

/// In the order of Species::Kind.
const std::vector<MediumKind>& medium_kinds();

const MediumKind& kind_of(const Species& species);

/// Holds a species, however it was made, to what its kind allows.
/// @throws UsageError  naming the species, the value and the allowed range
void validate(const Species& species);

/// The refractive index that a medium of the kind "table" brings.
/// @throws std::invalid_argument  for a table that is empty, not ascending or not physical
materials::RefractiveIndex own_index(const Species& species);

}  // namespace miebrdf
