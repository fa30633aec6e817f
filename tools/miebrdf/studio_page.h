// What the studio's page asks for: its scene, colours beside the picture, measured files and fits.
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

/// {"base": ["TiO2,radius=0.2"], "coat": [...], "missing-k-zero": [true]} as words. Words that name
/// a file are refused: nothing of the disk is read for a page.
/// @throws UsageError  for words that no scene has, values that are no texts, more than a page
/// needs
SaidWords words_from_page(const nlohmann::json& page);
nlohmann::json words_for_page(const SaidWords& said);

/// The request of a page's words, within what a page may ask for.
/// @throws UsageError, InputError  as request_of()
Request request_of_page(const SaidWords& said);

/// `--base TiO2,radius=0.2 ...`, one word each.
std::vector<std::string> arguments_of(const SaidWords& said);
/// A scene file with one report; `page` (one line of JSON, may be empty) is kept in a comment.
std::string scene_file_of(const SaidWords& said, const std::string& page);
/// What scene_file_of() kept; empty: nothing.
std::string page_of_scene_file(const std::string& text);
/// A script that makes the same scene.
std::string python_of(const SaidWords& said);

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

/// What the readers of `miebrdf measured` find in `content` (base64), a file called `name`; perhaps
/// with `quantity` and `theta_in_deg` of what it does not say: `samples`, `doubts`, and `values` of
/// `sample`, `quantity`, `geometry`, `wavelength_nm`, `mu_in`, `mu_out`, `azimuth_deg`, `value`.
/// @throws UsageError, InputError  as read_measured()
nlohmann::json measured_for_page(const nlohmann::json& asked);

/// Fits the `unknowns` ({"u1": "0.2 in 0.02:2 log"}) of these words to one `sample` of such a file,
/// between `from_nm` and `to_nm`: `values` with `standard_error`, `notes`, `used`, `converged`.
/// @throws UsageError, InputError  as fit()
nlohmann::json fit_for_page(const SaidWords& said, const nlohmann::json& asked,
                            const Control& control);

}  // namespace miebrdf::program
