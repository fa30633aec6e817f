#include "pipeline/formats/common/grid_file.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <limits>
#include <numbers>

#include <miebrdf/brdf_source.h>

namespace miebrdf {
namespace {

constexpr std::size_t kAxes = 4;  // of a collector's places

struct Position {
    std::size_t low = 0, high = 0;
    double share = 0.0;
};

Position locate(const std::vector<double>& axis, double x) {
    const auto above = std::upper_bound(axis.begin(), axis.end(), x) - axis.begin();
    if (above == 0) return {0, 0, 0.0};
    const auto high = static_cast<std::size_t>(above);
    if (high == axis.size()) return {high - 1, high - 1, 0.0};
    return {high - 1, high, (x - axis[high - 1]) / (axis[high] - axis[high - 1])};
}

void require_ascending(const GridTable& table, const std::vector<double>& axis, const char* name) {
    if (axis.empty()) throw InputError(fmt::format("{}: no {}", table.format, name));
    for (std::size_t i = 0; i < axis.size(); ++i) {
        if (!std::isfinite(axis[i]) || (i > 0 && !(axis[i] > axis[i - 1]))) {
            throw InputError(
                fmt::format("{}: {} is not ascending at {}", table.format, name, axis[i]));
        }
    }
}

class GridFile : public BrdfFile {
  public:
    explicit GridFile(GridTable table) : table_(std::move(table)) {
        require_ascending(table_, table_.in, "incident direction");
        require_ascending(table_, table_.out, "outgoing direction");
        require_ascending(table_, table_.azimuth_deg, "azimuth");
        if (table_.channels.empty()) table_.channels = channel_names(table_.wavelength_nm);
        plane_ = table_.in.size() * table_.out.size() * table_.azimuth_deg.size();
        if (table_.channels.empty() || table_.count / plane_ != table_.channels.size() ||
            table_.count % plane_ != 0) {
            throw InputError(fmt::format("{}: {} values for {} channels of {} directions",
                                         table_.format, table_.count, table_.channels.size(),
                                         plane_));
        }
    }

    std::string format() const override { return table_.format; }
    std::string description() const override {
        return fmt::format("table of {} incident x {} outgoing x {} azimuths", table_.in.size(),
                           table_.out.size(), table_.azimuth_deg.size());
    }
    const std::vector<std::string>& channels() const override { return table_.channels; }
    const std::vector<double>& wavelength_nm() const override { return table_.wavelength_nm; }

    std::optional<ListedDirections> listed() const override {
        return ListedDirections{cosines(table_.in), cosines(table_.out), table_.azimuth_deg,
                                table_.elevation == Elevation::angle_deg};
    }

    void look_up(const Direction& direction, std::span<double> values) const override {
        const Position i = locate(table_.in, coordinate(direction.mu_in));
        const Position o = locate(table_.out, coordinate(direction.mu_out));
        const Position a = locate(table_.azimuth_deg, azimuth(direction.azimuth_deg));
        for (std::size_t c = 0; c < values.size(); ++c) {
            double sum = 0.0;
            for (int corner = 0; corner < 8; ++corner) {
                const double weight = ((corner & 1) != 0 ? i.share : 1 - i.share) *
                                      ((corner & 2) != 0 ? o.share : 1 - o.share) *
                                      ((corner & 4) != 0 ? a.share : 1 - a.share);
                if (weight == 0.0) continue;
                const std::size_t row = ((corner & 1) != 0 ? i.high : i.low) * table_.out.size() +
                                        ((corner & 2) != 0 ? o.high : o.low);
                sum += weight * table_.value(c * plane_ + row * table_.azimuth_deg.size() +
                                             ((corner & 4) != 0 ? a.high : a.low));
            }
            values[c] = sum;
        }
    }

