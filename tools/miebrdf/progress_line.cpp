#include "tools/miebrdf/progress_line.h"

#include <fmt/format.h>
#include <unistd.h>

#include <cstdio>
#include <nlohmann/json.hpp>

#include <miebrdf/error.h>

namespace miebrdf::program {
namespace {

constexpr std::chrono::milliseconds kInterval{100};

}  // namespace

ProgressStyle parse_progress_style(const std::string& text) {
    if (text == "auto")
        return ::isatty(STDERR_FILENO) != 0 ? ProgressStyle::line : ProgressStyle::none;
    if (text == "none") return ProgressStyle::none;
    if (text == "json") return ProgressStyle::json;
    throw UsageError(fmt::format("unknown progress style '{}'; allowed: auto, none, json", text));
}

ProgressLine::~ProgressLine() {
    if (line_shown_) std::fputs("\r\033[K", stderr);
}

void ProgressLine::update(const std::string& stage, std::size_t done, std::size_t total) {
    if (style_ == ProgressStyle::none) return;
    const auto now = Clock::now();
    if (stage != stage_) {
        stage_ = stage;
        stage_start_ = last_update_;
        last_print_ = {};
    }
    last_update_ = now;
    if (done < total && now - last_print_ < kInterval) return;
    last_print_ = now;
    print(done, total, std::chrono::duration<double>(now - stage_start_).count());
}

void ProgressLine::print(std::size_t done, std::size_t total, double elapsed_s) {
    const double rate = elapsed_s > 0.0 ? static_cast<double>(done) / elapsed_s : 0.0;
    const double left_s = rate > 0.0 ? static_cast<double>(total - done) / rate : 0.0;
    if (style_ == ProgressStyle::json) {
        const nlohmann::ordered_json event = {{"stage", stage_},
                                              {"done", done},
                                              {"total", total},
                                              {"per_second", rate},
                                              {"seconds_left", left_s}};
        fmt::print(stderr, "{}\n", event.dump());
        return;
    }
    fmt::print(stderr, "\r\033[K{}: {}/{}, {:.3g}/s, {:.0f} s left", stage_, done, total, rate,
               left_s);
    std::fflush(stderr);
    line_shown_ = true;
}

}  // namespace miebrdf::program
