// The scenes of a sweep go to a file that appears whole or not at all.
#pragma once

#include <cstddef>
#include <memory>
#include <string>
#include <vector>

namespace miebrdf::sweep {

struct Layout;
struct SceneResult;
struct Sweep;

class TableWriter {
  public:
    virtual ~TableWriter() = default;
    /// The scenes of a chunk; chunks come in their order.
    virtual void add(std::size_t first_scene, const std::vector<SceneResult>& results) = 0;
    /// The file appears. @throws InputError  when it cannot be written
    virtual void finish() = 0;
};

/// A file says this of itself, the same from run to run: no times, no command lines.
struct Origin {
    std::string program;               ///< "miebrdf 1.0.0"
    std::string identity;              ///< of the sweep
    std::vector<std::string> sources;  ///< of refractive indices, one line for each
};
/// The sources are those of the first scene and its neighbours along the axes of texts.
Origin origin_of(const Sweep& sweep);

/// One row for each scene, wavelength and direction.
/// @param sweep, layout  must outlive the writer
std::unique_ptr<TableWriter> make_csv_writer(const Sweep& sweep, const Layout& layout,
                                             const std::string& file);

/// The identity of the sweep that a CSV table is of; empty if it is none.
std::string identity_of_csv(const std::string& file);

}  // namespace miebrdf::sweep
