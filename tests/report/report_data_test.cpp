// Data of pages against the functions of their scenes.
#include <zlib.h>

#include <cstring>

#include <miebrdf/brdf.h>
#include "pipeline/report/report_data.h"
#include "tests/support/catch.h"

using namespace miebrdf;

namespace {

std::string unpacked(const std::string& base64) {
    std::string bytes;
    unsigned bits = 0;
    int count = 0;
    for (const char letter : base64) {
        const std::string letters =
            "ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789+/";
        const std::size_t value = letters.find(letter);
        if (value == std::string::npos) break;
        bits = bits << 6 | unsigned(value);
        if ((count += 6) >= 8) bytes += char(bits >> (count -= 8) & 255);
    }
    std::string text(1 << 22, '\0');
    uLongf size = text.size();
    REQUIRE(uncompress(reinterpret_cast<Bytef*>(text.data()), &size,
                       reinterpret_cast<const Bytef*>(bytes.data()), bytes.size()) == Z_OK);
    return text.substr(0, size);
}

/// The arrays of a page, as its script finds them.
class PageArrays {
  public:
    explicit PageArrays(const report::ReportData& data)
        : bytes_(unpacked(data.bytes.compressed(data.root))) {
        std::uint32_t length = 0;
        std::memcpy(&length, bytes_.data(), sizeof length);
        first_ = (sizeof length + length + 3) / 4 * 4;
    }
    float first(const nlohmann::json& where) const {
        float value = 0.0F;
        std::memcpy(&value, bytes_.data() + first_ + where["f32"][0].get<std::size_t>(),
                    sizeof value);
        return value;
    }

  private:
    std::string bytes_;
    std::size_t first_ = 0;
};

}  // namespace

TEST_CASE("a page shows the media of every scene, on a base and on any ground",
          "[report][report_data]") {
    // A ground is no medium: lists of media begin with the lowest that there is.
    Scene scene;
    const std::string ground =
        GENERATE("", "black", "none", "lambert:0.3", "mirror:index:0.5,5", "mirror:Ag");
    if (ground.empty()) {
        scene.base = medium("hg:0.9,0.2");
    } else {
        scene.substrate = substrate(ground);
    }
    scene.layers = {layer("hg:0.8,0.3@0.5"), layer("rayleigh:0.7@0.2")};
    const Brdf brdf = solve(scene, {500.0, 600.0});
    report::ReportScene shown{"scene", "description"};
    shown.variants.push_back({brdf});
    const report::ReportData data = report::collect({shown}, {});

    CAPTURE(ground);
    CHECK(data.shortfalls.empty());
    const PageArrays arrays(data);
    const auto& media = data.root["scenes"][0]["variants"][0]["media"];
    std::size_t place = 0;
    for (const LayerOptics& layer : brdf.layers()) {
        if (layer.wavelength != 0) continue;
        REQUIRE(place < media.size());
        CHECK(media[place]["place"].get<std::string>() == layer.layer);
        CHECK(arrays.first(media[place]["albedo"]) == float(layer.single_scattering_albedo));
        CHECK(arrays.first(media[place]["asymmetry"]) == float(layer.asymmetry));
        ++place;
    }
    CHECK(place == media.size());
    CHECK(place == (ground.empty() ? 3 : 2));
}
