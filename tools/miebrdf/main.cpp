#include "tools/miebrdf/program.h"

int main(int argc, char** argv) {
    return miebrdf::program::run_program({argv + 1, argv + argc});
}
