// The search for a recipe: colours of a paint around a solved one, and the amounts that bring them
// nearest to those that are wanted.
#pragma once

#include <miebrdf/fit.h>

#include <cstddef>
#include <functional>
#include <limits>
#include <memory>
#include <optional>
#include <vector>

#include "pipeline/fit/batch.h"
#include "pipeline/fit/model.h"

namespace miebrdf::fitting {

/// What is known of the spectra about one set of numbers.
struct Point {
    std::vector<double> numbers;
    std::vector<double> spectra;  ///< of all data, one after the other
    std::vector<double> slopes;   ///< of (1 - R)^2 / (2 R) by each unknown, row = value
    double objective = std::numeric_limits<double>::infinity();
};

/// Which numbers are searched, and how they make those of the unknowns.
struct Moves {
    std::vector<double> low, high, start;
    std::function<std::vector<double>(const std::vector<double>&)> numbers;
};

/// @param problem  must outlive this
class Matcher {
  public:
    Matcher(const MatchProblem& problem, const Control& control);
    const Batch& batch() const { return batch_; }
    const std::vector<double>& start() const { return start_; }
    int solved() const { return model_.solved_scenes(); }
    /// Solved at these numbers; without derivatives where `from` has slopes to go on with.
    Point point_at(const std::vector<double>& numbers, const Point* from);
    std::vector<Lab> labs(const Point& point, const std::vector<double>& numbers) const;
    /// What the model misses of a measured batch is carried over to other batches, as Lab.
    void set_offsets(const Point& made);
    /// Weighted differences; root sum of squares of the first is the first light's dE.
    std::vector<double> residuals(const Point& point, const std::vector<double>& numbers) const;
    double objective(const Point& point, const std::vector<double>& numbers) const;
    /// Of the batch.
    double cost(const std::vector<double>& weights) const;
    double cost_per_gram(std::size_t component) const { return cost_per_kg_[component] / 1e3; }
    bool is_first(std::size_t colour) const { return colours_[colour].eye == colours_[0].eye; }
    /// From a solved point to the best that these moves reach.
    Point search(Point best, const Moves& moves);
    /// The unknowns themselves, but for one that is fixed at 0. @param fixed  none: of all
    Moves all_unknowns(const std::vector<double>& from, std::optional<std::size_t> fixed) const;
    /// Grams that are added to the batch of the starts.
    Moves additions(const std::vector<double>& weights);
    /// What is added at least to a batch of weight 1 until it has other shares.
    static double addition(const std::vector<double>& from, const std::vector<double>& to);

  private:
    struct Wanted {
        Lab lab;
        Viewing eye;
        Lab offset;
        std::unique_ptr<Colorimeter> meter = {};
    };

    /// The spectra about a point, by its slopes.
    std::vector<double> predicted(const Point& point, const std::vector<double>& numbers) const;
    static std::vector<double> starts_of(const MatchProblem& problem);
    std::size_t first_colour(std::size_t target) const;
    double largest_cost() const;
    /// Slopes that lead from one point to the other (Broyden 1965), steps in shares of the bounds.
    std::vector<double> secant(const Point& from, const Point& to) const;
    /// Of the predicted colours, within a share of the bounds around `at`; from there and from
    /// points that fill them.
    std::vector<double> minimum(const Point& point, const Moves& moves,
                                const std::vector<double>& at, double trust) const;

    const MatchProblem& problem_;
    std::vector<std::size_t> data_of_;
    FitProblem fit_;
    std::vector<double> start_;
    Batch batch_;
    Model model_;
    std::vector<Wanted> colours_;
    std::size_t wavelengths_ = 0;
    std::vector<double> cost_per_kg_;                          ///< of components
    std::function<double(const std::vector<double>&)> added_;  ///< grams; a correction's
};

}  // namespace miebrdf::fitting
