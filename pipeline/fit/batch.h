// A paint as a laboratory weighs it: what its components weigh, and what they fill, at numbers of
// the unknowns.
#pragma once

#include <miebrdf/fit.h>

#include <cstddef>
#include <optional>
#include <string>
#include <vector>

namespace miebrdf::fitting {

class Batch {
  public:
    struct Component {
        std::string name;                         ///< words of the species or host
        std::optional<std::size_t> unknown = {};  ///< that is its amount
        std::optional<Amount::Kind> kind = {};    ///< empty: the rest, or the host
        double amount = 0.0, slope = 0.0;  ///< amount at the starts, and its change by the unknown
        double density = 1.0;              ///< g/cm3
        double volume_per_amount = 1.0;    ///< um3 of particles per cm3: of numbers alone
    };
    struct Shares {
        std::vector<double> volume, weight;  ///< of each component, of the whole paint
        double coloured_volume = 0.0;        ///< of components whose amount is an unknown
        double most_amount = 0.0;            ///< sum of their shares as they are given
    };

    /// @param numbers  within the bounds, the starts
    /// @throws UsageError  for amounts in several layers, and densities that are missing
    Batch(const FitProblem& problem, const std::vector<double>& numbers);

    const std::vector<Component>& components() const { return components_; }
    const std::vector<std::string>& notes() const { return notes_; }
    /// Layer of the scene whose amounts are unknown; -1: the base; empty: none.
    std::optional<int> layer() const { return layer_; }
    bool has_film() const { return has_film_; }

    Shares shares(const std::vector<double>& numbers) const;
    /// Numbers of a paint of these weights, in any unit; other unknowns are kept.
    std::vector<double> numbers_of(const std::vector<double>& weights,
                                   std::vector<double> numbers) const;
    double thickness_um(const std::vector<double>& numbers) const;

  private:
    double amount(const Component& component, const std::vector<double>& numbers) const;

    std::vector<double> start_;
    std::vector<Component> components_;
    bool has_host_ = false, by_mass_ = true, has_film_ = false;
    std::optional<double> layer_density_;  ///< g/cm3
    std::optional<int> layer_;
    double thickness_um_ = 0.0;
    std::vector<double> thickness_slope_;
    std::vector<std::string> notes_;
};

/// Within which limits the media of a scene hold, at 550 nm: crowding, tables not for colours.
std::vector<std::string> notes_of(const FitProblem& problem, const std::vector<double>& numbers);

}  // namespace miebrdf::fitting
