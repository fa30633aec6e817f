#include "tools/bench/process_memory.h"
#include "tools/miebrdf/program.h"

int main(int argc, char** argv) {
    miebrdf::bench::keep_freed_memory();
    return miebrdf::program::run_program({argv + 1, argv + argc});
}
