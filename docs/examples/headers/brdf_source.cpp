#include <miebrdf/brdf_source.h>
#include <miebrdf/control.h>

#include <iostream>
#include <numbers>

namespace {

/// A BRDF of one's own: exports, samplers and renderers take it like a solved one.
class Grey : public miebrdf::BrdfSource {
  public:
    explicit Grey(std::vector<double> albedo) : albedo_(std::move(albedo)) {
        provenance_.title = "two greys";
    }
    const std::vector<std::string>& channels() const override { return names_; }
    const std::vector<double>& wavelength_nm() const override { return nm_; }
    const miebrdf::Provenance& provenance() const override { return provenance_; }
    void evaluate(std::span<const miebrdf::Direction> directions,
                  std::span<double> values) const override {
        std::vector<miebrdf::Direction> storage;  // cosines of 1.0000001 become 1
        directions = miebrdf::require_valid(directions, values.size(), names_.size(), storage);
        for (std::size_t d = 0; d < directions.size(); ++d) {
            for (std::size_t c = 0; c < names_.size(); ++c)
                values[d * names_.size() + c] = albedo_[c] / std::numbers::pi;
        }
    }

  private:
    std::vector<double> albedo_, nm_ = {450, 650};
    std::vector<std::string> names_ = miebrdf::channel_names(nm_);  // "450 nm", "650 nm"
    miebrdf::Provenance provenance_;
};

}  // namespace

void show_brdf_source() {
    using namespace miebrdf;
    const Grey grey({0.2, 0.8});
    const std::vector<Direction> directions = {{0.5, 0.9, 0.0}, {0.5, 0.9, 90.0}, {0.5, 1.0, 0.0}};
    std::cout << count_sharing_cosines(directions) << " share their cosines\n";
    require_wavelengths(grey, "own");  // refuses sources of colours

    const std::vector<double> all = evaluate_all(grey, directions, "example", Control{});
    const ColourWeights weights = {{1, 0, 0}, {0, 1, 1}};  // of each channel
    require_weights(grey, weights);
    const std::unique_ptr<ChannelMix> mixed = grey.mix(weights);
    std::vector<double> colours(3 * directions.size());
    mixed->evaluate(directions, colours);
    std::vector<double> mueller(all.size());
    if (grey.components() == 1) grey.evaluate_mueller(directions, mueller);  // the BRDF alone
    std::cout << all[1] << " / sr at " << grey.wavelength_nm()[1] << " nm; " << colours[2] << '\n';
}
