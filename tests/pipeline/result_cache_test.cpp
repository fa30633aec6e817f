#include "pipeline/cache/result_cache.h"

#include <algorithm>
#include <atomic>
#include <cmath>
#include <filesystem>
#include <thread>

#include "materials/database/sqlite.h"
#include "pipeline/cache/job_key.h"
#include "tests/support/catch.h"
#include "tests/support/temporary_folder.h"

using namespace miebrdf;
using Numbers = std::vector<double>;

namespace {

std::string key(int job) { return JobKey("test").add(job).hash(); }

}  // namespace

TEST_CASE("a stored result is found again to the last bit, by another process too",
          "[pipeline][cache]") {
    const support::TemporaryFolder folder;
    const Numbers numbers = {0.1, -0.0, 5e-324, 1e308};
    {
        ResultCache cache(folder / "cache/results.sqlite");
        CHECK_FALSE(cache.find(key(1)));
        cache.store(key(1), numbers);
    }
    ResultCache cache(folder / "cache/results.sqlite");
    REQUIRE(cache.find(key(1)));
    CHECK(*cache.find(key(1)) == numbers);
    CHECK_FALSE(cache.find(key(2)));
    CHECK(cache.info().entries == 1);
    CHECK(cache.clear() == 1);
    CHECK_FALSE(cache.find(key(1)));
}

TEST_CASE("keys differ as soon as any part differs", "[pipeline][cache]") {
    const auto hash = [](auto... parts) {
        JobKey job("test");
        (job.add(parts), ...);
        return job.hash();
    };
    CHECK(hash(1.0, 2.0) == hash(1.0, 2.0));
    CHECK(hash(1.0, 2.0) != hash(2.0, 1.0));
    CHECK(hash(0.0) != hash(-0.0));
    CHECK(hash(1.0) != hash(std::nextafter(1.0, 2.0)));
    CHECK(hash(std::string_view("ab"), std::string_view("c")) !=
          hash(std::string_view("a"), std::string_view("bc")));
    CHECK(JobKey("test").hash() != JobKey("tes").hash());
}

TEST_CASE("a damaged entry is forgotten, not returned", "[pipeline][cache]") {
    const support::TemporaryFolder folder;
    const std::string file = folder / "results.sqlite";
    const Numbers numbers(1000, 1.25);
    ResultCache(file).store(key(1), numbers);
    // Flips one byte of the stored numbers: 1.25 is 00 00 00 00 00 00 f4 3f.
    std::string bytes = support::read_file(file);
    const auto at = bytes.find(std::string("\xf4\x3f", 2));
    REQUIRE(at != std::string::npos);
    bytes[at] = '\xf5';
    folder.write("results.sqlite", bytes);
    ResultCache cache(file);
    CHECK_FALSE(cache.find(key(1)));
    CHECK(cache.info().entries == 0);
}

TEST_CASE("a whole entry under the key of another is forgotten too", "[pipeline][cache]") {
    const support::TemporaryFolder folder;
    const std::string file = folder / "results.sqlite";
    {
        ResultCache cache(file);
        cache.store(key(500), Numbers{0.5});
        cache.store(key(600), Numbers{0.6});
    }
    {
        const auto connection = materials::sqlite::Connection::open_read_write(file);
        const auto rename = [&](const std::string& from, const std::string& to) {
            connection.prepare("UPDATE result SET hash = ? WHERE hash = ?")
                .bind(to)
                .bind(from)
                .run();
        };
        rename(key(500), "aside");
        rename(key(600), key(500));
        rename("aside", key(600));
    }
    ResultCache cache(file);
    CHECK_FALSE(cache.find(key(500)));
    CHECK_FALSE(cache.find(key(600)));
}

TEST_CASE("a file that is no cache is replaced, a place that cannot be written is done without",
          "[pipeline][cache]") {
    const support::TemporaryFolder folder;
    ResultCache replaced(folder.write("results.sqlite", std::string(5000, 'x')));
    replaced.store(key(1), Numbers{1});
    CHECK(replaced.find(key(1)));

    ResultCache impossible("/proc/no/such/folder/results.sqlite");
    impossible.store(key(1), Numbers{1});
    CHECK_FALSE(impossible.find(key(1)));
    CHECK_FALSE(impossible.info().usable);

    // A folder in its place may hold anything; it stays.
    const std::string precious = folder / "precious";
    std::filesystem::create_directory(precious);
    folder.write("precious/letter", "dear");
    ResultCache occupied(precious);
    CHECK_FALSE(occupied.info().usable);
    CHECK(occupied.clear() == 0);
    CHECK(support::read_file(precious + "/letter") == "dear");
}

