// Wavelengths, and functions of them as lists.
#pragma once

#include <vector>

namespace miebrdf::support {

inline std::vector<double> every_nm(int step, int first, int last) {
    std::vector<double> list;
    for (int nm = first; nm <= last; nm += step) list.push_back(nm);
    return list;
}

template <typename Function>
std::vector<double> sample(const std::vector<double>& wavelength_nm, Function reflectance) {
    std::vector<double> values;
    values.reserve(wavelength_nm.size());
    for (const double nm : wavelength_nm) values.push_back(reflectance(nm));
    return values;
}

}  // namespace miebrdf::support
