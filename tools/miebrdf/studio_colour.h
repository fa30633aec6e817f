// Colours beside the studio's picture: films over a contrast chart, chips of materials.
#pragma once

#include <map>
#include <mutex>
#include <nlohmann/json.hpp>
#include <string>
#include <vector>

#include <miebrdf/colour.h>
#include <miebrdf/control.h>
#include "tools/miebrdf/scene_options.h"

namespace miebrdf::program {

/// The layers of a scene over black and over the white of a contrast chart, each as a sphere of 8
/// degrees sees it with the gloss: the spectra `over_black` and `over_white`, `contrast_ratio` of
/// their Y in this light, and, except of previews, the depth that hides: `relative_depth`,
/// `thickness_um`, `spreading_rate_m2_per_l` (null: none hides, or the layers have no thickness).
/// @throws UsageError  for scenes without a film of finite depth, and as draw_down()
nlohmann::json drawdown_for_page(const Request& request, const Viewing& light, bool is_preview,
                                 const Control& control);

/// Colours of materials to be told apart in a list. Thread-safe.
class MaterialChips {
  public:
    /// {"Au": {"hex": "#ffdf8e", "of": "mirror"}}: what conducts (k above 1) is shown as a polished
    /// mirror, all else as a thick heap of spheres of 0.15 um in a binder (`of` "pigment"); null
    /// where the tables do not reach over visible light. A colour takes some milliseconds, once.
    /// @throws Cancelled
    nlohmann::json of(const std::vector<std::string>& names, const Control& control);

  private:
    std::mutex mutex_;
    std::map<std::string, nlohmann::json> known_;
};

}  // namespace miebrdf::program
