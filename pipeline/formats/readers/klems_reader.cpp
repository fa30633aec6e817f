// Radiance's Klems matrices: constant over the patches of rings about the normal.
#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <numbers>

#include <miebrdf/error.h>
#include "pipeline/formats/readers/radiance_file.h"

namespace miebrdf::exports {
namespace {

constexpr double kPi = std::numbers::pi;

class KlemsFile : public RadianceFile {
  public:
    explicit KlemsFile(const pugi::xml_node& layer) {
        for (const pugi::xml_node ring :
             layer.child("DataDefinition").child("AngleBasis").children("AngleBasisBlock")) {
            const int patches = ring.child("nPhis").text().as_int();
            const double upper = ring.child("ThetaBounds").child("UpperTheta").text().as_double();
            const double lower = rings_.empty() ? 0.0 : rings_.back().upper_deg;
            if (patches < 1 || patches > 10000 || !(upper > lower && upper <= 90.0) ||
                rings_.size() > 100) {
                throw InputError("radiance: the angle basis is damaged");
            }
            rings_.push_back({upper, static_cast<std::size_t>(patches), patches_});
            patches_ += static_cast<std::size_t>(patches);
        }
        if (rings_.empty()) throw InputError("radiance: no angle basis");
        const std::size_t size = patches_ * patches_;
        y_ = radiance_block(layer, "Visible", size);
        x_ = radiance_block(layer, "CIE-X", size);
        z_ = radiance_block(layer, "CIE-Z", size);
        if (y_.size() != size || (!x_.empty() && x_.size() != size) ||
            (!z_.empty() && z_.size() != size)) {
            throw InputError(fmt::format("radiance: {} values of a {} x {} matrix", y_.size(),
                                         patches_, patches_));
        }
    }
    std::string description() const override {
        return fmt::format("Klems matrix of {} patches", patches_);
    }

  private:
    struct Ring {
        double upper_deg;
        std::size_t patches, first;
    };

    std::size_t patch(double mu, double azimuth_deg) const {
        const double theta = std::acos(std::clamp(mu, -1.0, 1.0)) * 180 / kPi;
        const auto ring = std::find_if(rings_.begin(), rings_.end() - 1,
                                       [&](const Ring& r) { return theta < r.upper_deg; });
        const double turns = azimuth_deg / 360.0 - std::floor(azimuth_deg / 360.0);
        const auto count = static_cast<double>(ring->patches);
        return ring->first + static_cast<std::size_t>(std::lround(turns * count)) % ring->patches;
    }

    /// Incident azimuth 0 is turned by half a turn in this basis: equal patches are mirror
    /// directions.
    std::size_t cell_of(const Direction& d) const override {
        return patch(d.mu_out, d.azimuth_deg) * patches_ + patch(d.mu_in, 0.0);
    }
    std::array<double, 3> colour_of(std::size_t cell) const override {
        if (x_.empty() || z_.empty()) return {y_[cell], y_[cell], y_[cell]};
        return srgb_of(x_[cell], y_[cell], z_[cell]);
    }

    std::vector<Ring> rings_;
    std::size_t patches_ = 0;
    std::vector<float> x_, y_, z_;
};

}  // namespace

std::unique_ptr<BrdfFile> read_klems(const pugi::xml_node& layer) {
    return std::make_unique<KlemsFile>(layer);
}

}  // namespace miebrdf::exports
