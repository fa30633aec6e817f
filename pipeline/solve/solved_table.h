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

/// Directions of all kinds: where streams and moments of a BRDF are chosen that is solved once and
/// then asked anywhere, and where its error is estimated. Directions at the very horizon would ask
/// for many more streams.
const Directions& probe_directions();

/// Light scattered more than once is smooth and comes from a table (SmoothPart). What has sharp
/// features, the first order of scattering (FirstOrder) and the surface lobe, is evaluated exactly
/// at every direction. The BRDF is the sum of all.
class SolvedWavelength {
  public:
    /// @param optics  the visible layers; not looked at for BrdfPart::surface
    /// @param w       index of the wavelength
    /// @param light   its components: of several, the BRDF is element 11 of the Mueller matrix
    /// @param whole_matrix  the other elements are wanted too
    /// @param unchecked_nodes  of BrdfState
    SolvedWavelength(const ResolvedScene& scene, std::size_t w, const SceneOptics& optics,
                     const SolverOptions& solver, BrdfPart part, const LightChoice& light,
                     bool whole_matrix, int unchecked_nodes, rte::SolutionMemory& memory,
                     const Control& control);

    /// The surface's transmission included.
    const SmoothPart& smooth() const { return smooth_; }
    void add_smooth(const SmoothPart& part) { smooth_.add(part, 1.0); }
    /// The layers without the surface; there are no media for the surface alone.
    const rte::ScaledStack& stack() const { return stack_; }
    bool is_polarised() const { return is_polarised_; }
    /// True if boundaries or mirrors bend light scattered once or send it back.
    bool has_optical_steps() const { return stack_.refracts() || stack_.has_mirrors(); }

    /// BRDF of the lobe of a surface or a rough boundary; 0 without one.
    double lobe(const Direction& direction) const;
    /// The share of light from below that the surface lets through; 1 without one.
    double transmitted(double mu_in, double mu_out) const;
    /// A rough boundary's lobe of one facet is raised by this at a cosine; 1 for a surface.
    double lobe_scale(double mu) const;
    bool has_lobe() const { return lobe_.has_value(); }

    const WavelengthReport& report() const { return report_; }
    /// Null: only the BRDF is known.
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

/// Memory of one evaluation that the next one can use.
struct EvaluationScratch {
    std::vector<double> cos_azimuth, sharp, series;
    rte::SpectralFirstOrder::Scratch first_order;
};

/// The first order of scattering, as far as a surface lets it through, and the surface lobe, of
/// some wavelengths.
class SharpPart {
  public:
    /// Wavelengths that share their tables: few enough that parts can be made in parallel.
    static constexpr std::size_t kMostWavelengths = 16;

    /// @param wavelengths  at most kMostWavelengths; must outlive this
    SharpPart(std::span<const SolvedWavelength> wavelengths, const SolverOptions& solver);
    /// The same of wavelengths whose smooth parts may hold the first order already.
    SharpPart(const SharpPart& exact, std::span<const SolvedWavelength> wavelengths,
              bool first_order_is_smooth);

    std::size_t wavelengths() const { return wavelengths_.size(); }
    const SolvedWavelength& wavelength(std::size_t w) const { return wavelengths_[w]; }

    /// BRDF at directions that share their cosines (set_cosines): values[d * wavelengths() + w].
    void evaluate(std::span<const Direction> directions, std::span<double> values,
                  EvaluationScratch& scratch) const;
    const rte::SpectralFirstOrder& first_order() const { return *first_order_; }
    /// Every value is 0.
    bool is_empty() const { return !first_order_ && !has_lobe_; }

  private:
    std::span<const SolvedWavelength> wavelengths_;
    std::optional<rte::SpectralFirstOrder> first_order_;  ///< none: in the smooth part
    bool has_lobe_;
};

/// Sets scratch.cos_azimuth, which the following two need, for directions that share their cosines.
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
    /// What `for_many_directions` makes.
    SolvedTable(const BrdfTable& exact, const Control& control);
    SolvedTable(const SolvedTable&) = delete;

    ResolvedScene scene;
    SolverOptions solver;
    BrdfPart part = BrdfPart::total;
    std::vector<std::string> channels;
    Provenance provenance;
    std::vector<SolvedWavelength> wavelengths;
    std::vector<SharpPart> sharp;  ///< of the wavelengths in their order, some at a time
    int components = 1;            ///< of the Mueller matrices that are known; 1: none
    ResultReport report;
    /// Of a table for many directions: the one that it was made from.
    std::optional<BrdfTable> exact;

    /// The table to ask from this incidence: `exact` below the second node, where a refracting
    /// boundary lets next to nothing in and series are off relative to it; null: this one.
    const BrdfTable* instead(double mu_in) const {
        return exact && mu_in < SmoothPart::nodes()[1] ? &*exact : nullptr;
    }
};

/// The same table for those who ask a million directions: light scattered once is in the azimuthal
/// series too, wherever these hold it within a tenth of the tolerance (of the largest value at an
/// incidence, measured halfway between nodes), so that a direction costs one sum of a
/// series in place of angles, phase functions and Fresnel's equations at each wavelength. Rainbows,
/// glories and thin layers seen at grazing angles stay exact. Mueller matrices are those of
/// `exact`.
/// @throws Cancelled
BrdfTable for_many_directions(const BrdfTable& exact, const Control& control);

}  // namespace miebrdf
