// The bytes of the database that every build carries inside itself.
#pragma once

#include <span>

namespace miebrdf::materials {

std::span<const unsigned char> embedded_database_image();

}  // namespace miebrdf::materials
