// miebrdf-bench: `miebrdf bench` and `miebrdf stress`, which run this program.
#include "tools/miebrdf/commands.h"
#include "tools/miebrdf/program.h"

namespace miebrdf::program {

void add_bench(CLI::App& command, Shell& shell);
void add_stress(CLI::App& command, Shell& shell);

}  // namespace miebrdf::program

int main(int argc, char** argv) {
    using namespace miebrdf::program;
    constexpr Command kCommands[] = {{"bench", kBenchHelp, add_bench},
                                     {"stress", kStressHelp, add_stress}};
    return run_main(kCommands, argc, argv);
}
