// SPDX-License-Identifier: MIT
// The quick way through a row agrees with the careful way, bit for bit.
#include "log/text/quick_rows.hpp"

#include <cmath>
#include <random>
#include <string>

#include "ripplenotch/core/number.hpp"
#include "support/catch.hpp"

using namespace ripplenotch;

TEST_CASE("numbers read the quick way are correctly rounded", "[log]") {
    std::mt19937_64 random(21);
    const RowParser parser({',', '.'}, 1, {{0, 0}});
    for (int round = 0; round < 200000; ++round) {
        std::string text;
        if (random() % 2 == 0) text += '-';
        for (std::uint64_t k = random() % 12 + 1; k > 0; --k) text += static_cast<char>('0' + random() % 10);
        if (random() % 4 != 0) {
            text += '.';
            for (std::uint64_t k = random() % 12; k > 0; --k) text += static_cast<char>('0' + random() % 10);
        }
        ParsedRow row;
        INFO(text);
        REQUIRE(parser.parse(text.data(), text.data() + text.size(), row));
        REQUIRE(row.values[0] == *parse_number(text));
        REQUIRE(std::signbit(row.values[0]) == std::signbit(*parse_number(text)));
    }
}

TEST_CASE("a row that is not plain is left to the careful way", "[log]") {
    const RowParser parser({',', '.'}, 3, {{0, 0}, {2, 2}});
    for (const std::string text :
         {"", "1", "1,2", "1,2,3,4", "a,2,3", "1,2,x", "1,2,", ",2,3", "1,2,nan", "1,2,inf", "1,\"2\",3",
          "1,2,\"3\"", "1 2,2,3", "1,2,3 4", "--1,2,3", "1,2,3e", "1,2,.", "1,2,-", "1,2,1e999"}) {
        ParsedRow row;
        INFO(text);
        CHECK_FALSE(parser.parse(text.data(), text.data() + text.size(), row));
    }
    const std::string good = "1, anything at all , -2.50e1 ";
    ParsedRow row;
    REQUIRE(parser.parse(good.data(), good.data() + good.size(), row));
    CHECK(row.values[2] == -25.0);
    CHECK(std::string(row.torques[0].begin, row.torques[0].end) == "-2.50e1");
}
