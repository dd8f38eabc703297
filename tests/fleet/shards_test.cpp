// SPDX-License-Identifier: MIT
#include "ripplenotch/fleet/shards.hpp"
#include "support/catch.hpp"

#include "ripplenotch/core/error.hpp"

using namespace ripplenotch;

namespace {

Manifest list_of(std::size_t logs) {
    std::string text;
    for (std::size_t i = 0; i < logs; ++i) text += fmt::format("log{}.csv\n", i);
    return manifest_of(text, "list.txt");
}

ShardRecord record(std::size_t number, std::size_t of) {
    return {"0.1.0", "abc", "ripplenotch features", {number, of}, 1, 1, 0, "def"};
}

}  // namespace

TEST_CASE("shards hold every log once, in the order of the list, and differ in size by one at most") {
    for (const std::size_t logs : {1U, 2U, 7U, 100U}) {
        const Manifest list = list_of(logs);
        for (const std::size_t of : {1U, 2U, 3U, 7U, 100U, 101U}) {
            std::vector<std::string> all;
            std::size_t least = logs, most = 0;
            for (std::size_t number = 1; number <= of; ++number) {
                const auto part = part_of(list, {number, of});
                for (const ManifestEntry& entry : part) all.push_back(entry.log);
                least = std::min(least, part.size());
                most = std::max(most, part.size());
            }
            REQUIRE(all.size() == logs);
            for (std::size_t i = 0; i < logs; ++i) CHECK(all[i] == list.entries[i].log);
            CHECK(most - least <= 1);
        }
    }
}

TEST_CASE("numbers of shards are read strictly") {
    CHECK(shard_of("3/16") == Shard{3, 16});
    for (const char* text : {"", "3", "0/3", "4/3", "3/", "/3", "1.5/3", "1/2000000", "-1/3", "1/3/5"})
        CHECK_THROWS_AS(shard_of(text), UsageError);
}

TEST_CASE("what is missing is told whatever the order of the records") {
    const std::vector<ShardRecord> records = {record(5, 6), record(1, 6), record(2, 6)};
    const std::vector<std::string> names = {"c", "a", "b"};
    CHECK(missing_shards(records, names, 6) == std::vector<std::size_t>{3, 4, 6});
    CHECK(missing_shards({}, {}, 2) == std::vector<std::size_t>{1, 2});
    CHECK(numbers_in_words(std::vector<std::size_t>{1, 2, 3, 7, 9, 10}) == "1 to 3, 7, 9 to 10");
}

TEST_CASE("records of two jobs, and of one shard twice, are refused") {
    const std::vector<std::string> names = {"a", "b"};
    CHECK_THROWS_AS(missing_shards(std::vector{record(1, 2), record(1, 2)}, names, 2), DataError);
    CHECK_THROWS_AS(missing_shards(std::vector{record(1, 2), record(2, 3)}, names, 2), DataError);
    CHECK_THROWS_AS(missing_shards(std::vector{record(1, 3), record(2, 3)}, names, 2), DataError);
    ShardRecord other = record(2, 2);
    other.settings = "ripplenotch features --orders 3";
    CHECK_THROWS_AS(missing_shards(std::vector{record(1, 2), other}, names, 2), DataError);
}
