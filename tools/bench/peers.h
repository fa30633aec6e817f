// Other people's programs beside our methods: a user's script answers the questions of the cases,
// in lines of JSON on a pipe. The protocol: docs/benchmarking.md#other-programs
#pragma once

#include <string>
#include <vector>

#include <miebrdf/solver.h>
#include "tools/bench/approximations.h"
#include "tools/bench/measurement.h"

namespace miebrdf::bench {

/// The question of a case to a peer, as a JSON object in one line.
std::string question_of(const SimpleStack& scene, const rte::Directions& wanted);

struct PeerWords {
    std::string name;     ///< as it stands in the plots
    std::string command;  ///< run by the shell
};

/// "NAME=COMMAND".
/// @throws UsageError  without a name or a command
PeerWords parse_peer(const std::string& words);

/// Adds a contender to each case for every setting that the peer wants to be measured at. A peer
/// that does not answer in `patience_s`, or not as it should, has no point there.
/// @param note  receives what went wrong, once for each peer and reason
/// @throws UsageError  for a peer that does not start: its command, and what it said first
void add_peer(const PeerWords& words, double patience_s,
              const std::function<void(const std::string&)>& note, std::vector<BenchCase>& cases);

}  // namespace miebrdf::bench
