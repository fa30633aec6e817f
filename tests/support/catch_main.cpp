#if __has_include(<catch2/catch_all.hpp>)
#include <catch2/catch_session.hpp>
#else
#define CATCH_CONFIG_RUNNER
#include <catch2/catch.hpp>
#endif
#include <iostream>

#include <miebrdf/error.h>
#include "tools/miebrdf/processor_path.h"

/// MIEBRDF_PROCESSOR_PATH holds for tests as it does for the program.
int main(int argc, char** argv) {
    try {
        miebrdf::program::obey_processor_path(argv);
    } catch (const miebrdf::UsageError& error) {
        std::cerr << error.what() << '\n';
        return 2;
    }
    return Catch::Session().run(argc, argv);
}