  private:
    std::vector<double> cosines(const std::vector<double>& elevations) const {
        std::vector<double> list = elevations;
        if (table_.elevation == Elevation::cosine) return list;
        for (double& angle : list) angle = std::cos(angle * std::numbers::pi / 180);
        std::reverse(list.begin(), list.end());
        return list;
    }

    double coordinate(double mu) const {
        if (table_.elevation == Elevation::cosine) return mu;
        return std::acos(std::clamp(mu, -1.0, 1.0)) * 180 / std::numbers::pi;
    }

    double azimuth(double degrees) const {
        double turned = std::fmod(degrees, 360.0);
        if (turned < 0) turned += 360.0;
        return table_.azimuth_deg.back() <= 180.0 && turned > 180.0 ? 360.0 - turned : turned;
    }

    GridTable table_;
    std::size_t plane_ = 0;
};

}  // namespace

std::unique_ptr<BrdfFile> make_grid_file(GridTable table) {
    return std::make_unique<GridFile>(std::move(table));
}

void GridTable::set_values(std::vector<double> values) {
    count = values.size();
    value = [list = std::move(values)](std::size_t i) { return list[i]; };
}

GridCollector::GridCollector(std::string format, std::size_t columns, std::size_t rows)
    : format_(std::move(format)), columns_(columns) {
    places_.reserve(4 * rows);
    values_.reserve(columns * rows);
}

void GridCollector::add(double wavelength_nm, double in, double out, double azimuth_deg,
                        std::span<const double> values) {
    for (const double number : {wavelength_nm, in, out, azimuth_deg}) {
        if (!std::isfinite(number))
            throw InputError(fmt::format("{}: {} is no number", format_, number));
        places_.push_back(number);
    }
    values_.insert(values_.end(), values.begin(), values.end());
}

GridTable GridCollector::table(Elevation elevation) && {
    const std::size_t rows = places_.size() / kAxes;
    if (rows == 0 || columns_ == 0) throw InputError(fmt::format("{}: no values", format_));
    GridTable table;
    table.format = format_;
    table.elevation = elevation;
    std::vector<double>* axes[kAxes] = {&table.wavelength_nm, &table.in, &table.out,
                                        &table.azimuth_deg};
    std::size_t expected = 1;
    for (std::size_t d = 0; d < kAxes; ++d) {
        for (std::size_t r = 0; r < rows; ++r) axes[d]->push_back(places_[kAxes * r + d]);
        std::sort(axes[d]->begin(), axes[d]->end());
        axes[d]->erase(std::unique(axes[d]->begin(), axes[d]->end()), axes[d]->end());
        axes[d]->shrink_to_fit();
        if (axes[d]->size() > rows / expected) {
            throw InputError(
                fmt::format("{}: {} rows do not fill a grid of directions", format_, rows));
        }
        expected *= axes[d]->size();
    }
    if (expected != rows) {
        throw InputError(fmt::format("{}: {} rows for a grid of {} directions and wavelengths",
                                     format_, rows, expected));
    }
    // As many rows as places: each place is filled once, or one is filled twice.
    constexpr auto none = std::numeric_limits<std::uint32_t>::max();
    std::vector<std::uint32_t> row_at(expected, none);
    for (std::size_t r = 0; r < rows; ++r) {
        std::size_t index = 0;
        for (std::size_t d = 0; d < kAxes; ++d) {
            const auto place =
                std::lower_bound(axes[d]->begin(), axes[d]->end(), places_[kAxes * r + d]);
            index = index * axes[d]->size() + static_cast<std::size_t>(place - axes[d]->begin());
        }
        if (row_at[index] != none)
            throw InputError(fmt::format("{}: a direction occurs twice", format_));
        row_at[index] = static_cast<std::uint32_t>(r);
    }
    table.count = values_.size();
    table.value = [row_at = std::move(row_at), values = std::move(values_),
                   columns = columns_](std::size_t i) {
        return values[row_at[i % row_at.size()] * columns + i / row_at.size()];
    };
    return table;
}

}  // namespace miebrdf
