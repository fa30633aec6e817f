// Stands in for embedded.cpp in the program that makes the embedded database.
#include <stdexcept>

#include "materials/database/database.h"

namespace miebrdf::materials {

Database Database::embedded() { throw std::logic_error("there is no embedded database yet"); }

}  // namespace miebrdf::materials
