// What can go wrong before any physics starts, sorted by whose turn it is to act.
#pragma once

#include <stdexcept>

namespace miebrdf {

/// The request itself is wrong: an unknown option value, a number out of range. Exit code 2.
class UsageError : public std::runtime_error {
    using std::runtime_error::runtime_error;
};

/// Data that the request points to is missing, damaged or does not cover it. Exit code 3.
class InputError : public std::runtime_error {
    using std::runtime_error::runtime_error;
};

}  // namespace miebrdf
