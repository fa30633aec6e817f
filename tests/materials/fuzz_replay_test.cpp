// The fuzzers' corpus, and every sample with bytes cut or changed, through the same checks.
#include <filesystem>
#include <random>

#include "tests/materials/fuzz/fuzz_readers.h"
#include "tests/support/catch.h"
#include "tests/support/temporary_folder.h"

using namespace miebrdf;

namespace {

namespace fs = std::filesystem;

std::vector<fs::path> files_below(const fs::path& folder) {
    std::vector<fs::path> files;
    for (const auto& entry : fs::recursive_directory_iterator(folder)) {
        if (entry.is_regular_file()) files.push_back(entry.path());
    }
    return files;
}

}  // namespace

TEST_CASE("the corpus replays: every reader refuses or accepts, none fails", "[materials][fuzz]") {
    int replayed = 0;
    for (const fs::path& file : files_below(MIEBRDF_MATERIALS_CORPUS)) {
        materials::fuzz::check(file.parent_path().filename().string(), support::read_file(file));
        ++replayed;
    }
    CHECK(replayed >= 20);
}

TEST_CASE("damaged samples are refused or read, never worse", "[materials][fuzz]") {
    std::mt19937 random(7);
    for (const fs::path& file : files_below(MIEBRDF_MATERIALS_TEST_SAMPLES)) {
        const std::string whole = support::read_file(file);
        for (std::size_t size = 0; size <= whole.size(); ++size) {
            materials::fuzz::check("recognise", std::string_view(whole).substr(0, size));
        }
        for (int i = 0; i < 300; ++i) {
            std::string changed = whole;
            for (int j = 0; j < 3; ++j) {
                changed[random() % changed.size()] =
                    static_cast<char>("0123456789.-eE+* ,;\n\t\0\xff:|#n"[random() % 27]);
            }
            materials::fuzz::check("recognise", changed);
        }
    }
    SUCCEED("no reader aborted");
}
