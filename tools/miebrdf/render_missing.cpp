// miebrdf render in a build without its packages: says which they are.
#include <miebrdf/error.h>
#include "tools/miebrdf/command.h"

namespace miebrdf::program {
namespace {

constexpr char kReason[] =
    "this build cannot render; install libembree-dev, libtinyobjloader-dev, libopenexr-dev and "
    "libpng-dev, then configure and build again";

}  // namespace

void add_render(CLI::App& command, Shell& shell) {
    command.allow_extras();  // its options are not known here, and not to blame
    command.footer(kReason);
    shell.on_run(command, []() -> int { throw UsageError(kReason); });
}

}  // namespace miebrdf::program
