// Measurements out of a text, as if it were a file.
#pragma once

#include <miebrdf/measured.h>

#include <string>
#include <vector>

#include "tests/support/temporary_folder.h"

namespace miebrdf::support {

inline Measurements read_text(const std::string& text, const MeasuredOptions& options = {},
                              const std::string& name = "file.csv") {
    const TemporaryFolder folder;
    return read_measured(folder.write(name, text), options);
}

inline std::vector<double> values_of(const Measurements& list) {
    std::vector<double> values;
    for (const MeasuredValue& v : list.values) values.push_back(v.value);
    return values;
}

inline std::vector<double> wavelengths_of(const Measurements& list) {
    std::vector<double> nm;
    for (const MeasuredValue& v : list.values) nm.push_back(v.wavelength_nm);
    return nm;
}

/// The text of a fact; empty where there is none.
inline std::string fact_of(const Measurements& list, const std::string& name) {
    for (const auto& [known, text] : list.facts) {
        if (known == name) return text;
    }
    return {};
}

}  // namespace miebrdf::support
