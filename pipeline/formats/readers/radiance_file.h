// What both kinds of Radiance's BSDF XML share: blocks of numbers, and colours from them.
#pragma once

#include <array>
#include <cstddef>
#include <memory>
#include <pugixml.hpp>
#include <string>
#include <string_view>
#include <vector>

#include "pipeline/formats/readers/brdf_file.h"

namespace miebrdf::exports {

/// The block of front reflection ("Reflection Back" in WINDOW's words) at a wavelength of that
/// name; empty when there is none.
/// @throws InputError  for what is no number, or more than `largest` of them
std::vector<float> radiance_block(const pugi::xml_node& layer, std::string_view wavelength,
                                  std::size_t largest);

/// Linear sRGB from CIE XYZ.
std::array<double, 3> srgb_of(double X, double Y, double Z);

/// Constant over cells of the directions, which each kind numbers its own way.
class RadianceFile : public BrdfFile {
  public:
    std::string format() const override { return "radiance"; }
    const std::vector<std::string>& channels() const override { return channels_; }
    const std::vector<double>& wavelength_nm() const override { return no_wavelengths_; }

    void evaluate(const Direction& direction, std::span<double> values) const override {
        const std::size_t cell = cell_of(direction);
        const std::array<double, 3> rgb = colour_of(cell);
        std::copy(rgb.begin(), rgb.end(), values.begin());
    }

  protected:
    virtual std::size_t cell_of(const Direction& direction) const = 0;
    virtual std::array<double, 3> colour_of(std::size_t cell) const = 0;

  private:
    std::vector<std::string> channels_ = {"R", "G", "B"};
    std::vector<double> no_wavelengths_;
};

/// A matrix over the patches of an angle basis, as Radiance's bsdf_m.c evaluates it.
std::unique_ptr<BrdfFile> read_klems(const pugi::xml_node& layer);

/// A full grid, as Radiance's bsdf_t.c evaluates it.
/// @param largest  no more numbers than this can be in the file
std::unique_ptr<BrdfFile> read_tensor_tree(const pugi::xml_node& layer, std::size_t largest);

}  // namespace miebrdf::exports
