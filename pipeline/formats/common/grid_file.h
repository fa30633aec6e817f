// Formats that are tables over three lists of directions, with linear interpolation between them.
#pragma once

#include <functional>

#include <miebrdf/formats.h>

namespace miebrdf {

/// The rule by which a program interpolates between listed elevations.
enum class Elevation { cosine, angle_deg };

struct GridTable {
    std::string format;
    Elevation elevation = Elevation::cosine;
    std::vector<double> in;           ///< ascending; cosines or degrees from the normal
    std::vector<double> out;          ///< ascending
    std::vector<double> azimuth_deg;  ///< ascending, 0 = mirror side
    std::vector<double> wavelength_nm;
    std::vector<std::string> channels;  ///< empty: from the wavelengths
    /// Value number ((channel * in + i) * out + o) * azimuths + a, and how many there are: formats
    /// keep them as they are stored.
    std::function<double(std::size_t)> value;
    std::size_t count = 0;

    void set_values(std::vector<double> values);
};

/// Clamps to the ends of each list. Azimuths that cover only half a turn are mirrored.
/// @throws InputError  when the lists are not ascending or do not fit the values
std::unique_ptr<BrdfFile> make_grid_file(GridTable table);

/// Rows in any order, each with its place and one or more values: found by their places and checked
/// for completeness.
class GridCollector {
  public:
    /// @param format   for messages
    /// @param columns  values of each row
    /// @param rows     about how many there will be
    GridCollector(std::string format, std::size_t columns, std::size_t rows);
    /// @param wavelength_nm  the same in all rows where the values are of several wavelengths
    void add(double wavelength_nm, double in, double out, double azimuth_deg,
             std::span<const double> values);
    /// @throws InputError  for a place that is missing or given twice
    GridTable table(Elevation elevation) &&;

  private:
    std::string format_;
    std::size_t columns_;
    std::vector<double> places_;  ///< of each row wavelength, in, out, azimuth
    std::vector<double> values_;  ///< of each row all columns
};

}  // namespace miebrdf