TEST_CASE("damage behind a whole header is met by whoever reads or stores first",
          "[pipeline][cache]") {
    const support::TemporaryFolder folder;
    const std::string file = folder / "results.sqlite";
    {
        ResultCache cache(file);
        for (int job = 0; job < 50; ++job) cache.store(key(job), std::vector<double>(300, job));
    }
    std::string bytes = support::read_file(file);
    constexpr std::size_t kPage = 4096;  // the first holds the names of the tables
    REQUIRE(bytes.size() > 10 * kPage);
    std::fill(bytes.begin() + kPage, bytes.end(), '\xff');
    folder.write("results.sqlite", bytes);
    ResultCache cache(file);
    const bool finds = GENERATE(true, false);
    CHECK_FALSE(cache.info().usable);
    if (finds) {
        CHECK_FALSE(cache.find(key(7)));
    } else {
        cache.store(key(7), Numbers{7});  // lost with the rest
    }
    CHECK(cache.info().usable);
    CHECK(cache.info().entries == 0);
    cache.store(key(7), Numbers{7});
    CHECK(cache.find(key(7)) == Numbers{7});
    CHECK(ResultCache(file).find(key(7)) == Numbers{7});
}

TEST_CASE("clear mends a damaged cache that nobody has used since", "[pipeline][cache]") {
    const support::TemporaryFolder folder;
    const std::string file = folder / "results.sqlite";
    ResultCache(file).store(key(1), std::vector<double>(3000, 1.0));
    std::string bytes = support::read_file(file);
    std::fill(bytes.begin() + 4096, bytes.end(), '\xff');
    folder.write("results.sqlite", bytes);
    ResultCache cache(file);
    REQUIRE_FALSE(cache.info().usable);
    CHECK(cache.clear() == 0);
    CHECK(cache.info().usable);
    cache.store(key(1), Numbers{1});
    CHECK(cache.find(key(1)) == Numbers{1});
}

TEST_CASE("a cache whose pages are damaged is begun anew by who finds it", "[pipeline][cache]") {
    const support::TemporaryFolder folder;
    const std::string file = folder / "results.sqlite";
    {
        ResultCache cache(file);
        for (int i = 0; i < 50; ++i) {
            cache.store("job " + std::to_string(i), std::vector<double>(300, i));
        }
    }
    std::string bytes = support::read_file(file);
    REQUIRE(bytes.size() > 20'000);
    // The header stays, so that the file still begins as databases do.
    for (std::size_t i = 100; i < bytes.size(); i += 7) bytes[i] = char(~bytes[i]);
    folder.write("results.sqlite", bytes);
    for (int process = 0; process < 2; ++process) {
        ResultCache cache(file);
        for (int i = 0; i < 50; ++i) {
            const std::string job = "job " + std::to_string(i);
            if (process == 0) {
                CHECK_FALSE(cache.find(job));
                cache.store(job, std::vector<double>(300, i));
            }
            CHECK(cache.find(job) == std::vector<double>(300, i));
        }
        CHECK(cache.info().usable);
        CHECK(cache.info().entries == 50);
    }
}

TEST_CASE("the oldest results make room when the limit is reached", "[pipeline][cache]") {
    const support::TemporaryFolder folder;
    ResultCache cache(folder / "results.sqlite", 100 * 1000);
    const Numbers numbers(1000, 1.0);  // 8000 bytes
    for (int job = 0; job < 100; ++job) cache.store(key(job), numbers);
    CHECK(cache.info().bytes <= 100 * 1000);
    CHECK(cache.find(key(99)));
    CHECK_FALSE(cache.find(key(0)));
}

TEST_CASE("many threads on two connections neither fail nor mix results up", "[pipeline][cache]") {
    const support::TemporaryFolder folder;
    ResultCache caches[2] = {ResultCache(folder / "r.sqlite"), ResultCache(folder / "r.sqlite")};
    std::vector<std::thread> threads;
    threads.reserve(4);
    std::atomic<int> wrong = 0;
    for (int t = 0; t < 4; ++t) {
        threads.emplace_back([&, t] {
            for (int job = 0; job < 50; ++job) {
                caches[t % 2].store(key(job), Numbers{static_cast<double>(job)});
                const auto found = caches[(t + 1) % 2].find(key(job));
                if (found && found->front() != job) ++wrong;
            }
        });
    }
    for (auto& thread : threads) thread.join();
    CHECK(wrong == 0);
    CHECK(caches[0].info().entries == 50);
}
