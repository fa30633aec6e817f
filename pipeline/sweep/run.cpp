#include "pipeline/sweep/run.h"

#include <fmt/format.h>
#include <fmt/ranges.h>
#include <miebrdf/error.h>

#include <algorithm>
#include <cmath>
#include <ctime>

#include "pipeline/scene/number_list.h"
#include "pipeline/solve/optics_memo.h"
#include "pipeline/solve/parallel.h"
#include "pipeline/sweep/layout.h"

namespace miebrdf::sweep {
namespace {

/// Missing chunks that a message lists.
constexpr std::size_t kListed = 10;

}  // namespace

Share parse_share(const std::string& text) {
    const std::vector<std::string> parts = split_list(text, '/');
    if (parts.size() == 2) {
        const double number = parse_number(parts[0], "part"), of = parse_number(parts[1], "part");
        if (number >= 1 && number <= of && of <= 1e6 && number == std::floor(number) &&
            of == std::floor(of))
            return {std::size_t(number), std::size_t(of)};
    }
    throw UsageError(
        fmt::format("part: '{}' is no share of the work; write I/N with I from 1 to N, "
                    "e.g. 3/8",
                    text));
}

std::vector<SceneResult> solve_scenes(const Sweep& sweep, const Layout& layout,
                                      const std::vector<std::size_t>& scenes, int threads_of_each,
                                      const Control& control) {
    Control quiet = control;
    quiet.progress = {};
    quiet.job_begun = {};
    Control of_scene = quiet;
    of_scene.threads = threads_of_each;
    std::vector<SceneResult> results(scenes.size());
    run_parallel("scenes", scenes.size(), quiet, [&](std::size_t i) {
        results[i] = solve_scene(sweep, layout, scenes[i], of_scene);
    });
    return results;
}

std::vector<SceneResult> compute_chunk(const Sweep& sweep, const Layout& layout, const Chunk& chunk,
                                       const Control& control) {
    const std::size_t group = sweep.scenes_per_group();
    std::vector<std::size_t> leaders, others;
    for (std::size_t scene = chunk.first; scene < chunk.first + chunk.count; ++scene)
        (scene == chunk.first || scene % group == 0 ? leaders : others).push_back(scene);
    std::vector<SceneResult> results(chunk.count);
    const auto add = [&](const std::vector<std::size_t>& scenes, int threads_of_each) {
        auto some = solve_scenes(sweep, layout, scenes, threads_of_each, control);
        for (std::size_t i = 0; i < scenes.size(); ++i)
            results[scenes[i] - chunk.first] = std::move(some[i]);
    };
    add(leaders, control.threads);
    add(others, 1);
    return results;
}

ChunkWorker::ChunkWorker(const Sweep& sweep, const Layout& layout, const Parts& parts,
                         Company company, Control control)
    : sweep_(sweep), layout_(layout), parts_(parts), control_(std::move(control)) {
    control_.cache = nullptr;
    if (company == Company::with_others)
        folder_ = std::make_shared<OpticsFolder>(parts.optics_folder());
}

void ChunkWorker::compute(const Chunk& chunk, RunReport& report) {
    if (control_.memo == nullptr || control_.memo->free_bytes() < kSharedBytes / 2) {
        control_.memo = std::make_shared<OpticsMemo>(kSharedBytes, folder_);
        control_.memo->keeps_changes = !sweep_.derivatives.empty();
    }
    const std::clock_t start = std::clock();
    parts_.write(chunk, compute_chunk(sweep_, layout_, chunk, control_));
    report.costs.push_back({chunk, double(std::clock() - start) / CLOCKS_PER_SEC});
    report.computed_scenes += chunk.count;
}

void ChunkWorker::compute_unless(const Chunk& chunk, RunReport& report,
                                 const std::function<bool()>& is_there) {
    const std::function<bool()> outer = control_.is_cancelled;
    control_.is_cancelled = [&] { return (outer && outer()) || is_there(); };
    try {
        compute(chunk, report);
    } catch (const Cancelled&) {
        if (outer && outer()) throw;
    }
    control_.is_cancelled = outer;
}

RunReport run_share(const Sweep& sweep, const Layout& layout, const Parts& parts,
                    const Share& share, const Control& control) {
    RunReport report;
    std::vector<Chunk> missing;
    for (std::size_t number = share.number - 1; number < parts.chunks().size();
         number += share.of) {
        ++report.chunks;
        const Chunk chunk = parts.chunks()[number];
        if (parts.read(chunk)) {
            ++report.found;
        } else {
            missing.push_back(chunk);
        }
    }
    ChunkWorker worker(sweep, layout, parts, share.of > 1 ? Company::with_others : Company::alone,
                       control);
    for (std::size_t i = 0; i < missing.size(); ++i) {
        if (control.is_cancelled && control.is_cancelled()) throw Cancelled();
        worker.compute(missing[i], report);
        if (control.progress) control.progress("chunks", i + 1, missing.size());
    }
    return report;
}

TableReport write_table(const Parts& parts, TableWriter& writer, const Control& control) {
    TableReport report;
    std::vector<std::size_t> missing;
    for (std::size_t number = 0; number < parts.chunks().size(); ++number) {
        if (control.is_cancelled && control.is_cancelled()) throw Cancelled();
        const Chunk chunk = parts.chunks()[number];
        const auto results = parts.read(chunk);
        if (!results) {
            missing.push_back(number);
            continue;
        }
        if (!missing.empty()) continue;
        writer.add(chunk.first, *results);
        for (const SceneResult& result : *results) {
            ++report.scenes;
            const bool failed = std::isnan(result.error_estimate);
            const bool lacks_values = result.missing_wavelengths > 0;
            if ((lacks_values && report.failed + report.incomplete == 0) ||
                report.first_remark.empty())
                report.first_remark = result.remark;
            report.failed += failed;
            report.incomplete += !failed && result.missing_wavelengths > 0;
            report.not_converged += !failed && result.missing_wavelengths == 0 && !result.converged;
            if (!failed)
                report.error_estimate = std::max(report.error_estimate, result.error_estimate);
        }
    }
    if (!missing.empty()) {
        const std::size_t all = missing.size();
        missing.resize(std::min(all, kListed));
        throw InputError(
            fmt::format("{} of {} chunks are missing in '{}' ({}{}); compute them "
                        "first, then merge again",
                        all, parts.chunks().size(), parts.folder().string(),
                        fmt::join(missing, ", "), all > kListed ? ", ..." : ""));
    }
    writer.finish();
    return report;
}

}  // namespace miebrdf::sweep
