// Scenes to be solved, each once for all measured values that it gives.
#pragma once

#include <miebrdf/brdf.h>
#include <miebrdf/fit.h>

#include <cstddef>
#include <optional>
#include <set>
#include <string>
#include <vector>

#include "pipeline/fit/unknowns.h"
#include "pipeline/scene/scene_template.h"
#include "pipeline/solve/lost_light.h"

namespace miebrdf::fitting {

/// What a scene is asked for.
enum class Kind { albedo, brdf, hdrf, lab };

struct Job {
    /// A number that is taken from the solution.
    struct Use {
        MeasuredQuantity quantity = MeasuredQuantity::reflectance;
        MeasuredGeometry geometry = MeasuredGeometry::directional;
        /// Indices of this job; `point` where is_scattered().
        std::size_t wavelength = 0, in = 0, out = 0, azimuth = 0, point = 0;
        const FitData* of_spheres = nullptr;  ///< the data that spheres have measured
        LostLight lost = {};                  ///< of these: traced for the scene found before
    };
    /// A measured value: one use, or of an interpolated job a mean over a band of a spectrum.
    struct Reading {
        std::size_t value = 0;  ///< index over all data
        std::size_t use = 0;    ///< index; of interpolated jobs that of the spectrum
        double wavelength_nm = 0.0, shift_nm = 0.0, band_width_nm = 0.0;
        std::optional<std::size_t> shift = {}, scale = {};  ///< slots
    };
    std::vector<TemplateWord> words;
    std::set<std::string> names;  ///< of unknowns in them
    Kind kind = Kind::albedo;
    double diffuse_fraction = 0.0;
    Sky sky = {};
    Viewing viewing = {};
    std::optional<std::size_t> only_wavelength;  ///< index in the model's: unknowns differ there
    std::vector<double> wavelength_nm;
    Directions directions = {};  ///< every combination of them
    /// In place of the combinations, where these would be very many more than the values.
    std::vector<Direction> points = {};
    std::vector<Use> uses;
    std::vector<Reading> readings = {};
    /// Of interpolated jobs: what is asked at each wavelength; uses are all of `wavelength_nm` of
    /// the first spectrum, then of the next.
    std::vector<Use> spectra = {};
    /// Of these: the wavelengths that may be solved, ascending; wavelength_nm are some of them.
    std::vector<double> finest_nm = {};
    int streams = 0;  ///< 0: chosen by the solver
    /// The solver found no need of more than the intensity; it is not asked anew at each step.
    bool takes_intensity_alone = false;

    bool is_scattered() const { return !points.empty(); }
    bool is_interpolated() const { return !finest_nm.empty(); }
    /// Of an interpolated job. @param nm  ascending
    void set_wavelengths(std::vector<double> nm);
};

/// The scene's words with those that a data set has of its own.
std::vector<TemplateWord> words_of(const FitProblem& problem, const FitData& data);

/// All wavelengths of the data, ascending, each once.
std::vector<double> wavelengths_of(const FitProblem& problem);

/// @param slots  slots_of the problem
std::vector<Job> jobs_of(const FitProblem& problem, const std::vector<Slot>& slots);

/// The slot of an unknown at a wavelength.
std::size_t slot_of(const FitProblem& problem, const std::vector<Slot>& slots,
                    const std::string& name, std::size_t wavelength);

}  // namespace miebrdf::fitting
