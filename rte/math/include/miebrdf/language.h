// Every public header needs C++20; an older language gets one error, which says so.
#pragma once

#if __cplusplus < 202002L
// A file that is missing ends the compilation at once; after #error the compiler would go on.
#include <miebrdf needs C++20: compile with -std=c++20, or link to miebrdf::miebrdf>
#endif
