// Values between the nodes of a table.
#pragma once

#include <map>
#include <string>
#include <vector>

namespace miebrdf::sweep {

struct StoredAxis {
    std::string name;
    std::vector<double> numbers = {};     ///< ascending or descending; empty: texts
    std::vector<std::string> texts = {};  ///< of axes such as names of materials
    bool is_logarithmic = false;          ///< interpolated over the logarithm
    bool is_sample = false;               ///< numbers of samples: nothing lies between them
    std::string unit = {};                ///< empty: none

    std::size_t size() const { return texts.empty() ? numbers.size() : texts.size(); }
};

/// A table that can be read piece by piece. Not thread-safe.
class StoredTable {
  public:
    virtual ~StoredTable() = default;
    /// Variables that hold results, in the order of the file.
    virtual std::vector<std::string> variables() const = 0;
    virtual std::string unit_of(const std::string& variable) const = 0;
    /// The slowest first.
    virtual std::vector<StoredAxis> axes_of(const std::string& variable) const = 0;
    /// Values at `count` nodes of each axis from `start` on. @throws InputError
    virtual std::vector<double> read(const std::string& variable,
                                     const std::vector<std::size_t>& start,
                                     const std::vector<std::size_t>& count) const = 0;
};

enum class Interpolation { linear, cubic };
/// @throws UsageError
Interpolation parse_interpolation(const std::string& text);

/// Axes of all variables, each once.
std::vector<std::string> axes_of_table(const StoredTable& table);

/// Values by names of axes, of which the beginning will do if it is the only one: radius for
/// radius_um.
/// @throws UsageError  for names that the table has not, and for axes that are named twice
std::map<std::string, std::string> named_values(const StoredTable& table,
                                                const std::map<std::string, std::string>& asked);

/// These variables, or all if there are none. @throws UsageError  for those that the table has not
std::vector<std::string> named_variables(const StoredTable& table,
                                         const std::vector<std::string>& names);

struct LookedUp {
    std::string variable, unit;
    /// Axes that nothing was asked of: values at all of their nodes, the last one fastest.
    std::vector<StoredAxis> listed = {};
    std::vector<double> values = {};  ///< not-a-number where a node that it needs is
    /// Absolute error of each value, as nodes that were left out show it (NodeWeights);
    /// not-a-number where an axis has no node to leave out.
    std::vector<double> errors = {};
};

/// Multilinear, or cubic along each axis with five nodes or more.
/// @param asked  values by names of axes, as typed; names of axes that the variable has not are
///               ignored
/// @throws UsageError  for values outside of an axis, and for texts that it has not
LookedUp look_up(const StoredTable& table, const std::string& variable,
                 const std::map<std::string, std::string>& asked, Interpolation order);

/// The polynomial through the nodes next to x, as weights of nodes.
struct NodeWeights {
    std::size_t first = 0;        ///< node that the first weight belongs to
    std::vector<double> weights;  ///< of the value; 0 for nodes that are left out
    /// One for each neighbour that the polynomial leaves out: weights of the error that this node
    /// shows. It is the next term of Newton's form, the divided difference over the nodes and the
    /// left-out one, times the product of the distances of x.
    std::vector<std::vector<double>> error_weights = {};
};

/// @param nodes  ascending or descending, two or more
/// @param x      between the first and the last
NodeWeights weights_between(const std::vector<double>& nodes, double x, Interpolation order);

}  // namespace miebrdf::sweep
