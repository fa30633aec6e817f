// Sweeps as CSV: one row for each scene, wavelength and direction.
#include <fmt/format.h>
#include <miebrdf/error.h>
#include <miebrdf/version.h>

#include <algorithm>
#include <fstream>
#include <sstream>

#include "pipeline/io/atomic_file.h"
#include "pipeline/io/table.h"
#include "pipeline/solve/resolved_scene.h"
#include "pipeline/sweep/layout.h"
#include "pipeline/sweep/parts.h"
#include "pipeline/sweep/table_writer.h"

namespace miebrdf::sweep {
namespace {

constexpr char kIdentityLine[] = "# sweep_identity: ";

class CsvWriter : public TableWriter {
  public:
    CsvWriter(const Sweep& sweep, const Layout& layout, const std::string& file)
        : sweep_(sweep), layout_(layout), asked_(asked_axes(sweep)), file_(file) {
        write_header();
    }

    void add(std::size_t first_scene, const std::vector<SceneResult>& results) override {
        Table rows;
        for (std::size_t i = 0; i < results.size(); ++i)
            add_rows(first_scene + i, results[i], rows);
        rows.columns = columns_;
        write_rows(rows);
    }

    void finish() override { file_.commit(); }

  private:
    void write_header() {
        Table header;
        const Origin origin = origin_of(sweep_);
        header.facts = {{"version", origin.program}, {"title", sweep_.title}};
        for (const std::string& source : origin.sources)
            header.facts.emplace_back("source", source);
        std::string units;
        for (const Variable& variable : layout_.variables)
            units +=
                fmt::format("{}{}: {}", units.empty() ? "" : ", ", variable.name, variable.unit);
        header.facts.emplace_back("units", units);
        header.facts.emplace_back("sweep_identity", origin.identity);
        for (const Dimension& dimension : sweep_.dimensions) {
            for (const Axis& axis : dimension.axes) columns_.push_back(axis.name);
        }
        for (const Axis* axis : asked_) columns_.push_back(axis->name);
        for (const Variable& variable : layout_.variables) columns_.push_back(variable.name);
        columns_.insert(columns_.end(), {"error_estimate", "converged", "remark"});
        header.columns = columns_;
        write_csv(header, file_.stream());
    }

    /// Without the line of names, which is there already.
    void write_rows(const Table& rows) {
        std::ostringstream text;
        write_csv(rows, text);
        const std::string whole = std::move(text).str();
        const std::size_t names = whole.find('\n') + 1;
        file_.stream().write(whole.data() + names, std::streamsize(whole.size() - names));
    }

    void add_rows(std::size_t scene, const SceneResult& result, Table& rows) const {
        const std::vector<std::size_t> place = place_of(sweep_, scene);
        std::vector<Cell> of_scene;
        for (std::size_t d = 0; d < sweep_.dimensions.size(); ++d) {
            for (const Axis& axis : sweep_.dimensions[d].axes)
                of_scene.push_back(cell_of_value(axis, place[d]));
        }
        std::size_t count = 1;
        for (const Axis* axis : asked_) count *= axis->size();
        for (std::size_t row = 0; row < count; ++row) {
            std::vector<Cell> cells = of_scene;
            std::vector<std::size_t> at(asked_.size());
            for (std::size_t a = asked_.size(), rest = row; a-- > 0; rest /= asked_[a]->size())
                at[a] = rest % asked_[a]->size();
            for (std::size_t a = 0; a < asked_.size(); ++a)
                cells.push_back(cell_of_value(*asked_[a], at[a]));
            for (const Variable& variable : layout_.variables)
                cells.emplace_back(result.values[index_in(variable, at)]);
            cells.emplace_back(result.error_estimate);
            cells.emplace_back(result.converged ? 1.0 : 0.0);
            cells.emplace_back(result.remark);
            rows.rows.push_back(std::move(cells));
        }
    }

    static Cell cell_of_value(const Axis& axis, std::size_t i) {
        return axis.is_text() ? Cell(axis.words[i]) : Cell(axis.numbers[i]);
    }

    /// Variables that do not have all axes repeat along the others.
    std::size_t index_in(const Variable& variable, const std::vector<std::size_t>& at) const {
        std::size_t index = 0;
        for (const Axis* axis : variable.axes) {
            const auto place = std::find(asked_.begin(), asked_.end(), axis) - asked_.begin();
            index = index * axis->size() + at[std::size_t(place)];
        }
        return variable.offset + index;
    }

    const Sweep& sweep_;
    const Layout& layout_;
    std::vector<const Axis*> asked_;
    std::vector<std::string> columns_;
    AtomicFile file_;
};

/// Adds the sources of a scene that are not there yet; a scene that fails has none.
void add_sources(const Sweep& sweep, std::size_t scene, std::vector<std::string>& sources) {
    for (const ResolvedScene& part : look_up(sweep, scene).parts) {
        for (const std::string& source : part.sources) {
            if (std::find(sources.begin(), sources.end(), source) == sources.end())
                sources.push_back(source);
        }
    }
}

}  // namespace

Origin origin_of(const Sweep& sweep) {
    Origin origin{fmt::format("miebrdf {}", kVersion), identity_of(sweep), {}};
    add_sources(sweep, 0, origin.sources);
    std::size_t stride = sweep.scenes();
    for (const Dimension& dimension : sweep.dimensions) {
        stride /= dimension.size();
        const bool has_text = std::any_of(dimension.axes.begin(), dimension.axes.end(),
                                          [](const Axis& axis) { return axis.is_text(); });
        for (std::size_t i = 1; has_text && i < dimension.size(); ++i)
            add_sources(sweep, i * stride, origin.sources);
    }
    return origin;
}

std::unique_ptr<TableWriter> make_csv_writer(const Sweep& sweep, const Layout& layout,
                                             const std::string& file) {
    return std::make_unique<CsvWriter>(sweep, layout, file);
}

std::string identity_of_csv(const std::string& file) {
    std::ifstream stream(file);
    std::string line;
    while (std::getline(stream, line) && line.rfind('#', 0) == 0) {
        if (line.rfind(kIdentityLine, 0) == 0) return line.substr(sizeof kIdentityLine - 1);
    }
    return {};
}

}  // namespace miebrdf::sweep
