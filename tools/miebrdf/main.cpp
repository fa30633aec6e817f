#include "tools/miebrdf/commands.h"
#include "tools/miebrdf/program.h"

int main(int argc, char** argv) {
    return miebrdf::program::run_main(miebrdf::program::commands(), argc, argv);
}
