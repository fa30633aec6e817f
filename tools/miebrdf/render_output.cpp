#include "tools/miebrdf/render_output.h"

#include <fmt/format.h>

#include <algorithm>
#include <cctype>
#include <cmath>
#include <filesystem>

#include <miebrdf/error.h>
#include "pipeline/render/lighting.h"
#include "pipeline/scene/number_list.h"

namespace miebrdf::program {
namespace {

void check_ending(const std::string& path, const std::string& option, const std::string& wanted) {
    if (path.empty()) return;
    std::string ending = std::filesystem::path(path).extension().string();
    for (char& c : ending) c = char(std::tolower(static_cast<unsigned char>(c)));
    if (ending != wanted) {
        throw UsageError(fmt::format("picture '{}': unknown ending '{}'; allowed: {} with {}", path,
                                     ending, wanted, option));
    }
}

}  // namespace

void check_picture_paths(const std::string& png, const std::string& exr) {
    check_ending(png, "-o", ".png");
    check_ending(exr, "--exr", ".exr");
}

render::Image compose(const render::SpectralPicture& picture,
                      const std::vector<double>& wavelength_nm, const std::string& background,
                      double exposure) {
    const render::Image rgb = render::to_linear_srgb(picture.radiance, wavelength_nm);
    const bool transparent = background == "transparent";
    std::vector<double> behind(3, 0.0);
    if (!transparent && background != "environment") {
        behind = parse_number_list(background, "background", 0.0, 1.0);
        if (behind.size() != 3)
            throw UsageError("background: wanted: R,G,B, transparent or environment");
    }
    render::Image image(rgb.width, rgb.height, transparent ? 4 : 3);
    const auto gain = float(std::exp2(exposure));
    for (int y = 0; y < rgb.height; ++y) {
        for (int x = 0; x < rgb.width; ++x) {
            const float share = *picture.coverage.pixel(x, y);
            float* pixel = image.pixel(x, y);
            for (int c = 0; c < 3; ++c) {
                const float value = gain * rgb.pixel(x, y)[c];
                // PNG wants colours that are not yet multiplied by alpha.
                pixel[c] = transparent ? (share > 0.0F ? value / share : 0.0F)
                                       : value + (1.0F - share) * float(behind[std::size_t(c)]);
            }
            if (transparent) pixel[3] = share;
        }
    }
    return image;
}

void write_spectral_exr(const render::SpectralPicture& picture,
                        const std::vector<double>& wavelength_nm, const render::PictureNotes& notes,
                        const std::string& path) {
    const render::Image rgb = render::to_linear_srgb(picture.radiance, wavelength_nm);
    const int count = int(wavelength_nm.size());
    render::Image all(rgb.width, rgb.height, 4 + count);
    for (int y = 0; y < rgb.height; ++y) {
        for (int x = 0; x < rgb.width; ++x) {
            float* pixel = all.pixel(x, y);
            std::copy_n(rgb.pixel(x, y), 3, pixel);
            pixel[3] = *picture.coverage.pixel(x, y);
            std::copy_n(picture.radiance.pixel(x, y), count, pixel + 4);
        }
    }
    std::vector<std::string> names = {"R", "G", "B", "A"};
    for (const double wavelength : wavelength_nm) {
        std::string number = fmt::format("{:.6f}", wavelength);
        std::replace(number.begin(), number.end(), '.', ',');
        names.push_back(fmt::format("S0.{}nm", number));
    }
    render::write_exr(all, names, notes, path);
}

}  // namespace miebrdf::program
