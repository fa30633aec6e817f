// What a scene with these numbers in place of its unknowns gives for every
// measured value.
#pragma once

#include <miebrdf/brdf.h>
#include <miebrdf/fit.h>

#include <cstddef>
#include <optional>
#include <set>
#include <span>
#include <string>
#include <vector>

#include "pipeline/fit/unknowns.h"
#include "pipeline/scene/scene_template.h"

namespace miebrdf::fitting {

/// The scene's words with those that a data set has of its own.
std::vector<TemplateWord> words_of(const FitProblem& problem, const FitData& data);

/// All wavelengths of the data, ascending, each once.
std::vector<double> wavelengths_of(const FitProblem& problem);

class Model {
  public:
    /// @param problem  checked (check_problem); must outlive the model
    Model(const FitProblem& problem, const Control& control);
    ~Model();
    Model(Model&&) noexcept;

    const std::vector<double>& wavelength_nm() const { return wavelength_nm_; }
    /// Numbers of a scene go by these slots.
    const std::vector<Slot>& slots() const { return slots_; }
    /// Values of all data sets, one after the other.
    std::size_t values() const { return values_; }
    int solved_scenes() const { return solved_scenes_; }
    /// From now on nothing is cancelled any more.
    void finish() { control_.is_cancelled = {}; }

    /// Solves all scenes with nodes chosen for their tolerance, and keeps to these nodes from now
    /// on: then values are smooth in the numbers. @return whether more are needed than before
    bool choose_streams(std::span<const double> numbers);

    /// Throws what solving throws: UsageError for numbers that no scene can have, Cancelled.
    /// @param derivatives  by every slot in its fitted number (unknowns.h), row = value, column =
    ///        slot; empty: not wanted
    void evaluate(std::span<const double> numbers, std::span<double> values,
                  std::span<double> derivatives);

  private:
    struct Job;
    struct Solved;
    /// @param streams  raised to the nodes that were used; null: nobody asks
    Request request_of(const Job& job, std::span<const double> numbers,
                       const std::vector<std::string>& names) const;
    /// @param names  of the derivatives that are wanted
    Solved solve_job(const Job& job, std::span<const double> numbers, const Control& control,
                     const std::vector<std::string>& names, int* streams) const;
    void find_closed_forms(std::span<const double> numbers);
    std::vector<std::string> closed_forms(const Job& job) const;

    std::size_t slot_of(const std::string& name, std::size_t wavelength) const;

    const FitProblem& problem_;
    Control control_;
    std::vector<double> wavelength_nm_;
    std::vector<Slot> slots_;
    std::size_t values_ = 0;
    std::vector<Job> jobs_;
    std::optional<std::set<std::string>> by_differences_;  ///< unknowns without closed forms
    int solved_scenes_ = 0;
};

}  // namespace miebrdf::fitting
