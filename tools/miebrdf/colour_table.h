// Colours as rows of a table, beside those of a reference where there is one.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include <miebrdf/colour.h>
#include "pipeline/io/table.h"
#include "tools/miebrdf/reflection_options.h"

namespace miebrdf::program {

/// What the rows of a table of colours are compared with.
struct ReferenceColours {
    std::string title = {};  ///< where they come from
    std::vector<double> wavelength_nm = {};
    std::vector<std::vector<double>> reflectance = {};  ///< [row][wavelength]
    std::vector<Lab> labs = {};                         ///< [row], in place of spectra

    bool empty() const { return reflectance.empty() && labs.empty(); }
};

/// The rows of `albedo --colour`, or their derivatives: plane albedo at each mu_in, spherical
/// albedo, albedo under the sky at each mu_in if a share of diffuse light is given.
/// [row][wavelength]
std::vector<std::vector<double>> spectra_of(const AlbedoValues& values,
                                            const std::optional<double>& diffuse_fraction);
/// The rows of `brdf --colour`, or their derivatives: pi times the BRDF at every direction.
/// [row][wavelength]
std::vector<std::vector<double>> spectra_of(const BrdfValues& values, BrdfPart part);

/// The colours that a file has for the rows of `albedo --colour`, of `--over` those of the dark
/// ground first: a scene file (.toml), whose first result's scene is solved at the question's
/// wavelengths (and over its grounds); a table that `albedo` has written, of spectra or colours; or
/// a measured spectrum or Lab, which stands for every row (whatever read_measured() reads, and CSV
/// with the columns L*, a*, b* or lab_l, lab_a, lab_b). Over two grounds a file may have two, the
/// darker one of the dark ground.
/// @throws UsageError, InputError  for files that have none of that, too few wavelengths, or
///         colours under another light
ReferenceColours reference_albedos(const std::string& path, const AlbedoQuestion& question,
                                   const Control& control);
/// Reflectances, pi times the BRDF, for the rows of `brdf --colour`: of a scene file, a file that
/// `check` reads, a table of `brdf --colour`, a spectrum or a Lab.
/// @throws UsageError, InputError
ReferenceColours reference_reflectances(const std::string& path, const BrdfQuestion& question,
                                        const Control& control);

/// Columns x, y, z, lab, srgb, lch, colour_error; with a reference de76, de2000 and, of spectra,
/// tint_strength.
class ColourColumns {
  public:
    /// @param wavelength_nm  ascending
    ColourColumns(const std::vector<double>& wavelength_nm, const Viewing& viewing,
                  ReferenceColours reference);

    void add_names(Table& table) const;
    /// Adds the cells of a reflectance to the last row; the n-th call is for row n.
    /// @return Y
    double add_cells(Table& table, const std::vector<double>& reflectance);
    /// Columns VALUE_d_NAME of each x ... lch_h by each parameter.
    void add_derivative_names(Table& table, const std::vector<std::string>& parameters) const;
    /// Adds their cells to the last row; as of add_cells, and the derivatives of the reflectance.
    void add_derivative_cells(Table& table, const std::vector<double>& reflectance,
                              const std::vector<double>& slope) const;
    /// Facts that explain the colours, and say how well the wavelengths determine them.
    void add_facts(Table& table) const;
    std::string units() const;

  private:
    Colorimeter colorimeter_;
    std::vector<double> wavelength_nm_;
    ReferenceColours reference_;
    std::vector<Lab> reference_labs_;
    std::size_t row_ = 0;
    double largest_error_ = 0.0;
    double reference_error_ = 0.0;
};

}  // namespace miebrdf::program
