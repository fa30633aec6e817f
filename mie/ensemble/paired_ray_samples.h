// Two samples of sizes for each group of rays, and whole spheres at sharp ends.
#pragma once

#include <memory>
#include <optional>
#include <vector>

#include <miebrdf/ensemble.h>
#include "mie/ensemble/paired_intensity.h"
#include "mie/ensemble/particle_ensemble.h"
#include "mie/ensemble/ray_columns.h"
#include "mie/ensemble/ray_weights.h"

namespace miebrdf::mie {

/// By rays (ray_phase.h), P is a sum over parts, one for each group of rays. Each part has two
/// samples of sizes of its own: at level 0 eight each by rules for smooth integrands, then levels
/// in equal ratios with weights for what interferes at the angle (ray_weights.h). What they differ
/// by is what interference within a group leaves. Only in single precision.
///
/// Where a distribution ends sharply, rays of different ways do not average out there: what they
/// leave is the error of P by rays. With `exact` each ray is weighted by RayWindow, and what the
/// window leaves of the sizes at either end is one more part, of whole spheres; far rays are summed
/// in closed form (far_rays.h). That takes longer for many angles.
class PairedRaySamples {
  public:
    static constexpr int kLastLevel = 7;  ///< 1,536 and 2,048 sizes of a group

    /// @param ensemble  must outlive this
    PairedRaySamples(const Ensemble& ensemble, bool exact);

    int part_count() const;
    /// Whether a part has rays of one number of ways through the sphere alone.
    bool is_one_ray(std::size_t part) const {
        return part < groups_.size() && groups_[part].first_way == groups_[part].last_way;
    }
    /// The noise of part `i` at some angles, where its samples of few sizes differ by so much (in
    /// P): they may agree by chance where rays interfere, and at all angles that are close
    /// together.
    double noise_floor_at_level(std::size_t i, int level, double lower_theta, double upper_theta,
                                double difference, double value) const;

    /// One level's sizes alone, part by part.
    /// @param levels  one for each part; -1: not wanted
    std::vector<PairedIntensity> levels(const std::vector<int>& levels,
                                        const AngularFunctionsOf<float>& angular,
                                        const Executor& run, WaveStore& waves) const;

  private:
    using Factors = AngularFunctionsOf<float>::Factors;
    struct Piece;
    struct Work;
    std::vector<std::vector<std::size_t>> groups_together(const std::vector<int>& levels) const;
    void add_pieces(const std::vector<std::size_t>& together, const std::vector<int>& levels,
                    const AngularFunctionsOf<float>& angular, const Executor& run, WaveStore& waves,
                    Work& work) const;
    int sizes_of_piece() const;
    void sum(Piece& piece, const AngularFunctionsOf<float>& angular) const;
    void add_end(int part, int level, const AngularFunctionsOf<float>& angular, const Executor& run,
                 WaveStore& waves, PairedIntensity& to) const;

    const Ensemble& ensemble_;
    std::vector<RayGroup> groups_;
    std::optional<RayWindow> window_ = {};  // of rays without ends
    std::unique_ptr<const RaySizes> sizes_;
    std::unique_ptr<const RayInterference> interference_;
};

}  // namespace miebrdf::mie
