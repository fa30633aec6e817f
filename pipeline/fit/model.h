// What scenes with numbers in place of their unknowns give for every measured value, and its
// derivatives.
#pragma once

#include <miebrdf/fit.h>

#include <cstddef>
#include <memory>
#include <set>
#include <span>
#include <string>
#include <vector>

#include "pipeline/fit/job.h"
#include "pipeline/fit/solved_job.h"
#include "pipeline/fit/unknowns.h"

namespace miebrdf {
class SizeLattice;
}

namespace miebrdf::fitting {

/// Searches among sizes go by values, and derivatives, as good as this: the last steps correct what
/// it changes (polish.h).
inline constexpr double kSearchTolerance = 1e-2;

class Model {
  public:
    /// @param problem  checked (check_problem); must outlive the model
    Model(const FitProblem& problem, const Control& control);

    const std::vector<double>& wavelength_nm() const { return wavelength_nm_; }
    /// Numbers of a scene go by these slots.
    const std::vector<Slot>& slots() const { return slots_; }
    /// Values of all data sets, one after the other.
    std::size_t values() const { return values_; }
    int solved_scenes() const { return solved_scenes_; }
    const std::vector<Job>& jobs() const { return jobs_; }
    Scene scene(const Job& job, std::span<const double> numbers) const {
        return request(job, numbers).scene;
    }

    /// Finds out how each unknown is differentiated, and whether spheres come from a lattice of
    /// sizes.
    void prepare(std::span<const double> numbers);
    bool uses_lattice() const { return lattice_is_used_; }
    /// No unknown changes spheres: solutions take no Mie theory but that of the first.
    bool is_analytic() const { return is_analytic_; }
    /// Solves scenes to no less than kSearchTolerance from now on, or as the problem asks.
    void search_coarsely(bool is_coarse) { is_coarse_ = is_coarse; }
    bool is_coarse() const { return is_coarse_; }
    /// Values as the problem asks for them, with averages of their own in place of the lattice's;
    /// nodes and wavelengths are chosen at the first call. @pre uses_lattice
    void evaluate_exactly(std::span<const double> numbers, std::span<double> values);
    /// Uses a finer lattice from now on; where this one is the finest, none.
    void refine_lattice();

    /// Solves all scenes with nodes, and wavelengths to interpolate spectra between, chosen for
    /// their tolerance, and keeps to these from now on: then values are smooth in the numbers.
    /// @return whether more are needed than before
    bool choose_streams(std::span<const double> numbers);

    /// Traces the light that spheres do not get of this scene; evaluate() takes it off from now on.
    /// @return the largest change of a share; 0 where no data ask for it
    double trace_lost_light(std::span<const double> numbers);

    /// Throws what solving throws: UsageError for numbers that no scene can have, Cancelled. Where
    /// the lattice reaches beyond what can be computed, averages are the scene's own; where a
    /// difference does, it is taken to the other side alone.
    /// @param derivatives  by every slot in its fitted number (unknowns.h), row = value, column =
    ///        slot; empty: not wanted
    void evaluate(std::span<const double> numbers, std::span<double> values,
                  std::span<double> derivatives);

  private:
    struct Task;
    template <typename Solve>
    void with_lattice_or_without(const Solve& solve);
    void evaluate_as_set(std::span<const double> numbers, std::span<double> values,
                         std::span<double> derivatives);
    double tolerance() const;
    const Control& remembering();
    Request request(const Job& job, std::span<const double> numbers,
                    const std::vector<std::string>& names = {}) const;
    Scene moved_scene(const Job& job, const std::string& name,
                      std::span<const double> numbers) const;
    std::size_t slot(const Job& job, const std::string& name) const;
    std::vector<std::string> closed_forms(const Job& job) const;
    bool has_closed_forms(const Job& job, std::span<const double> numbers,
                          const std::vector<std::string>& names);
    SolvedJob solve_freely(Job& job, std::span<const double> numbers);
    void add_moved(const Job& job, const std::string& name, std::span<const double> numbers,
                   std::vector<Task>& tasks) const;

    const FitProblem& problem_;
    Control control_;
    std::shared_ptr<ResultCache> cache_;  ///< for the lattice alone
    std::vector<double> wavelength_nm_;
    std::vector<double> spectrum_nm_;  ///< that interpolated jobs may solve: one for all of them
    std::vector<Slot> slots_;
    std::vector<Job> jobs_, exact_jobs_;  ///< the latter empty before evaluate_exactly()
    std::size_t values_ = 0;
    std::set<std::string> by_differences_;  ///< unknowns without closed forms
    std::set<std::string> sizes_;           ///< unknowns that have them in a lattice alone
    std::shared_ptr<const SizeLattice> lattice_, finer_lattice_;
    bool lattice_is_used_ = false, is_analytic_ = true, is_coarse_ = false;
    int solved_scenes_ = 0;
};

}  // namespace miebrdf::fitting
