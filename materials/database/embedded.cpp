// The database that every build carries inside itself, and what stands for words of other kinds.
#include <span>
#include <string_view>

#include "materials/database/layer.h"
#include "materials/database/schema.h"
#include "materials/readers/text.h"

// embedded.S puts the file that build_embedded wrote between these two.
extern "C" {
extern const unsigned char miebrdf_embedded_database[];
extern const unsigned char miebrdf_embedded_database_end[];
extern const char miebrdf_common_words[], miebrdf_common_words_end[];
}

namespace miebrdf::materials {

Database Database::embedded() {
    sqlite::Connection connection = sqlite::Connection::open_image(
        std::span<const unsigned char>(miebrdf_embedded_database, miebrdf_embedded_database_end));
    check_schema(connection);
    return Database({std::make_shared<const Layer>(Layer{"embedded", std::move(connection)})});
}

std::optional<CommonWord> common_word(const std::string& text) {
    const std::string asked = lower_case(without_blanks(text));
    for (const std::string_view line :
         split_lines(std::string_view(miebrdf_common_words, miebrdf_common_words_end))) {
        if (line.empty() || line[0] == '#') continue;
        const std::vector<std::string> fields = split_fields(line);
        if (fields.size() != 3 || fields[0] != asked || asked == "word") continue;
        CommonWord word{.word = fields[0], .meaning = fields[2]};
        for (const std::string_view name : split_words(fields[1]))
            word.materials.emplace_back(name);
        return word;
    }
    return std::nullopt;
}

}  // namespace miebrdf::materials
