// The database that every build carries inside itself.
#include <span>

#include "materials/database/layer.h"
#include "materials/database/schema.h"

// embedded.S puts the file that build_embedded wrote between these two.
extern "C" {
extern const unsigned char miebrdf_embedded_database[];
extern const unsigned char miebrdf_embedded_database_end[];
}

namespace miebrdf::materials {

Database Database::embedded() {
    sqlite::Connection connection = sqlite::Connection::open_image(
        std::span<const unsigned char>(miebrdf_embedded_database, miebrdf_embedded_database_end));
    check_schema(connection);
    return Database({std::make_shared<const Layer>(Layer{"embedded", std::move(connection)})});
}

}  // namespace miebrdf::materials
