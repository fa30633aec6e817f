// miebrdf cache: what is remembered between runs.
#include <fmt/format.h>

#include <miebrdf/version.h>
#include "pipeline/cache/result_cache.h"
#include "tools/miebrdf/command.h"

namespace miebrdf::program {
namespace {

int run_info(const Shell& shell) {
    const ResultCache::Info info = ResultCache(ResultCache::default_file()).info();
    Table table;
    table.columns = {"file", "usable", "entries", "bytes", "limit_bytes"};
    table.rows.push_back({info.file.string(), info.usable ? "yes" : "no",
                          static_cast<double>(info.entries), static_cast<double>(info.bytes),
                          static_cast<double>(info.limit_bytes)});
    return shell.write(std::move(table));
}

int run_clear(const Shell& shell) {
    ResultCache cache(ResultCache::default_file());
    const auto entries = cache.clear();
    shell.note(fmt::format("forgot {} results in {}", entries, cache.info().file.string()));
    return kGood;
}

}  // namespace

void add_cache(CLI::App& command, Shell& shell) {
    command.require_subcommand(1);
    command.set_version_flag("--version", version_text);
    command.footer("Example:\n  miebrdf cache info");
    auto* info = command.add_subcommand("info", "where it is and how much is in it");
    shell.add_common_options(*info);
    shell.on_run(*info, [&shell] { return run_info(shell); });
    auto* clear = command.add_subcommand("clear", "forget everything");
    shell.add_common_options(*clear);
    shell.on_run(*clear, [&shell] { return run_clear(shell); });
}

}  // namespace miebrdf::program
