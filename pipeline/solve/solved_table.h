// A scene solved once and then evaluated at any directions: what a BrdfTable holds.
#pragma once

#include <miebrdf/brdf.h>

#include <optional>
#include <vector>

#include <miebrdf/surface.h>
#include "pipeline/solve/mueller_part.h"
#include "pipeline/solve/polarisation.h"
#include "pipeline/solve/scene_optics.h"
#include "pipeline/solve/smooth_part.h"
#include "rte/first_order/spectral_first_order.h"
#include "rte/phase/stack_of_media.h"

namespace miebrdf {

/// Directions by which streams and moments of a table are chosen and its error is estimated. None
/// is nearer to the horizon than mu = .05, which would need many more streams.
const Directions& probe_directions();

/// The layers at one wavelength, solved. The BRDF is the sum of light scattered more than once,
/// which is smooth and tabulated (SmoothPart), and of light scattered once and the surface lobe,
/// which have sharp features and are evaluated exactly at every direction (SharpPart).
class SolvedWavelength {
  public:
    /// @param optics  the visible layers; not used for BrdfPart::surface
    /// @param w       index of the wavelength
    /// @param light   with several components the BRDF is element 11 of the Mueller matrix
    /// @param whole_matrix     the other elements are wanted too
    /// @param unchecked_nodes  BrdfState::unchecked_nodes
    SolvedWavelength(const ResolvedScene& scene, std::size_t w, const SceneOptics& optics,
                     const SolverOptions& solver, BrdfPart part, const LightChoice& light,
                     bool whole_matrix, int unchecked_nodes, rte::SolutionMemory& memory,
                     const Control& control);

    /// Light scattered more than once that the surface lets through.
    const SmoothPart& smooth() const { return smooth_; }
    void add_smooth(const SmoothPart& part) { smooth_.add(part, 1.0); }
    /// The layers, without the surface; no media for BrdfPart::surface.
    const rte::ScaledStack& stack() const { return stack_; }
    bool is_polarised() const { return is_polarised_; }
    /// True if boundaries or mirrors refract light scattered once or send it back.
    bool has_optical_steps() const { return stack_.refracts() || stack_.has_mirrors(); }

    /// BRDF of the lobe of a surface or a rough boundary; 0 without one.
    double lobe(const Direction& direction) const;
    /// The surface's factor for light of the layers (total_of in brdf.cpp); 1 without a surface.
    double transmitted(double mu_in, double mu_out) const;
    /// Factors of lobe() at mu_in and at mu_out by which the lobe of a rough boundary holds light
    /// reflected by several facets, too; 1 for a surface.
    double lobe_scale(double mu) const;
    bool has_lobe() const { return lobe_.has_value(); }

    const WavelengthReport& report() const { return report_; }
    /// Null where only the BRDF was solved.
    const MuellerPart* mueller() const { return mueller_ ? &*mueller_ : nullptr; }

  private:
    void solve(const SceneOptics& optics, const SolverOptions& solver, int components,
               bool whole_matrix, int unchecked_nodes, rte::SolutionMemory& memory);

    rte::ScaledStack stack_;
    bool is_polarised_ = false;
    SmoothPart smooth_;
    std::optional<MuellerPart> mueller_;
    std::optional<rte::SurfaceLobe> lobe_;
    std::vector<double> lobe_scale_;              ///< of a rough boundary, at the nodes
    std::vector<double> factor_in_, factor_out_;  ///< of the surface, at the nodes
    WavelengthReport report_;
};

/// Memory that one evaluation leaves for the next.
struct EvaluationScratch {
    std::vector<double> cos_azimuth, sharp, series;
    rte::SpectralFirstOrder::Scratch first_order;
};

/// Light scattered once that the surface lets through, and the surface lobe, at some wavelengths.
class SharpPart {
  public:
    /// Wavelengths of one part share their tables; several parts are made in parallel.
    static constexpr std::size_t kMostWavelengths = 16;

    /// @param wavelengths  at most kMostWavelengths; must outlive this
    SharpPart(std::span<const SolvedWavelength> wavelengths, const SolverOptions& solver);
    /// A copy for wavelengths whose smooth parts may hold the light scattered once.
    SharpPart(const SharpPart& exact, std::span<const SolvedWavelength> wavelengths,
              bool first_order_is_smooth);

    std::size_t wavelengths() const { return wavelengths_.size(); }
    const SolvedWavelength& wavelength(std::size_t w) const { return wavelengths_[w]; }

    /// BRDF at directions that share their cosines (set_cosines): values[d * wavelengths() + w].
    void evaluate(std::span<const Direction> directions, std::span<double> values,
                  EvaluationScratch& scratch) const;
    const rte::SpectralFirstOrder& first_order() const { return *first_order_; }
    /// Whether every value is 0.
    bool is_empty() const { return !first_order_ && !has_lobe_; }

  private:
    std::span<const SolvedWavelength> wavelengths_;
    std::optional<rte::SpectralFirstOrder> first_order_;  ///< empty: in the smooth parts
    bool has_lobe_;
};

/// Sets scratch.cos_azimuth of directions that share their cosines, before SharpPart::evaluate and
/// SmoothSum::add.
void set_cosines(std::span<const Direction> directions, EvaluationScratch& scratch);

/// Adds smooth parts to values of the BRDF at directions that share their cosines.
class SmoothSum {
  public:
    explicit SmoothSum(const Direction& first)
        : in_(SmoothPart::place_of(first.mu_in)),
          out_(SmoothPart::place_of(first.mu_out)),
          mu_sum_(first.mu_in + first.mu_out) {}

    /// @param values  values[d * stride] for direction d
    void add(const SmoothPart& smooth, double* values, std::size_t stride,
             EvaluationScratch& scratch) const;

  private:
    SixNodes in_, out_;
    double mu_sum_;
};

/// All wavelengths of a scene.
struct SolvedTable {
    SolvedTable(const ResolvedScene& scene, const std::string& title, const SolverOptions& solver,
                const TableOptions& options, const Control& control, int unchecked_nodes);
    /// The table of for_many_directions().
    SolvedTable(const BrdfTable& exact, const Control& control);
    SolvedTable(const SolvedTable&) = delete;

    ResolvedScene scene;
    SolverOptions solver;
    BrdfPart part = BrdfPart::total;
    std::vector<std::string> channels;
    Provenance provenance;
    std::vector<SolvedWavelength> wavelengths;
    std::vector<SharpPart> sharp;  ///< each of the next kMostWavelengths of `wavelengths`
    int components = 1;            ///< of the Mueller matrices; 1: they were not solved
    ResultReport report;
    /// The table that for_many_directions() made this one from.
    std::optional<BrdfTable> exact;

    /// The table that answers in place of this one, or null: `exact` below the second node, where a
    /// refracting boundary lets next to no light in and the error of series is large relative to
    /// it.
    const BrdfTable* instead(double mu_in) const {
        return exact && mu_in < SmoothPart::nodes()[1] ? &*exact : nullptr;
    }
};

/// A table for a million directions: the smooth parts hold light scattered once as well, so that a
/// direction costs one series in place of angles, phase functions and Fresnel's equations at each
/// wavelength. Wavelengths stay exact (as with rainbows, glories, thin layers at grazing angles)
/// where the error of the series, measured halfway between nodes, exceeds a tenth of the tolerance
/// times the largest value at an incidence. Mueller matrices are those of `exact`.
/// @throws Cancelled
BrdfTable for_many_directions(const BrdfTable& exact, const Control& control);

}  // namespace miebrdf
