#include "rte/stack/solution_memory.h"

#include <algorithm>
#include <utility>

#include "rte/stack/layered_reflection.h"

namespace miebrdf::rte {

SolutionParts::AtStreams& SolutionParts::with_streams(int streams) {
    constexpr int most = 64;
    streams = std::min(streams, most + 1);
    const auto found = std::find_if(by_streams.begin(), by_streams.end(),
                                    [=](const auto& s) { return s->streams == streams; });
    if (found != by_streams.end()) return **found;
    by_streams.push_back(std::make_unique<AtStreams>());
    by_streams.back()->streams = streams;
    by_streams.back()->scaled.rough_boundaries = rough_boundaries;
    return *by_streams.back();
}

SolutionMemory::SolutionMemory() : parts_(std::make_unique<SolutionParts>()) {}
SolutionMemory::~SolutionMemory() = default;
SolutionMemory::SolutionMemory(SolutionMemory&&) noexcept = default;
SolutionMemory& SolutionMemory::operator=(SolutionMemory&&) noexcept = default;

SolutionMemory memory_with(std::shared_ptr<RoughBoundaries> boundaries) {
    SolutionMemory memory;
    SolutionParts::of(memory).rough_boundaries = std::move(boundaries);
    return memory;
}

}  // namespace miebrdf::rte
