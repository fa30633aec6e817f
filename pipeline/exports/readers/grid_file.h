// Formats that are tables over three lists of directions, with linear interpolation between them.
#pragma once

#include <functional>

#include "pipeline/exports/readers/brdf_file.h"

namespace miebrdf::exports {

/// How a program interpolates between listed elevations.
enum class Elevation { cosine, angle_deg };

struct GridTable {
    std::string format;
    Elevation elevation = Elevation::cosine;
    std::vector<double> in;           ///< ascending; cosines or degrees from the normal
    std::vector<double> out;          ///< ascending
    std::vector<double> azimuth_deg;  ///< ascending, 0 = mirror side
    std::vector<double> wavelength_nm;
    std::vector<std::string> channels;  ///< empty: from the wavelengths
    std::vector<double> values;         ///< [channel][in][out][azimuth]
};

/// Clamps to the ends of each list. Azimuths that cover only half a turn are mirrored.
/// @throws InputError  when the lists are not ascending or do not fit the values
std::unique_ptr<BrdfFile> make_grid_file(GridTable table);

/// Values in any order, each with its place: put in order and checked for completeness.
class GridCollector {
  public:
    /// @param format  for messages
    explicit GridCollector(std::string format) : format_(std::move(format)) {}
    void add(double channel, double in, double out, double azimuth_deg, double value);
    /// Channels are wavelengths in nm unless renamed by the caller.
    /// @throws InputError  for a place that is missing or given twice
    GridTable table(Elevation elevation) &&;

  private:
    struct Entry {
        double place[4];
        double value;
    };
    std::string format_;
    std::vector<Entry> entries_;
};

}  // namespace miebrdf::exports
