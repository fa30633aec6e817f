// Reflectance spectra and single-scattering tables: what can be exported without directions.
// docs/formats/spectra.md
#pragma once

#include <filesystem>
#include <iosfwd>
#include <string>
#include <vector>

namespace miebrdf::exports {

struct Spectrum {
    std::vector<double> wavelength_nm;
    std::vector<double> value;
    std::vector<std::string> comments;  ///< version, command line, sources, what the value is
};

/// "nm value" lines under '#' comments: Mitsuba 0.6, pbrt and many others.
/// @throws UsageError  for wavelengths that do not ascend
void write_spd(const Spectrum& spectrum, std::ostream& out);

/// A Mitsuba 3 <spectrum type="irregular"> element, comments before it.
void write_mitsuba_irregular(const Spectrum& spectrum, std::ostream& out);

/// Single scattering at each wavelength, as sasktran2 and others name it.
struct ScatteringTable {
    std::vector<double> wavelength_nm;
    std::vector<double> single_scattering_albedo;
    std::vector<double> asymmetry;
    std::vector<double> q_ext;             ///< not a number for media without particles
    std::vector<std::vector<double>> chi;  ///< chi_0 = 1, ...; lists may differ in length
    std::string metadata;                  ///< JSON
};

/// Arrays wavelength_nm, legendre, ssa, asymmetry, q_ext, chi[wavelength, legendre] and
/// lm_a1 = (2 l + 1) chi_l, zero beyond what is known. @throws InputError
void write_scattering_npz(const ScatteringTable& table, const std::filesystem::path& path);

}  // namespace miebrdf::exports
