// Runs the examples of every public header: each file here shows one of them.
#include <miebrdf/error.h>

#include <iostream>

#include "docs/examples/headers/examples.h"

int main() try {
    for (const auto& [header, example] : kExamples) {
        std::cout << "---- <miebrdf/" << header << ">\n";
        example();
    }
} catch (const miebrdf::Error& error) {
    std::cerr << error.what() << '\n';
    return 2;
}
